//! The state that all requests share, and the limits on concurrent work.

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

/// The most heartbeats and token checks that use the store at once. They have a separate limit, as they are
/// short and mustn't wait behind parcels that are synced to disk.
const MAX_SMALL: usize = 4;

/// The most other requests that use the store or the disk at once. More would only wait there and take
/// memory.
const MAX_WORK: usize = 6;

/// The most parcels that are decoded at once: each takes memory for its packed and unpacked bytes.
const MAX_DECODES: usize = 2;

/// The most models that are made for downloads at once: each takes a second of a processor, which uploads
/// need too.
const MAX_MODELS: usize = 1;

/// The most downloads that wait for their model.
const MAX_WAITING_MODELS: usize = 16;

/// The longest wait of a download for its model: a person is waiting at a browser.
const LONGEST_WAIT_FOR_MODEL: Duration = Duration::from_secs(20);

/// The number of threads for work that waits for the disk.
pub(crate) const WORK_THREADS: usize = MAX_SMALL + MAX_WORK;

/// The number of threads for work on whole parcels and models. They are separate threads, as the allocator
/// keeps for each thread the memory of its largest work; on shared threads that was a third of the booth's
/// memory.
pub(crate) const WHOLE_THREADS: usize = MAX_DECODES + MAX_MODELS;

/// The most bytes of a small parcel: a hundred times a usual volume.
pub(crate) const SMALL_PARCEL_BYTES: u64 = 1 << 20;

/// The most small parcels in memory at once: 32 MiB in total.
const MAX_SMALL_PARCELS: usize = 32;

/// The most larger parcels, with traces, in memory at once. A slow large parcel doesn't delay small ones.
const MAX_LARGE_PARCELS: usize = 1;

/// The most parcels of one headset at once: the current one, and one that the headset has given up.
const MAX_PARCELS_OF_ONE: usize = 2;

/// The most requests that wait at one gate: about as many as connections may be open. A waiting request takes
/// little memory.
const MAX_WAITING: usize = 640;

/// The longest wait of a request at a gate: shorter than the headset's own timeout, so that it gets a
/// response.
const LONGEST_WAIT: Duration = Duration::from_secs(5);

/// The time for which the result of a health check is reused: anybody may request one, and each writes to the
/// disk.
const CHECK_LIFE: Duration = Duration::from_secs(2);

/// The state that all requests share.
pub(crate) struct BoothApp {
    /// The rules, which make every decision.
    pub booth: Booth,
    /// The files of sculptures.
    pub files: Arc<dyn Files>,
    /// Notifications of changes in the records.
    pub changes: Changes,
    /// The counters for Prometheus.
    pub metrics: Metrics,
    /// The wakers of the worker threads.
    pub wakers: Wakers,
    /// Printers on the network.
    pub printers: Vec<Printer>,
    /// The address of visitors' pages, if they have some.
    pub public_address: Option<PublicAddress>,
    /// The rate limit of models that are downloaded by a visitor's link, for each sculpture: each takes a
    /// second of a processor.
    pub(crate) models_of_links: RateLimiter<[u8; 16]>,
    /// Facts of the booth that pages show.
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

/// The wakers of the worker threads.
pub(crate) struct Wakers {
    /// Wakes the exporter.
    pub exports: Waker,
    /// Wakes the mailer; `None` without a mail server.
    pub mails: Option<Waker>,
    /// Wakes the slicer; `None` without one.
    pub slices: Option<Waker>,
}

/// The parts of a booth that a folder, or what several booths share, holds.
pub(crate) struct OpenBooth {
    /// The rules, which make every decision.
    pub booth: Booth,
    /// The files of sculptures.
    pub files: Arc<dyn Files>,
    /// Notifications of changes in the records.
    pub changes: Changes,
    /// The keys of the booth's site.
    pub keys: BoothKeys,
}

impl OpenBooth {
    /// Opens an existing booth, for a command beside the server.
    ///
    /// # Errors
    /// There is no booth in the folder; the errors of [`OpenBooth::open_or_make`].
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

    /// Opens a booth's folder and what it shares with others. Makes a new booth at the server's first start.
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
    /// Makes the state of a booth. `of_wholes` runs work on whole parcels and models.
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
            // Allows a whole fleet of headsets behind one address to enrol at once.
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

    /// Checks that the store and the files can be written to. Reuses a successful result for [`CHECK_LIFE`].
    ///
    /// # Errors
    /// The errors of the store and the disk.
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

    /// Runs work that waits for the disk on a blocking thread, after waiting at the gate.
    ///
    /// # Errors
    /// The work's error, or [`Refusal::Overloaded`].
    pub(crate) async fn run<T: Send + 'static>(
        self: &Arc<Self>,
        work: impl FnOnce(&BoothApp) -> Result<T, Refusal> + Send + 'static,
    ) -> Result<T, Refusal> {
        self.run_behind(&self.work, &Handle::current(), work).await
    }

    /// Runs short, frequent work.
    ///
    /// # Errors
    /// The work's error, or [`Refusal::Overloaded`].
    pub(crate) async fn run_small<T: Send + 'static>(
        self: &Arc<Self>,
        work: impl FnOnce(&BoothApp) -> Result<T, Refusal> + Send + 'static,
    ) -> Result<T, Refusal> {
        self.run_behind(&self.small, &Handle::current(), work).await
    }

    /// Runs work that unpacks a parcel.
    ///
    /// # Errors
    /// The work's error, or [`Refusal::Overloaded`].
    pub(crate) async fn run_decode<T: Send + 'static>(
        self: &Arc<Self>,
        work: impl FnOnce(&BoothApp) -> Result<T, Refusal> + Send + 'static,
    ) -> Result<T, Refusal> {
        self.run_behind(&self.decodes, &self.of_wholes, work).await
    }

    /// Runs work that makes a model.
    ///
    /// # Errors
    /// The work's error, or [`Refusal::Overloaded`].
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
            // If the request is cancelled, the work still runs to its end and keeps its permit.
            let _permit = permit;
            work(&app)
        });
        done.await.unwrap_or_else(|error| Err(std::io::Error::other(error).into()))
    }
}
