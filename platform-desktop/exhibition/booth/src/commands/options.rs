//! The command line.

use std::net::SocketAddr;
use std::path::{Path, PathBuf};

use clap::{Args, Parser, Subcommand};
use paros_booth_rules::BoothPlan;
use paros_booth_rules::limits::MAX_RETENTION_DAYS;

use crate::commands::shared::SharedOptions;
use crate::error::Error;
use crate::printing::SlicerOptions;
use crate::public::PublicOptions;
use crate::server::mailer::MailOptions;
use crate::server::staff_certificate::StaffCertificateOptions;

/// Store the sculptures that headsets send, and let staff find them by badge.
#[derive(Debug, Parser)]
#[command(name = "paros-booth", version, args_conflicts_with_subcommands = true)]
pub struct Options {
    /// Command to run. Without a command, the booth serves until it is stopped.
    #[command(subcommand)]
    pub command: Option<BoothTask>,
    /// Options for serving.
    #[command(flatten)]
    pub serve: ServeOptions,
}

/// Options for serving.
#[derive(Debug, Args)]
pub struct ServeOptions {
    /// Folder for the booth's data.
    #[command(flatten)]
    pub folder: FolderOption,
    /// Address on which the booth listens.
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "0.0.0.0:8443")]
    pub listen: SocketAddr,
    /// Another name or address of this machine, for its certificate. May be given several times.
    #[arg(long, value_name = "NAME")]
    pub name: Vec<String>,
    /// Log as JSON, one event per line.
    #[arg(long)]
    pub json: bool,
    /// Retention of sculptures.
    #[command(flatten)]
    pub keep: KeepOption,
    /// Maximum size of all sculptures together, in gigabytes.
    #[arg(long, value_name = "GB", default_value_t = 20,
        value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub quota_gb: u32,
    /// Serve ten sample sculptures. Without --folder, their folder is deleted at the end.
    #[arg(long)]
    pub demo: bool,
    /// Certificate for staff's browsers.
    #[command(flatten)]
    pub certificate: StaffCertificateOptions,
    /// Options for mails.
    #[command(flatten)]
    pub mail: MailOptions,
    /// Options of the slicer and the printers.
    #[command(flatten)]
    pub slicer: SlicerOptions,
    /// Options of the visitors' pages.
    #[command(flatten)]
    pub public: PublicOptions,
    /// Facts about the museum for its visitors.
    #[command(flatten)]
    pub museum: MuseumOptions,
}

/// Facts about the museum for its visitors.
#[derive(Clone, Debug, Default, Args)]
pub struct MuseumOptions {
    /// Opening hours of the booth, as shown on slips and visitors' pages.
    #[arg(long, value_name = "TEXT")]
    pub opening_hours: Option<String>,
}

/// Folder for the booth's data.
#[derive(Debug, Args)]
pub struct FolderOption {
    /// Folder for the booth's data, by default `paros-booth-data`. The first start creates it.
    #[arg(long, value_name = "FOLDER")]
    pub folder: Option<PathBuf>,
    /// Data that several booths share.
    #[command(flatten)]
    pub shared: SharedOptions,
}

impl FolderOption {
    /// Returns the folder: `paros-booth-data` if none was named.
    #[must_use]
    pub fn path(&self) -> &Path {
        self.folder.as_deref().unwrap_or(Path::new("paros-booth-data"))
    }

    /// Returns the folder of a booth that keeps everything in it.
    ///
    /// # Errors
    /// The database or the files are kept elsewhere.
    pub(crate) fn path_alone(&self) -> Result<&Path, Error> {
        if self.shared.database.is_none() && self.shared.files.is_none() {
            return Ok(self.path());
        }
        let why = "backups are of a booth whose folder has everything; database and store have tools of their own";
        Err(Error::Input(why.to_owned()))
    }
}

/// Retention of sculptures.
#[derive(Debug, Args)]
pub struct KeepOption {
    /// Days for which a sculpture is kept after the day of its arrival. At most 93, as badge numbers last no
    /// longer.
    #[arg(long, value_name = "DAYS", default_value_t = BoothPlan::default().retention_days,
        value_parser = clap::value_parser!(u16).range(1..=i64::from(MAX_RETENTION_DAYS)))]
    pub keep_days: u16,
}

impl KeepOption {
    /// Returns the retention times of all data.
    #[must_use]
    pub fn plan(&self) -> BoothPlan {
        let plan = BoothPlan::default();
        let retention_days = self.keep_days;
        // With a short retention, visitors see the sculpture for the first half of it.
        let withdrawn_days = plan.withdrawn_days.min(retention_days / 2);
        BoothPlan { retention_days, withdrawn_days, ..plan }
    }
}

/// Commands other than serving.
#[derive(Debug, Subcommand)]
pub enum BoothTask {
    /// Create a token that lets headsets enrol, and print a fleet file with the token.
    FleetFile {
        /// Folder for the booth's data.
        #[command(flatten)]
        folder: FolderOption,
        /// Address at which headsets reach the booth.
        #[arg(long, value_name = "https://ADDRESS:PORT")]
        address: String,
        /// Number of headsets that can enrol with the token.
        #[arg(long, default_value_t = 50, value_parser = clap::value_parser!(u32).range(1..=1000))]
        uses: u32,
        /// Days until the token expires.
        #[arg(long, default_value_t = 365, value_parser = clap::value_parser!(u16).range(1..=3650))]
        days: u16,
    },
    /// Back up the booth's data and keys into one file. Visitors' mail addresses are left out.
    ///
    /// The booth can serve meanwhile.
    Backup {
        /// Folder for the booth's data.
        #[command(flatten)]
        folder: FolderOption,
        /// Backup file to write, readable only by its owner. An existing file is replaced once the backup is
        /// complete.
        file: PathBuf,
    },
    /// Restore a backup into a new folder. The booth that was backed up must not run any more.
    Restore {
        /// Folder of the restored booth. It must be empty or not exist yet.
        #[command(flatten)]
        folder: FolderOption,
        /// Backup file, as written by `backup`.
        file: PathBuf,
        /// The `deletions` file of the old booth's folder, if newer than the backup. Its entries are deleted
        /// again.
        #[arg(long, value_name = "FILE")]
        deletions: Option<PathBuf>,
        /// Allow a second restore on the same day.
        ///
        /// Badge numbers repeat if the booth that was restored first has answered a headset.
        #[arg(long)]
        again: bool,
    },
    /// Build a new booth from the sculpture files of a booth whose database is lost and that has no backup.
    Rescue {
        /// Folder of the new booth. It must be empty or not exist yet.
        #[command(flatten)]
        folder: FolderOption,
        /// Retention of sculptures.
        #[command(flatten)]
        keep: KeepOption,
        /// Folder of the booth whose database is lost. Nothing in it is changed.
        #[arg(value_name = "LOST")]
        lost: PathBuf,
    },
    /// Import parcels copied from the disk of a headset that is broken or can't reach the booth.
    ImportSpool {
        /// Folder for the booth's data.
        #[command(flatten)]
        folder: FolderOption,
        /// Retention of sculptures.
        #[command(flatten)]
        keep: KeepOption,
        /// Copy of the headset's outbox, with its files ID.parcel, ID.sent and ID.refused. Nothing in it is
        /// changed.
        #[arg(value_name = "OUTBOX")]
        outbox: PathBuf,
        /// Number of the headset, as shown on the staff page.
        #[arg(long, value_name = "NUMBER")]
        headset: u32,
        /// Print the outcome of each file as JSON.
        #[arg(long)]
        json: bool,
    },
    /// Generate and print a new password for an account. Ends all logins of the account.
    ResetPassword {
        /// Folder for the booth's data.
        #[command(flatten)]
        folder: FolderOption,
        /// Name of the account.
        name: String,
    },
}
