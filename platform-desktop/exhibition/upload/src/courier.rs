//! A courier: the thread that owns an outbox, steps it ten times a second, and tells what has become of it.
//!
//! Whoever makes frames gives it orders and looks at its board, and never waits: a disk that syncs and a network that is
//! gone are the thread's to wait for. It ends once it is dropped, after it has carried out what it was told.

mod board;
mod clock;
mod mark;
mod orders;
mod work;

use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};

use paros_core::badge::BadgeNumber;
use paros_protocol::{
    CommandOutcome, HeadsetStatus, Parcel, SculptureId, UploadStatus, parse_parcel_name,
};
use paros_shell::settings::BoothSettings;

use super::enrolment::{Enrolment, enrolment_file};
use super::events::{BoothContact, RemoteCommand};
use super::folder::DiskFolder;
use super::link::BoothLink;
use super::spool::{OutboxSettings, SpoolError};

use board::Board;
pub use board::{BoothState, CourierSummary};
pub use clock::read_clock_ms;
use orders::CourierOrder;
pub use orders::{FinishedSculpture, ParcelDraft};
use work::Work;

/// The folder of outboxes beside a shell's saved sessions: a folder each site.
pub const OUTBOX_FOLDER: &str = "outbox";

/// A file of outboxes before there was a folder each site.
const OLD_JOURNAL: &str = "outbox.journal";

/// What a courier is started with.
#[derive(Clone, Debug)]
pub struct CourierPlan {
    /// The outbox's folder.
    pub folder: PathBuf,
    /// Whose outbox it is.
    pub enrolment: Enrolment,
    /// What an exhibition sets.
    pub settings: OutboxSettings,
    /// Milliseconds of a clock that goes on while the device sleeps and that nobody sets.
    pub clock: fn() -> u64,
}

/// A link that a thread may own.
pub type CourierLink = Box<dyn BoothLink + Send>;

/// A courier. It ends when it is dropped.
pub struct Courier {
    board: Arc<Mutex<Board>>,
    orders: Option<Sender<CourierOrder>>,
    thread: Option<JoinHandle<Vec<Parcel>>>,
    clock: fn() -> u64,
    found: Vec<(SculptureId, UploadStatus)>,
    last_finished: Option<FinishedSculpture>,
}

impl fmt::Debug for Courier {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Courier").finish_non_exhaustive()
    }
}

impl Courier {
    /// Opens the outbox and starts the thread.
    ///
    /// # Errors
    /// Where the folder can't be opened or another process has it, or the site's key is none.
    pub fn spawn(plan: &CourierPlan, link: CourierLink) -> Result<Self, SpoolError> {
        let opened = DiskFolder::open(&plan.folder);
        let folder = opened.map_err(|error| SpoolError::Disk {
            name: error.path.display().to_string(),
            source: error.source,
        })?;
        let work = Work::open(plan, folder, link)?;
        let board = work.board();
        let (found, last_finished) = (work.list_found(), work.last_finished());
        let (orders, taken): (Sender<CourierOrder>, Receiver<CourierOrder>) = channel();
        let thread = thread::spawn(move || work.run(&taken));
        let (orders, thread) = (Some(orders), Some(thread));
        Ok(Courier { board, orders, thread, clock: plan.clock, found, last_finished })
    }

    /// Opens the outbox of a device that is enrolled at a booth; `None` for one that isn't. `sessions` is the folder of
    /// saved sessions, `open_link` connects to the booth.
    ///
    /// # Errors
    /// A line that tells why nothing is sent: the enrolment can't be read, or the outbox can't be opened.
    pub fn open_enrolled(
        settings: &BoothSettings,
        sessions: &Path,
        clock: fn() -> u64,
        open_link: impl FnOnce(&Enrolment) -> Result<CourierLink, String>,
    ) -> Result<Option<Self>, String> {
        let told = |why: &dyn fmt::Display| format!("nothing is sent to the booth: {why}");
        let own = settings.enrolment.as_ref().map(|path| sessions.join(path));
        let enrolment = Enrolment::read(&own.unwrap_or_else(|| enrolment_file(sessions)));
        let Some(enrolment) = enrolment.map_err(|error| told(&error))? else { return Ok(None) };
        let outboxes = sessions.join(OUTBOX_FOLDER);
        if outboxes.join(OLD_JOURNAL).exists() {
            let folder = outboxes.display();
            return Err(told(&format_args!(
                "{folder} is an outbox of another version: send its sculptures with that version, or move it away"
            )));
        }
        let link = open_link(&enrolment)?;
        let own = enrolment.owner.site.to_string();
        let folder = outboxes.join(&own);
        let settings = OutboxSettings {
            grace_seconds: settings.grace_days.saturating_mul(86_400),
            max_bytes: u64::from(settings.space_mb) * 1_000_000,
        };
        let plan = CourierPlan { folder, enrolment, settings, clock };
        let courier = Courier::spawn(&plan, link).map_err(|error| told(&error))?;
        for (site, count) in count_left(&outboxes, &own) {
            courier.lock().add_note(format!(
                "{count} sculptures wait for the booth of another site in {site}"
            ));
        }
        Ok(Some(courier))
    }

    /// What the outbox knew as it was opened.
    #[must_use]
    pub fn found(&self) -> &[(SculptureId, UploadStatus)] {
        &self.found
    }

    /// The sculpture that was finished last before this start, where one is known.
    #[must_use]
    pub const fn last_finished(&self) -> Option<&FinishedSculpture> {
        self.last_finished.as_ref()
    }

    /// Announces a finished sculpture. `volume` is its `.rmap`, by which a start finds the id of a saved session's sculpture.
    pub fn announce(&self, id: SculptureId, volume: Vec<u8>) {
        self.set_last_sculpture(id);
        self.lock().note_making(id);
        self.order(CourierOrder::Announce { id, volume });
    }

    /// Asks for a badge, which [`Courier::badge_of`] has later.
    pub fn ask_badge(&self, id: SculptureId) {
        self.order(CourierOrder::TakeBadge { id });
    }

    /// The badge that was asked for, once the lease is on the disk.
    #[must_use]
    pub fn badge_of(&self, id: SculptureId) -> Option<BadgeNumber> {
        self.lock().badge_of(id)
    }

    /// Notes which badge the visitor is shown.
    pub fn note_badge(&self, id: SculptureId, badge: BadgeNumber) {
        self.order(CourierOrder::NoteBadge { id, badge });
    }

    /// Has a parcel packed and kept.
    pub fn keep(&self, draft: ParcelDraft) {
        self.lock().note_making(draft.facts.id);
        self.order(CourierOrder::Keep(Box::new(draft)));
    }

    /// Has parcels kept that another courier had no room for. To be called before anything is given up.
    pub fn keep_parcels(&self, parcels: Vec<Parcel>) {
        for parcel in parcels {
            self.order(CourierOrder::KeepParcel(Box::new(parcel)));
        }
    }

    /// Ends it once it has done what it was told. Returns the parcels that had no room, which are nowhere else.
    #[must_use]
    pub fn close(mut self) -> Vec<Parcel> {
        self.end()
    }

    fn end(&mut self) -> Vec<Parcel> {
        self.orders = None;
        // If it panicked there is nothing left to wait for.
        self.thread.take().and_then(|thread| thread.join().ok()).unwrap_or_default()
    }

    /// The parcel of a sculpture won't be made.
    pub fn abandon(&self, id: SculptureId) {
        self.order(CourierOrder::Abandon { id });
    }

    /// Where a sculpture stands; `None` where nothing is known of it, or not any more.
    #[must_use]
    pub fn upload_status(&self, id: SculptureId) -> Option<UploadStatus> {
        self.lock().status_of(id)
    }

    /// Returns where the last finished sculpture stands on its way to the booth.
    #[must_use]
    pub fn booth_state(&self) -> BoothState {
        let board = self.lock();
        BoothState {
            id: board.last,
            badge: board.last.and_then(|id| board.badge_of(id)),
            status: board.last.and_then(|id| board.status_of(id)),
            outbox: board.summary,
        }
    }

    /// Sets the last finished sculpture, which an earlier run announced.
    pub(crate) fn set_last_sculpture(&self, id: SculptureId) {
        self.lock().last = Some(id);
    }

    /// What is to be told of the whole outbox.
    #[must_use]
    pub fn summary(&self) -> CourierSummary {
        self.lock().summary
    }

    /// Whether the booth says that it doesn't know this device, as one does that came back from a backup of before the device
    /// enrolled. One that staff shut out is known.
    #[must_use]
    pub fn is_forgotten(&self) -> bool {
        self.lock().summary.contact == BoothContact::Forgotten
    }

    /// Takes how the headset is, for the next heartbeat.
    pub fn report_status(&self, status: HeadsetStatus) {
        self.lock().status = status;
    }

    /// Takes the next command of the booth's that is still alive. What comes of it is told by
    /// [`Courier::note_command_done`].
    #[must_use]
    pub fn take_command(&self) -> Option<RemoteCommand> {
        loop {
            let (command, ends_ms) = self.lock().commands.pop_front()?;
            if (self.clock)() < ends_ms {
                return Some(command);
            }
            self.note_command_done(command.id, CommandOutcome::Expired);
        }
    }

    /// What came of a command.
    pub fn note_command_done(&self, id: u64, outcome: CommandOutcome) {
        self.order(CourierOrder::CommandDone { id, outcome });
    }

    /// Takes what is to be told to who runs the shell, a line each.
    #[must_use]
    pub fn take_notes(&self) -> Vec<String> {
        self.lock().notes.drain(..).collect()
    }

    fn lock(&self) -> MutexGuard<'_, Board> {
        lock(&self.board)
    }

    fn order(&self, order: CourierOrder) {
        if let Some(orders) = &self.orders {
            // The thread ends after this.
            let _ = orders.send(order);
        }
    }
}

/// The folders of other sites whose booths don't have all sculptures, and how many each lacks.
fn count_left(outboxes: &Path, own: &str) -> Vec<(String, usize)> {
    let entries = |folder: &Path| fs::read_dir(folder).into_iter().flatten().flatten();
    let is_left = |name: &str| {
        let status = parse_parcel_name(name).map(|(_, status)| status);
        matches!(status, Some(UploadStatus::Kept | UploadStatus::Refused))
    };
    let others = entries(outboxes).filter(|entry| entry.file_name() != *own);
    let counted = others.map(|site| {
        let names = entries(&site.path()).map(|entry| entry.file_name());
        let left = names.filter(|name| name.to_str().is_some_and(is_left));
        (site.path().display().to_string(), left.count())
    });
    counted.filter(|(_, count)| *count > 0).collect()
}

/// The board. Nothing panics that holds it, and what it has is never in half.
fn lock(board: &Mutex<Board>) -> MutexGuard<'_, Board> {
    board.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Drop for Courier {
    fn drop(&mut self) {
        self.end();
    }
}

#[cfg(test)]
pub(crate) mod test_booth;
#[cfg(test)]
mod tests;
