//! The booth: the real rules over a store and files that fail at random, and an HTTP front end.

use std::collections::BTreeMap;
use std::io::{self, ErrorKind};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use paros_booth_rules::records::{Announcement, Command, Device, Sculpture, Tombstone};
use paros_booth_rules::{
    Access, Booth, BoothPlan, BoothTime, Deletion, KeptName, ParcelFiles, Refusal, SiteKeys, Store,
    StoreError, Transaction, view,
};
use paros_booth_sqlite::SqliteStore;
use paros_models::random_visitor::RandomSource;
use paros_protocol::{
    ContentHash, DeviceHint, DeviceName, DeviceToken, EnrolmentToken, FleetEnrolment, Heartbeat,
    SiteId, UploadFacts,
};
use paros_upload::{BoothRequest, HttpAnswer, RequestKind};

use crate::truth::is_poison;

/// The site's id.
pub const SITE: SiteId = SiteId([5; 16]);

/// Opening time: ten in the morning of an arbitrary day.
pub const OPENING: BoothTime = BoothTime(20_000 * 86_400_000 + 36_000_000);

/// The files that the booth stores, and its fault injection.
#[derive(Debug)]
struct Inside {
    kept: BTreeMap<KeptName, Vec<u8>>,
    /// The log of deletions, which restores keep.
    deletions: Vec<Deletion>,
    dice: RandomSource,
    /// One call in `fails_of` fails; 0 disables failures.
    fails_of: u64,
}

/// The shared file store with fault injection.
#[derive(Debug)]
struct SimFiles(Mutex<Inside>);

#[derive(Debug)]
struct SimStore {
    inner: SqliteStore,
    files: Arc<SimFiles>,
}

/// A backup of the booth: its records and files.
pub struct SimBackup {
    store: SqliteStore,
    kept: BTreeMap<KeptName, Vec<u8>>,
    copied_at: BoothTime,
}

/// The booth behind its simulated HTTP interface.
pub struct SimBooth {
    /// The booth's rules.
    pub booth: Booth,
    files: Arc<SimFiles>,
    store: Arc<SimStore>,
}

impl SimFiles {
    fn lock(&self) -> MutexGuard<'_, Inside> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Inside {
    fn fail(&mut self) -> io::Result<()> {
        let fails = self.fails_of > 0 && self.dice.one_in(self.fails_of);
        if fails { Err(ErrorKind::Other.into()) } else { Ok(()) }
    }
}

impl Store for SimStore {
    fn begin(&self, access: Access) -> Result<Box<dyn Transaction + '_>, StoreError> {
        let fails = self.files.lock().fail();
        fails.map_err(|error| StoreError::Failed(error.into()))?;
        self.inner.begin(access)
    }
}

impl ParcelFiles for SimFiles {
    fn keep(&self, name: &KeptName, bytes: &[u8]) -> io::Result<()> {
        let mut inside = self.lock();
        inside.fail()?;
        inside.kept.insert(*name, bytes.to_vec());
        // The file is written, but the call may still report a failure.
        inside.fail()
    }

    fn read_kept(&self, name: &KeptName) -> io::Result<Vec<u8>> {
        self.lock().kept.get(name).cloned().ok_or(ErrorKind::NotFound.into())
    }

    fn remove_kept(&self, name: &KeptName) -> io::Result<()> {
        let mut inside = self.lock();
        inside.fail()?;
        inside.kept.remove(name);
        Ok(())
    }

    fn log_deletions(&self, deletions: &[Deletion]) -> io::Result<()> {
        let mut inside = self.lock();
        inside.fail()?;
        inside.deletions.extend_from_slice(deletions);
        Ok(())
    }

    fn forget_deletions_before(&self, _time: BoothTime) -> io::Result<()> {
        self.lock().fail()
    }
}

impl SimBooth {
    /// Creates a booth that enrols devices by one fleet token.
    ///
    /// # Panics
    /// Never: failures are still off.
    pub fn new(seed: u64) -> Self {
        let inside = Inside {
            kept: BTreeMap::new(),
            deletions: Vec::new(),
            dice: RandomSource::new(seed),
            fails_of: 0,
        };
        let files = Arc::new(SimFiles(Mutex::new(inside)));
        let inner = SqliteStore::in_memory().expect("memory");
        let store = Arc::new(SimStore { inner, files: files.clone() });
        let booth = make_booth(&store, &files);
        let token = EnrolmentToken([77; 32]);
        let ends = BoothTime(OPENING.0 * 2);
        booth.add_enrol_token(&token, (300, ends), "all", None, OPENING).expect("nothing fails");
        SimBooth { booth, files, store }
    }

    /// Copies the records and stored files.
    ///
    /// # Panics
    /// Never: the copy is made in memory.
    #[must_use]
    pub fn back_up(&self, copied_at: BoothTime) -> SimBackup {
        let store = SqliteStore::copy_in_memory(&self.store.inner).expect("memory");
        SimBackup { store, kept: self.files.lock().kept.clone(), copied_at }
    }

    /// Replaces the booth's state with a backup, and applies the deletions logged since. Turns failures off.
    /// Returns all logged deletions.
    ///
    /// # Panics
    /// The backup can't be prepared for use.
    pub fn restore(&mut self, backup: SimBackup, now: BoothTime) -> Vec<Deletion> {
        let SimBackup { store, kept, copied_at } = backup;
        let deletions = {
            let mut inside = self.files.lock();
            (inside.kept, inside.fails_of) = (kept, 0);
            inside.deletions.clone()
        };
        self.store = Arc::new(SimStore { inner: store, files: self.files.clone() });
        self.booth = make_booth(&self.store, &self.files);
        self.booth.make_restored(&deletions, copied_at, now).expect("a backup that is whole");
        deletions
    }

    /// Enrols a device and returns its number, which starts at 1. Enrolling is idempotent.
    ///
    /// # Panics
    /// The booth refuses a valid token.
    pub fn enrol(&self, device: u8, now: BoothTime) -> u32 {
        let enrolment = FleetEnrolment {
            enrolment_token: EnrolmentToken([77; 32]),
            token_hash: ContentHash::of(&token_of(device).0),
            hint: DeviceHint([device; 16]),
            name: DeviceName::new("Quest").expect("a name"),
        };
        self.booth.enrol_fleet(&enrolment, now).expect("a valid token").headset
    }

    /// Enrols a device and returns its record.
    ///
    /// # Panics
    /// The booth refuses a valid token.
    pub fn enrol_device(&self, device: u8, now: BoothTime) -> Device {
        self.enrol(device, now);
        self.booth.authenticate(&token_of(device)).expect("it was let in")
    }

    /// Makes one call in `fails_of` fail from now on; 0 turns failures off.
    pub fn set_failures(&self, fails_of: u64) {
        self.files.lock().fails_of = fails_of;
    }

    /// Lists all stored sculptures, and the tombstones of deleted ones.
    ///
    /// # Panics
    /// The store fails.
    pub fn list_all(&self) -> (Vec<Sculpture>, Vec<Tombstone>) {
        let list = |tx: &mut (dyn Transaction + '_)| {
            Ok::<_, StoreError>((tx.find("ORDER BY id", &[])?, tx.find("ORDER BY id", &[])?))
        };
        view(&self.store.inner, list).expect("a store in memory")
    }

    /// Lists announced sculptures that haven't arrived, by headset and id.
    ///
    /// # Panics
    /// The store fails.
    pub fn list_missing(&self) -> Vec<(u32, [u8; 16])> {
        let all = view(&self.store.inner, |tx| tx.find("ORDER BY headset, sculpture", &[]));
        let missing: Vec<Announcement> = all.expect("a store in memory");
        missing.iter().map(|missing| (missing.headset, missing.sculpture)).collect()
    }

    /// Returns a command given to a headset.
    ///
    /// # Panics
    /// The command doesn't exist.
    pub fn find_command(&self, headset: u32, id: u64) -> Command {
        let found = view(&self.store.inner, |tx| tx.get(&[&headset, &id]));
        found.expect("a store in memory").expect("a command that was given")
    }

    /// Handles a device's request and returns the HTTP response.
    pub fn serve(&self, device: u8, request: &BoothRequest, now: BoothTime) -> HttpAnswer {
        let (status, retry_after, body) = match self.answer(device, request, now) {
            Ok((status, body)) => (status, None, body),
            Err(refusal) => (refusal.status(), refusal.retry_after(), Vec::new()),
        };
        HttpAnswer { status, retry_after, body }
    }

    fn answer(
        &self,
        device: u8,
        request: &BoothRequest,
        now: BoothTime,
    ) -> Result<(u16, Vec<u8>), Refusal> {
        let device = self.booth.authenticate(&token_of(device))?;
        match request.kind {
            RequestKind::Heartbeat => {
                let beat = Heartbeat::from_json(&request.body);
                let beat = beat.map_err(|bad| Refusal::BadRequest(bad.to_string()))?;
                let answer = self.booth.take_heartbeat(&device, &beat, now)?;
                Ok((200, answer.to_json()))
            }
            RequestKind::Put(id) => {
                let outcome =
                    self.booth.take_parcel(device.headset, id, &request.body, &decode, now)?;
                Ok((outcome.status(), outcome.body().to_vec()))
            }
        }
    }
}

fn make_booth(store: &Arc<SimStore>, files: &Arc<SimFiles>) -> Booth {
    let keys = SiteKeys::new(SITE, ContentHash([6; 32]), [8; 32]);
    Booth::new(store.clone(), files.clone(), keys, BoothPlan::default())
}

/// Returns a device's token.
fn token_of(device: u8) -> DeviceToken {
    DeviceToken([device + 1; 32])
}

pub(crate) fn decode(facts: &UploadFacts, volume: &[u8], _trace: &[u8]) -> Result<(), String> {
    let is_sound = !is_poison(facts) && volume.len() == facts.volume_bytes as usize;
    if is_sound { Ok(()) } else { Err("no volume".into()) }
}
