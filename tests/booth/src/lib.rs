//! Seeded simulations of exhibitions: the outbox's driver, a network and the booth's rules, with simulated
//! time, network and disks. Under all faults, no sculpture that the booth accepted is lost, none is stored
//! twice, no leased badge names two sculptures, and every announced sculpture is either stored or reported
//! missing.

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
