//! The booth: keeps what headsets send, and lets staff find it by its badge. Decisions are those of
//! `paros_booth_rules`; here are the network, the disk, the database and the clock.
#![forbid(unsafe_code)]

mod app;
mod backup;
mod badge_export;
mod body;
mod clock;
mod commands;
mod deletion_log;
mod demo;
mod demo_shapes;
mod disk_files;
mod error;
mod exporter;
mod files;
mod fleet_file;
mod folder_lock;
mod gate;
mod glb;
#[doc(hidden)]
pub mod internals;
mod keys;
mod leaf;
mod mailer;
mod mesh_check;
mod metrics;
mod model;
mod options;
mod own_file;
mod page_guard;
mod parcel_decode;
mod picture;
mod places;
mod postgres_link;
mod postgres_schema;
mod postgres_store;
mod printing;
mod public;
mod random;
mod rate;
mod restore;
mod routes;
mod run;
mod s3_files;
mod server;
mod settings;
mod shared;
mod spool_import;
mod staff;
mod staff_certificate;
mod threemf;
mod viewer;
mod work_keeper;
mod worker;

pub use disk_files::DiskFiles;
pub use error::Error;
pub use files::Files;
pub use mailer::{MailOptions, SmtpTls};
pub use options::Options;
pub use parcel_decode::check_parcel;
pub use postgres_link::PostgresAddress;
pub use postgres_store::PostgresStore;
pub use printing::SlicerOptions;
pub use public::PublicOptions;
pub use s3_files::S3Files;
pub use shared::{DatabaseUrl, SharedOptions};
pub use staff_certificate::StaffCertificateOptions;

/// Does what the command line asks. Returns output as whole lines.
///
/// # Errors
/// What failed.
pub fn run(options: &Options) -> Result<String, Error> {
    match &options.command {
        Some(command) => commands::run(command),
        None => run::run(&options.serve).map(|()| String::new()),
    }
}
