//! Enrolment of a headset at a booth through a fleet file. It runs on a thread of its own, as the booth may
//! be off when the headset starts, and visits must continue meanwhile.

use std::fmt;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, mpsc};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use paros_protocol::{DeviceHint, DeviceName};
use paros_upload::BoothCaller;
use paros_upload::enrolment::{
    EnrolError, Enrolment, FLEET_FILE_NAME, FleetFile, NewDevice, enrol_by_fleet,
};

use crate::log::write_log_line;

/// The shortest and longest pause of the exponential backoff between attempts: a booth that starts after its
/// headsets is found soon, and an absent one costs little.
const FIRST_PAUSE: Duration = Duration::from_secs(2);
const LONGEST_PAUSE: Duration = Duration::from_secs(60);

/// The pause after the booth refused the request: its staff must act first. A new fleet file is still noticed
/// within [`LONGEST_PAUSE`].
const PAUSE_AFTER_REFUSAL: Duration = Duration::from_secs(600);

/// The minimum interval between two re-enrolments of a headset that the booth has forgotten. If the booth
/// forgets it repeatedly, asking more often doesn't help.
const PAUSE_BEFORE_AGAIN: Duration = Duration::from_secs(3600);

/// The rate limit for the re-enrolment of a forgotten headset: the time of the last one.
#[derive(Clone, Copy, Debug)]
pub struct AgainClock {
    last: Option<Instant>,
}

/// The possible sources of a fleet file, in order of priority.
#[derive(Clone, Default, Debug)]
pub struct FleetSources {
    /// The text set by the management console.
    pub managed: Option<String>,
    /// The folder of the sessions, into which a computer copies the file by `adb push`.
    pub folder: PathBuf,
    /// The file in the package.
    pub baked: Option<Vec<u8>>,
}

/// The hint and name that a headset sends about itself.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct HeadsetNames {
    /// The hint by which staff recognise the headset after a wipe; `None` if the system has no identifier.
    pub hint: Option<DeviceHint>,
    /// Manufacturer and model.
    pub name: DeviceName,
}

/// A thread that enrols the headset. It ends after the enrolment, or soon after this handle is dropped.
#[derive(Debug)]
pub struct Enroller {
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
    enrolled: mpsc::Receiver<()>,
}

/// The action that a fleet file requires.
#[derive(Debug)]
pub enum EnrolTask {
    /// The headset is enrolled at this site already.
    Nothing,
    /// The headset is enrolled, but the booth's address or certificate has changed: store this enrolment.
    Move(Enrolment),
    /// The headset must be enrolled.
    Enrol,
}

impl AgainClock {
    /// Creates a clock of a headset that has never re-enrolled.
    #[must_use]
    pub const fn new() -> Self {
        AgainClock { last: None }
    }

    /// Returns `true` if the headset may re-enrol now, and records `now` as the time of the last
    /// re-enrolment.
    pub fn take(&mut self, now: Instant) -> bool {
        let is_due =
            self.last.is_none_or(|last| now.saturating_duration_since(last) >= PAUSE_BEFORE_AGAIN);
        if is_due {
            self.last = Some(now);
        }
        is_due
    }
}

impl Default for AgainClock {
    fn default() -> Self {
        AgainClock::new()
    }
}

impl EnrolTask {
    /// Returns the action that a fleet file requires of a headset with this enrolment.
    #[must_use]
    pub fn find(kept: Option<&Enrolment>, fleet: &FleetFile) -> Self {
        match kept.and_then(|kept| Some((kept, kept.moved_to(fleet)?))) {
            None => EnrolTask::Enrol,
            Some((kept, moved)) if *kept == moved => EnrolTask::Nothing,
            Some((_, moved)) => EnrolTask::Move(moved),
        }
    }
}

impl FleetSources {
    /// Reads the sources in order and returns the first valid fleet file. An invalid file is logged and
    /// ignored.
    pub fn find(&self, mut log: impl FnMut(fmt::Arguments<'_>)) -> Option<FleetFile> {
        let path = self.folder.join(FLEET_FILE_NAME);
        let managed = self.managed.as_deref().filter(|text| !text.trim().is_empty());
        let managed = managed.map(|text| FleetFile::parse_text("managed configuration", text));
        let in_folder = path.exists().then(|| FleetFile::read(&path));
        let baked = self.baked.as_ref().map(|bytes| FleetFile::parse("the package", bytes));
        for file in [managed, in_folder, baked].into_iter().flatten() {
            match file {
                Ok(file) => return Some(file),
                Err(why) => log(format_args!("{why}; this fleet's file is left out")),
            }
        }
        None
    }
}

/// Applies a fleet file to the stored enrolment in `file`, without contacting the booth. Returns `true` if
/// the headset must still be enrolled.
///
/// # Errors
/// The enrolment can't be written.
pub fn follow_fleet_file(
    file: &Path,
    fleet: &FleetFile,
    mut log: impl FnMut(fmt::Arguments<'_>),
) -> Result<bool, EnrolError> {
    let kept = Enrolment::read(file).unwrap_or_else(|why| {
        log(format_args!("{why}; the headset is enrolled anew"));
        None
    });
    match EnrolTask::find(kept.as_ref(), fleet) {
        EnrolTask::Nothing => Ok(false),
        EnrolTask::Move(moved) => {
            moved.write(file)?;
            log(format_args!("the booth is at {} now", moved.address));
            Ok(false)
        }
        EnrolTask::Enrol => Ok(true),
    }
}

impl Enroller {
    /// Starts the thread. It requests enrolment at the booth of the current fleet file, through the caller
    /// that `connect` returns, until the booth accepts, and stores the enrolment in `file`.
    ///
    /// # Errors
    /// The system has no random bits.
    pub fn spawn<C: BoothCaller>(
        sources: FleetSources,
        connect: impl FnMut(&FleetFile) -> C + Send + 'static,
        names: HeadsetNames,
        file: PathBuf,
    ) -> Result<Self, EnrolError> {
        // Drawn once: every retry uses the same token, so that retries are idempotent.
        let device = NewDevice::draw(names.hint, names.name)?;
        let stop = Arc::new(AtomicBool::new(false));
        let (tell, enrolled) = mpsc::channel();
        let told_to_stop = Arc::clone(&stop);
        let thread = thread::Builder::new().name("enrol".into()).spawn(move || {
            let pause = |pause| wait_unless_stopped(pause, &told_to_stop);
            let mut told = String::new();
            let find = || {
                sources.find(|line| {
                    let line = line.to_string();
                    if line != told {
                        write_log_line(format_args!("{line}"));
                        told = line;
                    }
                })
            };
            if enrol_with_patience((find, connect), &device, &file, pause) {
                // The handle may have been dropped.
                let _ = tell.send(());
            }
        });
        // If the system refuses a thread, the next start retries.
        Ok(Enroller { stop, thread: thread.ok(), enrolled })
    }

    /// Returns `true` while the thread runs.
    #[must_use]
    pub fn is_asking(&self) -> bool {
        self.thread.as_ref().is_some_and(|thread| !thread.is_finished())
    }

    /// Returns `true` once after the headset has been enrolled.
    pub fn poll_enrolled(&mut self) -> bool {
        self.enrolled.try_recv().is_ok()
    }
}

impl Drop for Enroller {
    fn drop(&mut self) {
        // The thread isn't joined: a booth that doesn't answer would delay the exit.
        self.stop.store(true, Ordering::Release);
        if let Some(thread) = &self.thread {
            thread.thread().unpark();
        }
    }
}

/// Requests enrolment at the booth of the file that `find` returns, and retries until the booth accepts; then
/// stores the enrolment. Returns `false` if `pause` stopped it: `pause` returns `true` to continue.
fn enrol_with_patience<C: BoothCaller>(
    (mut find, mut connect): (impl FnMut() -> Option<FleetFile>, impl FnMut(&FleetFile) -> C),
    device: &NewDevice,
    file: &Path,
    mut pause: impl FnMut(Duration) -> bool,
) -> bool {
    let mut next_pause = FIRST_PAUSE;
    let mut told = String::new();
    let mut fleet = find();
    loop {
        let asked = fleet.as_ref().map(|fleet| {
            let enrolled = enrol_and_keep(&mut connect(fleet), fleet, device, file);
            enrolled.map_err(|why| (format!("{}: {why}; it is tried again", fleet.address), why))
        });
        let wait = match asked {
            Some(Ok(())) => return true,
            Some(Err((line, why))) => {
                if line != told {
                    write_log_line(format_args!("{line}"));
                    told = line;
                }
                match why {
                    EnrolError::Refused { status: 400..=428, .. } => PAUSE_AFTER_REFUSAL,
                    _ => next_pause,
                }
            }
            None => LONGEST_PAUSE,
        };
        next_pause = (next_pause * 2).min(LONGEST_PAUSE);
        let find_another = || find().filter(|found| Some(found) != fleet.as_ref());
        match wait_for(find_another, wait, &mut pause) {
            ControlFlow::Break(()) => return false,
            ControlFlow::Continue(None) => {}
            ControlFlow::Continue(another) => {
                (fleet, next_pause) = (another, FIRST_PAUSE);
                told.clear();
            }
        }
    }
}

fn enrol_and_keep(
    link: &mut impl BoothCaller,
    fleet: &FleetFile,
    device: &NewDevice,
    file: &Path,
) -> Result<(), EnrolError> {
    let enrolment = enrol_by_fleet(link, fleet, device)?;
    enrolment.write(file)?;
    let Enrolment { owner, address, .. } = enrolment;
    write_log_line(format_args!("headset {} of {address}", owner.headset));
    Ok(())
}

/// Waits for `left`, or until `find` returns a fleet file, which is checked every [`LONGEST_PAUSE`]. `pause`
/// returns `true` to continue.
fn wait_for(
    mut find: impl FnMut() -> Option<FleetFile>,
    mut left: Duration,
    mut pause: impl FnMut(Duration) -> bool,
) -> ControlFlow<(), Option<FleetFile>> {
    while !left.is_zero() {
        let part = left.min(LONGEST_PAUSE);
        if !pause(part) {
            return ControlFlow::Break(());
        }
        left -= part;
        if let Some(found) = find() {
            return ControlFlow::Continue(Some(found));
        }
    }
    ControlFlow::Continue(None)
}

/// Waits for `pause`, or until `stop` is set. Returns `true` unless it was set.
fn wait_unless_stopped(pause: Duration, stop: &AtomicBool) -> bool {
    let end = Instant::now() + pause;
    loop {
        let left = end.saturating_duration_since(Instant::now());
        if stop.load(Ordering::Acquire) || left.is_zero() {
            return !stop.load(Ordering::Acquire);
        }
        thread::park_timeout(left);
    }
}

#[cfg(test)]
mod tests;
