//! The real program, over real TLS, on a real disk.

mod attacks;
mod enrolment;
mod kills;
mod parcels;
mod rig;
mod running;
mod staff;
mod uploads;
