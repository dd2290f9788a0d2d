//! A headset: its disk, its link, and the outbox's sender while it is on.

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

/// The shell around a sender.
#[derive(Debug)]
pub struct SimHost {
    /// Its clock.
    pub clock_ms: u64,
    /// Of this visit.
    pub session_id: u64,
    /// What happened and wasn't looked at yet.
    pub events: Vec<OutboxEvent>,
    dice: RandomSource,
}

/// A headset.
#[derive(Debug)]
pub struct SimHeadset {
    /// Its number at the booth.
    pub number: u32,
    /// Its disk.
    pub disk: Rc<RefCell<SimDisk>>,
    /// What it sends and hears.
    pub wire: Rc<RefCell<Wire>>,
    /// How often it was started.
    pub start: u32,
    /// Of this start.
    pub boot_id: u64,
    /// The sender while it is on.
    pub sender: Option<Sender<SimFolder, SimLink>>,
    /// The shell around it.
    pub host: SimHost,
    /// Sculptures that are finished and whose parcels are being made, by number.
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
    /// One that is off, with an empty disk.
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

    /// Starts its program. The power is back.
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

    /// Ends its program at once. What was made and not kept is forgotten by the program.
    pub fn kill(&mut self) {
        self.sender = None;
        self.host.events.clear();
        self.pending.clear();
        self.wire = Rc::default();
    }

    /// Whether the power was lost in the last call: then its program has ended.
    pub fn see_whether_it_is_dead(&mut self) -> bool {
        let is_dead = self.disk.borrow().is_dead;
        if is_dead {
            self.kill();
        }
        is_dead
    }

    /// The numbers of sculptures whose parcels are in the folder as they should be.
    pub fn list_parcels(&self) -> BTreeSet<usize> {
        self.list_files().iter().filter_map(|name| self.number_in_file(name)).collect()
    }

    /// The number of the sculpture in a file, where that is a parcel as it should be.
    pub fn number_in_file(&self, name: &str) -> Option<usize> {
        let disk = self.disk.borrow();
        let is_parcel = [".parcel", ".refused", ".sent"].iter().any(|end| name.ends_with(end));
        let bytes = disk.peek(name).filter(|_| is_parcel)?;
        let parcel = Parcel::read(bytes).ok()?;
        Some(number_of_facts(parcel.facts()))
    }

    /// The names of its files.
    pub fn list_files(&self) -> Vec<String> {
        SimFolder(self.disk.clone()).list().unwrap_or_default()
    }
}
