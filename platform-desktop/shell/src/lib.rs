//! What both shells need of `std`: the studio that ticks, saves and prints, files that are whole or
//! absent, and the start volumes.
#![forbid(unsafe_code)]

pub mod durable;
pub mod figures;
pub mod keeper;
pub mod places;
pub mod print;
pub mod require;
pub mod rmap;
pub mod stage;
pub mod starts;
pub mod statics;
pub mod studio;
pub mod trace;
