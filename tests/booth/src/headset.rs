//! A headset: its disk, its link, and the outbox's sender while the program runs.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::rc::Rc;

use paros_models::random_visitor::RandomSource;
use paros_protocol::{HeadsetStatus, Parcel, SiteId};
use paros_upload::{OutboxEvent, OutboxFolder, OutboxHost, Sender};
use paros_upload::{OutboxOwner, OutboxSettings};

use crate::disk::{SimDisk, SimFolder};
use crate::network::{SimLink, Wire};
use crate::truth::number_of_facts;

/// The shell around the sender.
#[derive(Debug)]
pub struct SimHost {
    /// The device's clock, in milliseconds.
    pub clock_ms: u64,
    /// The id of the current visit.
    pub session_id: u64,
    /// Events that haven't been handled yet.
    pub events: Vec<OutboxEvent>,
    dice: RandomSource,
}

/// A headset.
#[derive(Debug)]
pub struct SimHeadset {
    /// The booth's number of this headset.
    pub number: u32,
    /// Its disk.
    pub disk: Rc<RefCell<SimDisk>>,
    /// Requests sent, and responses received.
    pub wire: Rc<RefCell<Wire>>,
    /// Number of starts so far.
    pub start: u32,
    /// The id of the current start.
    pub boot_id: u64,
    /// The sender; `None` while the program is off.
    pub sender: Option<Sender<SimFolder, SimLink>>,
    /// The shell around it.
    pub host: SimHost,
    /// Numbers of finished sculptures whose parcels are still being made.
    pub pending: Vec<usize>,
    settings: OutboxSettings,
}

impl OutboxHost for SimHost {
    fn now_ms(&mut self) -> u64 {
        self.clock_ms
    }

    fn random(&mut self) -> u32 {
        self.dice.next_bits() as u32
    }

    fn status(&mut self) -> HeadsetStatus {
        let session_id = self.session_id;
        HeadsetStatus { session_id, is_worn: session_id != 0, ..HeadsetStatus::default() }
    }

    fn on_event(&mut self, event: OutboxEvent) {
        self.events.push(event);
    }
}

impl SimHeadset {
    /// Creates a headset that is off and has an empty disk.
    pub fn new(number: u32, settings: OutboxSettings, dice: &mut RandomSource) -> Self {
        let is_lazy = dice.one_in(3);
        let disk = Rc::new(RefCell::new(SimDisk::new(dice.next_bits(), is_lazy)));
        let host = SimHost {
            clock_ms: dice.below(1 << 40),
            session_id: 0,
            events: Vec::new(),
            dice: RandomSource::new(dice.next_bits()),
        };
        SimHeadset {
            number,
            disk,
            wire: Rc::default(),
            start: 0,
            boot_id: 0,
            sender: None,
            host,
            pending: Vec::new(),
            settings,
        }
    }

    /// Turns the power on and starts the program.
    pub fn power_up(&mut self, site: SiteId) {
        self.disk.borrow_mut().power_up();
        self.start += 1;
        self.boot_id = self.host.dice.next_bits() | 1;
        self.wire = Rc::default();
        self.host.session_id = self.host.dice.below(2) * self.host.dice.next_bits();
        let owner = OutboxOwner { site, headset: self.number };
        let (folder, link) = (SimFolder(self.disk.clone()), SimLink(self.wire.clone()));
        let opened = Sender::open(folder, link, owner, self.settings, self.boot_id);
        self.sender = opened.ok();
        self.see_whether_it_is_dead();
    }

    /// Kills the program. Parcels that weren't stored yet are lost.
    pub fn kill(&mut self) {
        self.sender = None;
        self.host.events.clear();
        self.pending.clear();
        self.wire = Rc::default();
    }

    /// Ends the program if the power failed in the last call. Returns `true` if it did.
    pub fn see_whether_it_is_dead(&mut self) -> bool {
        let is_dead = self.disk.borrow().is_dead;
        if is_dead {
            self.kill();
        }
        is_dead
    }

    /// Lists the sculptures whose parcels are intact in the folder, by number.
    pub fn list_parcels(&self) -> BTreeSet<usize> {
        self.list_files().iter().filter_map(|name| self.number_in_file(name)).collect()
    }

    /// Returns the number of the sculpture in a file, or `None` if the file isn't an intact parcel.
    pub fn number_in_file(&self, name: &str) -> Option<usize> {
        let disk = self.disk.borrow();
        let is_parcel = [".parcel", ".refused", ".sent"].iter().any(|end| name.ends_with(end));
        let bytes = disk.peek(name).filter(|_| is_parcel)?;
        let parcel = Parcel::read(bytes).ok()?;
        Some(number_of_facts(parcel.facts()))
    }

    /// Lists the file names in the folder.
    pub fn list_files(&self) -> Vec<String> {
        SimFolder(self.disk.clone()).list().unwrap_or_default()
    }
}
