//! The booth's server: keeps the sculptures that headsets send, and lets staff find a sculpture by its badge.
//! `paros_booth_rules` makes every decision. This crate connects the rules to the network, the disk, the
//! database and the clock:
//!
//! - `server`: the routes of headsets, what all routes share, and the background threads
//! - `store`: PostgreSQL, and files on a disk or in S3 (SQLite is the crate `paros_booth_sqlite`)
//! - `models`: meshes, pictures and export files, made from a sculpture
//! - `staff`, `public`: the pages of staff and of visitors
//! - `printing`: the slicer and the printers
//! - `commands`: options, settings, and the commands beside the server
#![forbid(unsafe_code)]

mod clock;
mod commands;
mod error;
#[doc(hidden)]
pub mod internals;
mod models;
mod printing;
mod public;
mod random;
mod server;
mod staff;
mod store;
mod viewer;

pub use commands::options::Options;
pub use commands::shared::{DatabaseUrl, SharedOptions};
pub use error::Error;
pub use models::parcel_decode::check_parcel;
pub use printing::SlicerOptions;
pub use public::PublicOptions;
pub use server::mailer::{MailOptions, SmtpTls};
pub use server::staff_certificate::StaffCertificateOptions;
pub use store::disk_files::DiskFiles;
pub use store::files::Files;
pub use store::postgres_link::PostgresAddress;
pub use store::postgres_store::PostgresStore;
pub use store::s3_files::S3Files;

use rustix::fs::Mode;
use rustix::process::umask;

/// Runs the command of the command line, or the server. Returns the output as whole lines.
///
/// # Errors
/// The command's or the server's error.
pub fn run(options: &Options) -> Result<String, Error> {
    // All files are private to their owner: they contain keys, visitors' sculptures and addresses.
    umask(Mode::RWXG | Mode::RWXO);
    match &options.command {
        Some(command) => commands::run(command),
        None => server::run::run(&options.serve).map(|()| String::new()),
    }
}
