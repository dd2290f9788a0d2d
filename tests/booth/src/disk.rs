//! A simulated disk that can be full, fail, corrupt bits, and lose power during a write.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::io::{self, ErrorKind};
use std::rc::Rc;

use paros_models::random_visitor::RandomSource;
use paros_upload::OutboxFolder;

/// A headset's disk.
#[derive(Debug)]
pub struct SimDisk {
    /// The files' current contents, as programs see them.
    files: BTreeMap<String, Vec<u8>>,
    /// When each file was written or renamed, in seconds.
    times: BTreeMap<String, u64>,
    /// The device's clock, in seconds.
    pub now_s: u64,
    /// Names removed or replaced and not synced yet, with their old contents: a loss of power may restore
    /// these.
    unsynced: BTreeMap<String, Vec<u8>>,
    /// `true` if folders can't be synced, as on some file systems.
    is_lazy: bool,
    /// `true` if writes are refused.
    pub is_full: bool,
    /// Number of calls until the power fails.
    fuse: Option<u32>,
    /// `true` if the power is off: nothing is written or sent any more.
    pub is_dead: bool,
    /// `true` if calls fail at random.
    is_worn: bool,
    dice: RandomSource,
}

/// The folder of an outbox on a simulated disk.
#[derive(Clone, Debug)]
pub struct SimFolder(pub Rc<RefCell<SimDisk>>);

impl SimDisk {
    /// Creates an empty disk.
    pub fn new(seed: u64, is_lazy: bool) -> Self {
        SimDisk {
            files: BTreeMap::new(),
            times: BTreeMap::new(),
            now_s: 0,
            unsynced: BTreeMap::new(),
            is_lazy,
            is_full: false,
            fuse: None,
            is_dead: false,
            is_worn: true,
            dice: RandomSource::new(seed),
        }
    }

    /// Schedules a power loss during the call number `calls` from now, counted from 0.
    pub fn set_fuse(&mut self, calls: u32) {
        self.fuse = Some(calls);
    }

    /// Turns the power on, at times for a few calls only. Unsynced changes may be rolled back.
    pub fn power_up(&mut self) {
        (self.fuse, self.is_dead) = (None, false);
        if self.is_worn && self.dice.one_in(5) {
            self.fuse = Some(self.dice.below(4) as u32);
        }
        for (name, bytes) in std::mem::take(&mut self.unsynced) {
            if self.dice.one_in(2) {
                self.files.entry(name).or_insert(bytes);
            }
        }
    }

    /// Turns all failures off.
    pub fn mend(&mut self) {
        (self.is_full, self.is_worn, self.fuse) = (false, false, None);
    }

    /// Deletes all files.
    pub fn wipe(&mut self) {
        self.files.clear();
        self.unsynced.clear();
    }

    /// Flips a bit of a file.
    pub fn rot(&mut self, name: &str) {
        let Some(bytes) = self.files.get_mut(name) else { return };
        let (at, bit) = (self.dice.below(bytes.len().max(1) as u64), self.dice.below(8));
        if let Some(byte) = bytes.get_mut(at as usize) {
            *byte ^= 1 << bit;
        }
    }

    /// Returns the bytes of a file.
    pub fn peek(&self, name: &str) -> Option<&[u8]> {
        self.files.get(name).map(Vec::as_slice)
    }

    /// Returns `true` if the power fails during this call.
    fn burns(&mut self) -> bool {
        if let Some(calls) = &mut self.fuse {
            self.is_dead |= *calls == 0;
            *calls = calls.saturating_sub(1);
        }
        self.is_dead
    }

    fn put(&mut self, name: &str, bytes: &[u8]) {
        self.unsynced.remove(name);
        self.times.insert(name.into(), self.now_s);
        self.files.insert(name.into(), bytes.to_vec());
    }

    fn take(&mut self, name: &str) -> Option<Vec<u8>> {
        let bytes = self.files.remove(name)?;
        if self.is_lazy {
            self.unsynced.insert(name.into(), bytes.clone());
        }
        Some(bytes)
    }

    /// Writes a file atomically. On a loss of power the file is either old or new, and a temporary file may
    /// be left behind.
    ///
    /// # Errors
    /// The disk is full, fails or has no power.
    pub fn write(&mut self, name: &str, bytes: &[u8]) -> io::Result<()> {
        if self.is_dead {
            return Err(ErrorKind::BrokenPipe.into());
        }
        if self.burns() {
            match self.dice.below(3) {
                0 => self.put(name, bytes),
                1 => {
                    let len = self.dice.below(bytes.len() as u64 + 1) as usize;
                    let number = self.dice.below(100);
                    self.put(&format!(".paros-1-{number}.part"), &bytes[..len]);
                }
                _ => {}
            }
            return Err(ErrorKind::BrokenPipe.into());
        }
        if self.is_full {
            return Err(ErrorKind::StorageFull.into());
        }
        if self.is_worn && self.dice.one_in(60) {
            // Either only the final sync fails, or the first call.
            if self.dice.one_in(2) {
                self.put(name, bytes);
            }
            return Err(ErrorKind::Other.into());
        }
        self.put(name, bytes);
        Ok(())
    }
}

impl OutboxFolder for SimFolder {
    fn list(&self) -> io::Result<Vec<String>> {
        Ok(self.0.borrow().files.keys().cloned().collect())
    }

    fn read(&self, name: &str, most: u64) -> io::Result<Vec<u8>> {
        let mut disk = self.0.borrow_mut();
        if disk.is_dead || disk.is_worn && disk.dice.one_in(200) {
            return Err(ErrorKind::Other.into());
        }
        let bytes = disk.files.get(name).ok_or(ErrorKind::NotFound)?;
        if bytes.len() as u64 > most {
            Err(ErrorKind::FileTooLarge.into())
        } else {
            Ok(bytes.clone())
        }
    }

    fn write(&mut self, name: &str, bytes: &[u8]) -> io::Result<()> {
        self.0.borrow_mut().write(name, bytes)
    }

    fn rename(&mut self, from: &str, to: &str) -> io::Result<()> {
        let mut disk = self.0.borrow_mut();
        let was_dead = disk.is_dead;
        let is_done = !disk.burns() || !was_dead && disk.dice.one_in(2);
        if is_done {
            let bytes = disk.take(from).ok_or(ErrorKind::NotFound)?;
            disk.put(to, &bytes);
        }
        if disk.is_dead { Err(ErrorKind::BrokenPipe.into()) } else { Ok(()) }
    }

    fn age_seconds(&self, name: &str) -> u64 {
        let disk = self.0.borrow();
        disk.times.get(name).map_or(0, |written| disk.now_s.saturating_sub(*written))
    }

    fn remove(&mut self, name: &str) -> io::Result<()> {
        let mut disk = self.0.borrow_mut();
        let was_dead = disk.is_dead;
        let is_done = !disk.burns() || !was_dead && disk.dice.one_in(2);
        if is_done {
            disk.take(name);
        }
        if disk.is_dead { Err(ErrorKind::BrokenPipe.into()) } else { Ok(()) }
    }
}
