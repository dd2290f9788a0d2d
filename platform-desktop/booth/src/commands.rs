//! What the program does beside serving: to be called while it serves too, as the store takes several processes.

use std::fmt::Write as _;
use std::path::Path;
use std::time::Duration;

use paros_booth_rules::BoothPlan;
use paros_core::badge::{Language, Pictogram};
use paros_core::outbox::messages::EnrolmentToken;

use crate::app::OpenBooth;
use crate::backup::back_up;
use crate::clock::booth_time;
use crate::error::Error;
use crate::options::BoothCommand;
use crate::random::random_bytes;
use crate::restore::restore;

/// Who does what is done from the command line.
const CONSOLE: &str = "console";

/// Does a command. Returns its output as whole lines.
///
/// # Errors
/// What failed.
pub(crate) fn run(command: &BoothCommand) -> Result<String, Error> {
    match command {
        BoothCommand::FleetFile { folder, address, uses, days } => {
            make_fleet_file(&folder.folder, address, *uses, *days)
        }
        BoothCommand::Backup { folder, file } => back_up(&folder.folder, file),
        BoothCommand::Restore { folder, file, deletions } => {
            restore(file, &folder.folder, deletions.as_deref())
        }
        BoothCommand::Attempts { folder } => list_attempts(&folder.folder),
        BoothCommand::Accept { folder, attempt, headset } => {
            let booth = open(&folder.folder)?.booth;
            let headset = booth.accept_attempt(*attempt, *headset, CONSOLE, booth_time())?;
            Ok(format!("headset {headset}\n"))
        }
        BoothCommand::Decline { folder, attempt } => {
            open(&folder.folder)?.booth.decline_attempt(*attempt, CONSOLE, booth_time())?;
            Ok("declined\n".into())
        }
    }
}

fn open(folder: &Path) -> Result<OpenBooth, Error> {
    // Nothing is kept here that a plan or a quota is about.
    OpenBooth::open(folder, BoothPlan::default(), u64::MAX)
}

fn make_fleet_file(folder: &Path, address: &str, uses: u32, days: u16) -> Result<String, Error> {
    let is_plain = address.chars().all(|letter| !letter.is_control() && letter != '"');
    if !address.starts_with("https://") || !is_plain {
        return Err(Error::Input(format!("{address}: expected https:// and an address")));
    }
    let OpenBooth { booth, keys, .. } = open(folder)?;
    let token = random_bytes().map_err(|error| Error::failure("random bits", error))?;
    let token = EnrolmentToken(token);
    let now = booth_time();
    let expires_at = now.after(Duration::from_secs(86_400) * u32::from(days));
    booth.add_enrol_token(&token, (uses, expires_at), "fleet file", Some(CONSOLE), now)?;
    Ok(format!(
        "# Lets {uses} headsets enrol within {days} days. Whoever has it can enrol one: keep it to yourself.\n\
         address = \"{address}\"\nsite = \"{}\"\nreceipt_key = \"{}\"\n\
         enrolment_token = \"{}\"\nca = \"\"\"\n{}\"\"\"\n",
        keys.site.site,
        keys.site.receipt_key(),
        token.reveal(),
        keys.ca_pem
    ))
}

fn list_attempts(folder: &Path) -> Result<String, Error> {
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
