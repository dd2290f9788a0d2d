//! A disk that is full, fails, rots, and loses its power in the middle of a write.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::io::{self, ErrorKind};
use std::rc::Rc;

use paros_models::random_visitor::RandomSource;
use paros_upload::OutboxFolder;

/// A headset's disk.
#[derive(Debug)]
pub struct SimDisk {
    /// The files as programs see them.
    files: BTreeMap<String, Vec<u8>>,
    /// When each file was written or renamed, in seconds.
    times: BTreeMap<String, u64>,
    /// The device's clock, in seconds.
    pub now_s: u64,
    /// Names that were removed or exchanged and not synced: after a loss of power they may be back.
    unsynced: BTreeMap<String, Vec<u8>>,
    /// Whether folders can't be synced, as on some storages.
    is_lazy: bool,
    /// Whether writes are refused.
    pub is_full: bool,
    /// Calls until the power is lost.
    fuse: Option<u32>,
    /// Whether it is lost: nothing is written or sent any more.
    pub is_dead: bool,
    /// Whether calls fail for no reason.
    is_worn: bool,
    dice: RandomSource,
}

/// The folder of an outbox on such a disk.
#[derive(Clone, Debug)]
pub struct SimFolder(pub Rc<RefCell<SimDisk>>);

impl SimDisk {
    /// An empty disk.
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

    /// The power will be lost in the midst of this call from now on, counted from 0.
    pub fn set_fuse(&mut self, calls: u32) {
        self.fuse = Some(calls);
    }

    /// The power is back, now and then for some calls only, and what wasn't synced may be as it was.
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

    /// From now on nothing fails.
    pub fn mend(&mut self) {
        (self.is_full, self.is_worn, self.fuse) = (false, false, None);
    }

    /// Forgets all files.
    pub fn wipe(&mut self) {
        self.files.clear();
        self.unsynced.clear();
    }

    /// Changes a bit of a file.
    pub fn rot(&mut self, name: &str) {
        let Some(bytes) = self.files.get_mut(name) else { return };
        let (at, bit) = (self.dice.below(bytes.len().max(1) as u64), self.dice.below(8));
        if let Some(byte) = bytes.get_mut(at as usize) {
            *byte ^= 1 << bit;
        }
    }

    /// The bytes of a file.
    pub fn peek(&self, name: &str) -> Option<&[u8]> {
        self.files.get(name).map(Vec::as_slice)
    }

    /// Whether the power is lost in this call.
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

    /// Writes a file whole or not at all; where the power is lost, one of both, or leaves what was begun.
    ///
    /// # Errors
    /// That the disk is full, fails or has no power.
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
            // Only the last sync of all fails, or the first call.
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
