//! The commands beside the server. They may run while the server runs, as the store allows several processes.

pub(crate) mod backup;
pub(crate) mod badge_export;
pub(crate) mod demo;
pub(crate) mod demo_shapes;
pub(crate) mod fleet_file;
pub(crate) mod options;
mod own_headset;
pub(crate) mod rescue;
pub(crate) mod reset_password;
pub(crate) mod restore;
pub(crate) mod settings;
pub(crate) mod shared;
pub(crate) mod spool_import;

use paros_booth_rules::{BoothPlan, Refusal};

use crate::clock::booth_time;
use crate::commands::backup::back_up;
use crate::commands::fleet_file::{FleetToken, make_fleet_file};
use crate::commands::options::{BoothTask, FolderOption};
use crate::commands::rescue::rescue;
use crate::commands::reset_password::reset_password;
use crate::commands::restore::restore;
use crate::commands::spool_import::import_spool;
use crate::error::Error;
use crate::server::app::OpenBooth;

/// The name in the audit log for actions from the command line.
const CONSOLE: &str = "console";

/// Runs a command. Returns its output as whole lines.
///
/// # Errors
/// The command's error.
pub(crate) fn run(command: &BoothTask) -> Result<String, Error> {
    match command {
        BoothTask::FleetFile { folder, address, uses, days } => {
            let OpenBooth { booth, keys, .. } = open(folder, BoothPlan::default())?;
            let token = FleetToken { address, uses: *uses, days: *days, note: "fleet file" };
            let made = make_fleet_file(&booth, &keys.ca_pem, &token, CONSOLE, booth_time());
            made.map_err(|refusal| match refusal {
                Refusal::Unfit(_) => Error::Input(format!("--address {address}: {refusal}")),
                refusal => refusal.into(),
            })
        }
        BoothTask::Backup { folder, file } => back_up(folder.path_alone()?, file),
        BoothTask::Restore { folder, file, deletions, again } => {
            restore(file, folder.path_alone()?, deletions.as_deref(), *again)
        }
        BoothTask::Rescue { folder, lost, keep } => rescue(lost, folder.path_alone()?, keep.plan()),
        BoothTask::ImportSpool { folder, keep, outbox, headset, json } => {
            let OpenBooth { booth, .. } = open(folder, keep.plan())?;
            import_spool(&booth, outbox, *headset, *json, CONSOLE)
        }
        BoothTask::ResetPassword { folder, name } => {
            let OpenBooth { booth, .. } = open(folder, BoothPlan::default())?;
            reset_password(&booth, name, CONSOLE)
        }
    }
}

fn open(folder: &FolderOption, plan: BoothPlan) -> Result<OpenBooth, Error> {
    // The quota isn't enforced: staff who import parcels have checked the free space.
    OpenBooth::open(folder.path(), &folder.shared, plan, u64::MAX)
}
