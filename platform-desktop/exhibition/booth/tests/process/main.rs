//! Tests of the real program, over real TLS, on a real disk.

#[path = "../common/postgres_server.rs"]
mod postgres_server;
#[path = "../common/s3_server.rs"]
mod s3_server;

mod admin;
mod attacks;
mod backup;
mod chromium;
mod demo;
mod full_disk;
mod import;
mod kills;
mod logins;
mod lost;
mod lost_badge;
mod mail;
mod many;
mod page;
mod parcels;
mod printer_stand_in;
mod printers;
mod prints;
mod privacy;
mod rig;
mod running;
mod several;
mod site_keys;
mod smtp_sink;
mod staff;
mod told;
mod uploads;
mod viewer;
mod visitors;
