//! How a headset becomes one of a booth's by a fleet's file: in a thread of its own, as the booth may be off when the
//! headset starts, and visits go on meanwhile.

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

/// Pauses between attempts: a booth that starts later than its headsets is found soon, and one that is gone costs little.
const FIRST_PAUSE: Duration = Duration::from_secs(2);
const LONGEST_PAUSE: Duration = Duration::from_secs(60);

/// The pause after the booth refused: its staff has to do something before it would not. Where that is another fleet's
/// file, it is found within [`LONGEST_PAUSE`].
const PAUSE_AFTER_REFUSAL: Duration = Duration::from_secs(600);

/// How long it is from one time that a headset enrols anew, as the booth has forgotten it, to the next: whatever is wrong
/// where it is forgotten again, asking more often doesn't help.
const PAUSE_BEFORE_AGAIN: Duration = Duration::from_secs(3600);

/// When a headset that was forgotten enrolled anew last.
#[derive(Clone, Copy, Debug)]
pub struct AgainClock {
    last: Option<Instant>,
}

/// Where a fleet's file may be, in the order in which they count.
#[derive(Clone, Default, Debug)]
pub struct FleetSources {
    /// What a console set.
    pub managed: Option<String>,
    /// The folder of the sessions, into which a computer puts it by `adb push`.
    pub folder: PathBuf,
    /// What the package brings.
    pub baked: Option<Vec<u8>>,
}

/// What a headset tells of itself.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct HeadsetNames {
    /// By which staff find it again once it was wiped; none where the system has no such name.
    pub hint: Option<DeviceHint>,
    /// Manufacturer and model.
    pub name: DeviceName,
}

/// A thread that enrols the headset. It ends once that is done, or soon after this is dropped.
#[derive(Debug)]
pub struct Enroller {
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
    enrolled: mpsc::Receiver<()>,
}

/// What is to be done with a fleet's file.
#[derive(Debug)]
pub enum EnrolTask {
    /// The headset is enrolled at this site.
    Nothing,
    /// It is, and the booth is elsewhere now: this is to be kept.
    Move(Enrolment),
    /// It is to be enrolled.
    Enrol,
}

impl AgainClock {
    /// It never did.
    #[must_use]
    pub const fn new() -> Self {
        AgainClock { last: None }
    }

    /// Whether it may now; then it does.
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
    /// What a fleet's file asks of a headset that has this enrolment.
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
    /// Takes the first fleet's file, as it is now. One that is none is told, and counts for nothing.
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

/// Does what a fleet's file asks, where that takes no booth. Returns whether the headset is still to be enrolled.
/// `file` is where the enrolment is kept.
///
/// # Errors
/// The disk refuses.
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
    /// Starts the thread. It asks the booth of the fleet's file that is there then, through what `connect` makes, until
    /// that takes the headset, and keeps the enrolment in `file`.
    ///
    /// # Errors
    /// The system has no random bits.
    pub fn spawn<C: BoothCaller>(
        sources: FleetSources,
        connect: impl FnMut(&FleetFile) -> C + Send + 'static,
        names: HeadsetNames,
        file: PathBuf,
    ) -> Result<Self, EnrolError> {
        // Drawn once: what was asked before, and never answered, is asked again and no other.
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
                // Nobody may be there any more.
                let _ = tell.send(());
            }
        });
        // Where the system refuses a thread, the next start tries again.
        Ok(Enroller { stop, thread: thread.ok(), enrolled })
    }

    /// Whether it is at work still.
    #[must_use]
    pub fn is_asking(&self) -> bool {
        self.thread.as_ref().is_some_and(|thread| !thread.is_finished())
    }

    /// Whether the headset has been enrolled since this was last asked.
    pub fn poll_enrolled(&mut self) -> bool {
        self.enrolled.try_recv().is_ok()
    }
}

impl Drop for Enroller {
    fn drop(&mut self) {
        // It isn't waited for: a booth that doesn't answer would hold up the end.
        self.stop.store(true, Ordering::Release);
        if let Some(thread) = &self.thread {
            thread.thread().unpark();
        }
    }
}

/// Asks the booth of the fleet's file that `find` finds until it takes the headset, and keeps the enrolment; whether it
/// came to that. `pause` returns whether to go on.
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

/// Waits so long, or until a fleet's file is found, which is looked for now and then. `pause` returns whether to go on.
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

/// Waits so long. Returns whether to go on then: nobody has said to stop.
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
