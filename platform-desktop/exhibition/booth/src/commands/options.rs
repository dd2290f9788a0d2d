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

/// Keeps what headsets send, and lets staff find it by its badge.
#[derive(Debug, Parser)]
#[command(name = "paros-booth", version, args_conflicts_with_subcommands = true)]
pub struct Options {
    /// Without a command: serves until it is told to end.
    #[command(subcommand)]
    pub command: Option<BoothTask>,
    /// How to serve.
    #[command(flatten)]
    pub serve: ServeOptions,
}

/// How to serve.
#[derive(Debug, Args)]
pub struct ServeOptions {
    /// Where everything is kept.
    #[command(flatten)]
    pub folder: FolderOption,
    /// The address to listen at.
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "0.0.0.0:8443")]
    pub listen: SocketAddr,
    /// Another name or address of this machine, for its certificate. May be given several times.
    #[arg(long, value_name = "NAME")]
    pub name: Vec<String>,
    /// Log in JSON, a line an event.
    #[arg(long)]
    pub json: bool,
    /// How long sculptures are kept.
    #[command(flatten)]
    pub keep: KeepOption,
    /// Gigabytes that sculptures may take.
    #[arg(long, value_name = "GB", default_value_t = 20,
        value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub quota_gb: u32,
    /// Serve ten sculptures to try, in a folder that is gone at the end unless one is named.
    #[arg(long)]
    pub demo: bool,
    /// What browsers of staff are shown.
    #[command(flatten)]
    pub certificate: StaffCertificateOptions,
    /// How mails go.
    #[command(flatten)]
    pub mail: MailOptions,
    /// How prints are sliced.
    #[command(flatten)]
    pub slicer: SlicerOptions,
    /// Where visitors find their sculptures.
    #[command(flatten)]
    pub public: PublicOptions,
    /// Facts of the museum for its visitors.
    #[command(flatten)]
    pub museum: MuseumOptions,
}

/// Facts of the museum for its visitors.
#[derive(Clone, Debug, Default, Args)]
pub struct MuseumOptions {
    /// The booth's opening hours, as slips and visitors' pages show them.
    #[arg(long, value_name = "TEXT")]
    pub opening_hours: Option<String>,
}

/// Where everything is kept.
#[derive(Debug, Args)]
pub struct FolderOption {
    /// Where everything is kept: `paros-booth-data` where none is named. It is made at the first start.
    #[arg(long, value_name = "FOLDER")]
    pub folder: Option<PathBuf>,
    /// What others share.
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

/// How long sculptures are kept.
#[derive(Debug, Args)]
pub struct KeepOption {
    /// Days for which sculptures are kept after the one on which they came. Badges' numbers last for no longer than 93.
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

/// What else the program does, also while it serves.
#[derive(Debug, Subcommand)]
pub enum BoothTask {
    /// Make a token that lets headsets enrol, and print the fleet's file with it.
    FleetFile {
        /// Where everything is kept.
        #[command(flatten)]
        folder: FolderOption,
        /// The booth's address, as headsets reach it.
        #[arg(long, value_name = "https://ADDRESS:PORT")]
        address: String,
        /// Headsets that it lets in.
        #[arg(long, default_value_t = 50, value_parser = clap::value_parser!(u32).range(1..=1000))]
        uses: u32,
        /// Days until it expires.
        #[arg(long, default_value_t = 365, value_parser = clap::value_parser!(u16).range(1..=3650))]
        days: u16,
    },
    /// Copy all that the booth keeps into one file, keys and all, while it serves. Addresses of visitors stay out.
    Backup {
        /// Where everything is kept.
        #[command(flatten)]
        folder: FolderOption,
        /// The file, which only its owner may read. One that is there is replaced once the new one is whole.
        file: PathBuf,
    },
    /// Make a booth of a backup, in a new folder. The booth that it is of must not run any more.
    Restore {
        /// Where everything is to be kept: a folder that isn't there yet, or is empty.
        #[command(flatten)]
        folder: FolderOption,
        /// The file that `backup` made.
        file: PathBuf,
        /// The `deletions` file of the booth's folder, if that is newer: what it names is deleted again.
        #[arg(long, value_name = "FILE")]
        deletions: Option<PathBuf>,
        /// Though it was restored today before, as the booth of that has answered no headset.
        #[arg(long)]
        again: bool,
    },
    /// Make a booth of the sculptures' files of another one whose database is lost, and of which there is no backup.
    Rescue {
        /// The folder of the new booth: one that isn't there yet, or is empty.
        #[command(flatten)]
        folder: FolderOption,
        /// How long sculptures are kept.
        #[command(flatten)]
        keep: KeepOption,
        /// The folder of the booth whose database is lost. Nothing in it is changed.
        #[arg(value_name = "LOST")]
        lost: PathBuf,
    },
    /// Take the parcels that were copied from the disk of a headset that is broken or has no way to the booth.
    ImportSpool {
        /// Where everything is kept.
        #[command(flatten)]
        folder: FolderOption,
        /// How long sculptures are kept.
        #[command(flatten)]
        keep: KeepOption,
        /// The copy of the headset's outbox, with its files ID.parcel, ID.sent and ID.refused. Nothing in it is changed.
        #[arg(value_name = "OUTBOX")]
        outbox: PathBuf,
        /// The number of the headset, as the staff page shows it.
        #[arg(long, value_name = "NUMBER")]
        headset: u32,
        /// Print the outcome of each file in JSON.
        #[arg(long)]
        json: bool,
    },
    /// Draw a new password for an account whose owner forgot it, and print it. Ends all logins of the account.
    ResetPassword {
        /// Where everything is kept.
        #[command(flatten)]
        folder: FolderOption,
        /// The account.
        name: String,
    },
}
