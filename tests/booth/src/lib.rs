//! Exhibitions under one seed: the outbox's driver, a network and the booth's rules, whose time, network and disks are
//! replaced. Whatever happens, what the booth took isn't lost, nothing is stored twice, no leased badge names
//! two sculptures, and what was announced is kept or missed.

mod acts;
pub mod badge_year;
pub mod booth;
pub mod check;
pub mod disk;
pub mod exhibition;
pub mod headset;
pub mod network;
mod restores;
pub mod truth;
