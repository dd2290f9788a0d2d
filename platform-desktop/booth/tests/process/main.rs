//! The real program, over real TLS, on a real disk.

mod attacks;
mod backup;
mod chromium;
mod enrolment;
mod kills;
mod mail;
mod parcels;
mod printer_stand_in;
mod printers;
mod prints;
mod rig;
mod running;
mod smtp_sink;
mod staff;
mod uploads;
mod viewer;
mod visitors;
