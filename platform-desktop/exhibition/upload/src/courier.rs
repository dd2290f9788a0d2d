//! The courier: a thread that owns an outbox, steps it ten times a second, and publishes its state.
//!
//! The render thread gives orders and reads the board, and never blocks: only the courier waits for disk
//! syncs and the network. The courier ends after it is dropped, once it has carried out all orders.

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

/// The folder of outboxes, in the folder of saved sessions. It has a subfolder for each site.
pub const OUTBOX_FOLDER: &str = "outbox";

/// A file of an old outbox, from before each site had a folder.
const OLD_JOURNAL: &str = "outbox.journal";

/// The parameters of a courier.
#[derive(Clone, Debug)]
pub struct CourierPlan {
    /// The outbox's folder.
    pub folder: PathBuf,
    /// The identity of this device, and its booth.
    pub enrolment: Enrolment,
    /// The outbox settings of an exhibition.
    pub settings: OutboxSettings,
    /// A monotonic clock in milliseconds that also runs while the device sleeps.
    pub clock: fn() -> u64,
}

/// A link that can move to a thread.
pub type CourierLink = Box<dyn BoothLink + Send>;

/// A handle to a courier's thread, which ends when the handle is dropped.
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
    /// Returns an error if the folder can't be opened, another process uses it, or the enrolment is invalid.
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

    /// Opens the outbox of an enrolled device; returns `None` if the device isn't enrolled. `sessions` is the
    /// folder of saved sessions, `open_link` connects to the booth.
    ///
    /// # Errors
    /// Returns a message why nothing is sent: the enrolment can't be read, or the outbox can't be opened.
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

    /// Returns the sculptures that the outbox contained when it was opened, with their statuses.
    #[must_use]
    pub fn found(&self) -> &[(SculptureId, UploadStatus)] {
        &self.found
    }

    /// Returns the last sculpture that was finished before this start, if it is known.
    #[must_use]
    pub const fn last_finished(&self) -> Option<&FinishedSculpture> {
        self.last_finished.as_ref()
    }

    /// Announces a finished sculpture. `volume` is its `.rmap`: its hash identifies the sculpture of a saved
    /// session after a restart.
    pub fn announce(&self, id: SculptureId, volume: Vec<u8>) {
        self.set_last_sculpture(id);
        self.lock().note_making(id);
        self.order(CourierOrder::Announce { id, volume });
    }

    /// Requests a badge. [`Courier::badge_of`] returns it later.
    pub fn ask_badge(&self, id: SculptureId) {
        self.order(CourierOrder::TakeBadge { id });
    }

    /// Returns the requested badge, once its use is saved on the disk.
    #[must_use]
    pub fn badge_of(&self, id: SculptureId) -> Option<BadgeNumber> {
        self.lock().badge_of(id)
    }

    /// Records the badge that the visitor is shown.
    pub fn note_badge(&self, id: SculptureId, badge: BadgeNumber) {
        self.order(CourierOrder::NoteBadge { id, badge });
    }

    /// Packs a parcel and stores it in the outbox.
    pub fn keep(&self, draft: ParcelDraft) {
        self.lock().note_making(draft.facts.id);
        self.order(CourierOrder::Keep(Box::new(draft)));
    }

    /// Stores parcels that another courier had no room for. Call this before [`Courier::abandon`].
    pub fn keep_parcels(&self, parcels: Vec<Parcel>) {
        for parcel in parcels {
            self.order(CourierOrder::KeepParcel(Box::new(parcel)));
        }
    }

    /// Ends the courier after it has carried out all orders. Returns the parcels that found no room, which
    /// are stored nowhere else.
    #[must_use]
    pub fn close(mut self) -> Vec<Parcel> {
        self.end()
    }

    fn end(&mut self) -> Vec<Parcel> {
        self.orders = None;
        // After a panic of the thread there are no parcels.
        self.thread.take().and_then(|thread| thread.join().ok()).unwrap_or_default()
    }

    /// Reports that the parcel of a sculpture won't be made.
    pub fn abandon(&self, id: SculptureId) {
        self.order(CourierOrder::Abandon { id });
    }

    /// Returns the upload status of a sculpture; `None` if it is unknown, or no longer known.
    #[must_use]
    pub fn upload_status(&self, id: SculptureId) -> Option<UploadStatus> {
        self.lock().status_of(id)
    }

    /// Returns the state of the last finished sculpture on its way to the booth.
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

    /// Sets the last finished sculpture, which an earlier start announced.
    pub(crate) fn set_last_sculpture(&self, id: SculptureId) {
        self.lock().last = Some(id);
    }

    /// Returns the state of the whole outbox.
    #[must_use]
    pub fn summary(&self) -> CourierSummary {
        self.lock().summary
    }

    /// Returns `true` if the booth doesn't know this device, such as after a restore from a backup older than
    /// the enrolment. A device that staff excluded is still known.
    #[must_use]
    pub fn is_forgotten(&self) -> bool {
        self.lock().summary.contact == BoothContact::Forgotten
    }

    /// Sets the status for the next heartbeat.
    pub fn report_status(&self, status: HeadsetStatus) {
        self.lock().status = status;
    }

    /// Takes the next command of the booth that hasn't expired. Report its outcome with
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

    /// Reports the outcome of a command.
    pub fn note_command_done(&self, id: u64, outcome: CommandOutcome) {
        self.order(CourierOrder::CommandDone { id, outcome });
    }

    /// Takes the messages for the operator of the shell, one line each.
    #[must_use]
    pub fn take_notes(&self) -> Vec<String> {
        self.lock().notes.drain(..).collect()
    }

    fn lock(&self) -> MutexGuard<'_, Board> {
        lock(&self.board)
    }

    fn order(&self, order: CourierOrder) {
        if let Some(orders) = &self.orders {
            // Fails if the thread has ended. The order then has no effect.
            let _ = orders.send(order);
        }
    }
}

/// Lists the outboxes of other sites with unsent sculptures, and the number of these sculptures.
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

/// Locks the board. Ignores poisoning: no code panics while it holds the lock.
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
