//! What the program does beside serving: to be called while it serves too, as the store takes several processes.

use std::fmt::Write as _;

use paros_booth_rules::{BoothPlan, Refusal};
use paros_core::badge::{Language, Pictogram};

use crate::app::OpenBooth;
use crate::backup::back_up;
use crate::clock::booth_time;
use crate::error::Error;
use crate::fleet_file::{FleetToken, make_fleet_file};
use crate::options::{BoothTask, FolderOption};
use crate::restore::restore;

/// Who does what is done from the command line.
const CONSOLE: &str = "console";

/// Does a command. Returns its output as whole lines.
///
/// # Errors
/// What failed.
pub(crate) fn run(command: &BoothTask) -> Result<String, Error> {
    match command {
        BoothTask::FleetFile { folder, address, uses, days } => {
            let OpenBooth { booth, keys, .. } = open(folder)?;
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
        BoothTask::Attempts { folder } => list_attempts(folder),
        BoothTask::Accept { folder, attempt, headset } => {
            let booth = open(folder)?.booth;
            let headset = booth.accept_attempt(*attempt, *headset, CONSOLE, booth_time())?;
            Ok(format!("headset {headset}\n"))
        }
        BoothTask::Decline { folder, attempt } => {
            open(folder)?.booth.decline_attempt(*attempt, CONSOLE, booth_time())?;
            Ok("declined\n".into())
        }
    }
}

fn open(folder: &FolderOption) -> Result<OpenBooth, Error> {
    // Nothing is kept here that a plan or a quota is about.
    OpenBooth::open(folder.path(), &folder.shared, BoothPlan::default(), u64::MAX)
}

fn list_attempts(folder: &FolderOption) -> Result<String, Error> {
    let mut list = String::new();
    for attempt in open(folder)?.booth.list_attempts(booth_time())? {
        let shown = attempt.pictograms.map(|number| {
            Pictogram::new(number).map_or("?", |shown| shown.name(Language::English))
        });
        // Writing to a String doesn't fail.
        let _ = write!(list, "{}: {} ({})", attempt.attempt, shown.join(", "), attempt.name);
        if let Some(headset) = attempt.maybe_headset {
            let _ = write!(list, ", maybe headset {headset}");
        }
        list.push('\n');
    }
    Ok(list)
}
