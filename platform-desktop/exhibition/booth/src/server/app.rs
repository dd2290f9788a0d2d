//! What all requests share.

use std::fs;
use std::net::IpAddr;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use paros_booth_rules::{Booth, BoothPlan, Refusal, Store};
use paros_booth_sqlite::SqliteStore;
use tokio::runtime::Handle;

use crate::clock::booth_time;
use crate::commands::backup::DATABASE;
use crate::commands::settings::SiteFacts;
use crate::commands::shared::SharedOptions;
use crate::error::Error;
use crate::printing::Printer;
use crate::public::PublicAddress;
use crate::random::random_bytes;
use crate::server::changes::Changes;
use crate::server::gate::Gate;
use crate::server::keys::BoothKeys;
use crate::server::metrics::Metrics;
use crate::server::places::Places;
use crate::server::rate::RateLimiter;
use crate::server::worker::Waker;
use crate::staff::LoginGate;
use crate::store::files::Files;

/// Heartbeats and tokens that are at the store at once. They have places of their own: each takes a moment, and
/// doesn't wait behind parcels that are synced to the disk.
const MAX_SMALL: usize = 4;

/// Other requests that are at the store or the disk at once: more only wait there, each with its memory.
const MAX_WORK: usize = 6;

/// Parcels that are unpacked and checked at once: each holds its packed and unpacked bytes.
const MAX_DECODES: usize = 2;

/// Models that are made for downloads at once: each takes a processor for a second, and uploads go on beside.
const MAX_MODELS: usize = 1;

/// Downloads that wait for their model.
const MAX_WAITING_MODELS: usize = 16;

/// How long one waits: somebody looks at a browser.
const LONGEST_WAIT_FOR_MODEL: Duration = Duration::from_secs(20);

/// Threads for work that waits for the disk.
pub(crate) const WORK_THREADS: usize = MAX_SMALL + MAX_WORK;

/// Threads for work on whole parcels and models. They are others: an allocator keeps for each thread what its largest work
/// took, and that was a third of the booth's memory where any thread might get it.
pub(crate) const WHOLE_THREADS: usize = MAX_DECODES + MAX_MODELS;

/// Bytes of a parcel that is small: a hundred times what a volume usually takes.
pub(crate) const SMALL_PARCEL_BYTES: u64 = 1 << 20;

/// Small parcels that are in memory at once: 32 MiB at most.
const MAX_SMALL_PARCELS: usize = 32;

/// Larger parcels, with traces, that are in memory at once. A slow one holds up no small one.
const MAX_LARGE_PARCELS: usize = 1;

/// Parcels of a headset at once: one, and one that its headset gave up.
const MAX_PARCELS_OF_ONE: usize = 2;

/// Requests that wait for one of these: about as many as connections may be open; whoever waits holds little.
const MAX_WAITING: usize = 640;

/// How long a request waits in a line of the booth's, so that its headset hears before it gives up by itself.
const LONGEST_WAIT: Duration = Duration::from_secs(5);

/// The time for which a health check holds: anybody may ask for one, and each writes to the disk.
const CHECK_LIFE: Duration = Duration::from_secs(2);

/// What all requests share.
pub(crate) struct BoothApp {
    /// What decides.
    pub booth: Booth,
    /// Where files are.
    pub files: Arc<dyn Files>,
    /// What changes in its records.
    pub changes: Changes,
    /// What is counted.
    pub metrics: Metrics,
    /// Tell threads of work.
    pub wakers: Wakers,
    /// Printers on the network.
    pub printers: Vec<Printer>,
    /// Where visitors' pages are, if they have some.
    pub public_address: Option<PublicAddress>,
    /// Models of a sculpture that its visitor's link asks for: each takes a second of a processor.
    pub(crate) models_of_links: RateLimiter<[u8; 16]>,
    /// What pages tell of the booth itself.
    pub(crate) facts: SiteFacts,
    pub(crate) logins: LoginGate,
    pub(crate) of_device: RateLimiter<u32>,
    pub(crate) of_stranger: RateLimiter<IpAddr>,
    pub(crate) small_parcels: Gate,
    pub(crate) large_parcels: Gate,
    pub(crate) parcels_of_device: Arc<Places<u32>>,
    small: Gate,
    work: Gate,
    decodes: Gate,
    models: Gate,
    /// The threads for work on whole parcels and models.
    of_wholes: Handle,
    /// The time of the last health check that succeeded.
    checked_at: Mutex<Option<Instant>>,
}

/// What tells threads of work.
pub(crate) struct Wakers {
    /// The exporter.
    pub exports: Waker,
    /// The mailer, where mails are sent.
    pub mails: Option<Waker>,
    /// The slicer, where there is one.
    pub slices: Option<Waker>,
}

/// A booth's parts in a folder.
pub(crate) struct OpenBooth {
    /// What decides.
    pub booth: Booth,
    /// Where files are.
    pub files: Arc<dyn Files>,
    /// What changes in its records.
    pub changes: Changes,
    /// Who it is.
    pub keys: BoothKeys,
}

impl OpenBooth {
    /// Opens the booth of a folder, for a command beside the server.
    ///
    /// # Errors
    /// There is no booth; or those of [`OpenBooth::open_or_make`].
    pub(crate) fn open(
        folder: &Path,
        shared: &SharedOptions,
        plan: BoothPlan,
        quota_bytes: u64,
    ) -> Result<Self, Error> {
        if !["keys", DATABASE].iter().any(|name| folder.join(name).exists()) {
            let why = "there is no booth; its server makes one at its first start";
            return Err(Error::Input(format!("{}: {why}", folder.display())));
        }
        OpenBooth::open_or_make(folder, shared, plan, quota_bytes)
    }

    /// Opens the booth of a folder, which is made at the server's first start; or what several booths share.
    ///
    /// # Errors
    /// An I/O error, a database error, or keys or records that are damaged or missing.
    pub(crate) fn open_or_make(
        folder: &Path,
        shared: &SharedOptions,
        plan: BoothPlan,
        quota_bytes: u64,
    ) -> Result<Self, Error> {
        let files = shared.open_files(folder, quota_bytes)?;
        let (store, keys): (Arc<dyn Store>, _) = match shared.open_database(folder)? {
            Some((store, keys)) => (Arc::new(store), keys),
            None => open_sqlite(folder)?,
        };
        let worker = random_bytes().map_err(|error| Error::failure("random bits", error))?;
        let changes = Changes::new();
        let store = changes.watch_store(store);
        let booth = Booth::new(store, files.clone(), keys.site.clone(), plan)
            .as_worker(u64::from_le_bytes(worker));
        Ok(OpenBooth { booth, files, changes, keys })
    }
}

fn open_sqlite(folder: &Path) -> Result<(Arc<dyn Store>, BoothKeys), Error> {
    let database = folder.join(DATABASE);
    let has_records = fs::metadata(&database).is_ok_and(|file| file.len() > 0);
    let has_sculptures =
        fs::read_dir(folder.join("sculptures")).is_ok_and(|mut all| all.next().is_some());
    if !has_records && (has_sculptures || BoothKeys::are_in(folder)) {
        let why = "it is missing or empty, and the booth's keys or sculptures are here; restore a backup into another \
            folder (paros-booth restore), or, without a backup, make a booth of the sculptures' files (paros-booth rescue)";
        return Err(Error::Input(format!("{}: {why}", database.display())));
    }
    let keys = BoothKeys::load_or_draw(folder, !has_records)?;
    let store = SqliteStore::open(&database).map_err(|error| Error::at(&database, error))?;
    Ok((Arc::new(store), keys))
}

impl BoothApp {
    /// Of a booth.
    #[must_use]
    pub(crate) fn new(
        (booth, files, changes): (Booth, Arc<dyn Files>, Changes),
        (wakers, printers): (Wakers, Vec<Printer>),
        logins: LoginGate,
        public_address: Option<PublicAddress>,
        facts: SiteFacts,
        of_wholes: Handle,
    ) -> Self {
        BoothApp {
            booth,
            files,
            changes,
            metrics: Metrics::default(),
            wakers,
            printers,
            models_of_links: RateLimiter::new(12, 1.0 / 20.0),
            public_address,
            facts,
            logins,
            of_device: RateLimiter::new(200, 50.0),
            // A wall of headsets that enrol at once, behind one address.
            of_stranger: RateLimiter::new(250, 2.0),
            small_parcels: Gate::new(MAX_SMALL_PARCELS, MAX_WAITING, LONGEST_WAIT),
            large_parcels: Gate::new(MAX_LARGE_PARCELS, MAX_WAITING, LONGEST_WAIT),
            parcels_of_device: Arc::new(Places::new(MAX_PARCELS_OF_ONE)),
            small: Gate::new(MAX_SMALL, MAX_WAITING, LONGEST_WAIT),
            work: Gate::new(MAX_WORK, MAX_WAITING, LONGEST_WAIT),
            decodes: Gate::new(MAX_DECODES, MAX_WAITING, LONGEST_WAIT),
            models: Gate::new(MAX_MODELS, MAX_WAITING_MODELS, LONGEST_WAIT_FOR_MODEL),
            of_wholes,
            checked_at: Mutex::default(),
        }
    }

    /// Checks that the store and the files can be written to; not again within [`CHECK_LIFE`].
    ///
    /// # Errors
    /// Those of store and disk.
    pub(crate) fn check_writes(&self) -> Result<(), Refusal> {
        let mut checked_at = self.checked_at.lock().unwrap_or_else(PoisonError::into_inner);
        if checked_at.is_some_and(|at| at.elapsed() < CHECK_LIFE) {
            return Ok(());
        }
        *checked_at = None;
        self.booth.check_store(booth_time())?;
        self.files.check_writes()?;
        *checked_at = Some(Instant::now());
        Ok(())
    }

    /// Does work that waits for the disk, on a thread for such, when it is its turn.
    ///
    /// # Errors
    /// The work's, or [`Refusal::Overloaded`].
    pub(crate) async fn run<T: Send + 'static>(
        self: &Arc<Self>,
        work: impl FnOnce(&BoothApp) -> Result<T, Refusal> + Send + 'static,
    ) -> Result<T, Refusal> {
        self.run_behind(&self.work, &Handle::current(), work).await
    }

    /// Does work that takes a moment and is asked for often.
    ///
    /// # Errors
    /// The work's, or [`Refusal::Overloaded`].
    pub(crate) async fn run_small<T: Send + 'static>(
        self: &Arc<Self>,
        work: impl FnOnce(&BoothApp) -> Result<T, Refusal> + Send + 'static,
    ) -> Result<T, Refusal> {
        self.run_behind(&self.small, &Handle::current(), work).await
    }

    /// Does work that unpacks a parcel.
    ///
    /// # Errors
    /// The work's, or [`Refusal::Overloaded`].
    pub(crate) async fn run_decode<T: Send + 'static>(
        self: &Arc<Self>,
        work: impl FnOnce(&BoothApp) -> Result<T, Refusal> + Send + 'static,
    ) -> Result<T, Refusal> {
        self.run_behind(&self.decodes, &self.of_wholes, work).await
    }

    /// Does work that makes a model.
    ///
    /// # Errors
    /// The work's, or [`Refusal::Overloaded`].
    pub(crate) async fn run_model<T: Send + 'static>(
        self: &Arc<Self>,
        work: impl FnOnce(&BoothApp) -> Result<T, Refusal> + Send + 'static,
    ) -> Result<T, Refusal> {
        self.run_behind(&self.models, &self.of_wholes, work).await
    }

    async fn run_behind<T: Send + 'static>(
        self: &Arc<Self>,
        gate: &Gate,
        threads: &Handle,
        work: impl FnOnce(&BoothApp) -> Result<T, Refusal> + Send + 'static,
    ) -> Result<T, Refusal> {
        let permit = gate.enter().await?;
        let app = self.clone();
        let done = threads.spawn_blocking(move || {
            // The work goes on where nobody waits for it any more, and holds its place.
            let _permit = permit;
            work(&app)
        });
        done.await.unwrap_or_else(|error| Err(std::io::Error::other(error).into()))
    }
}
