//! The world: `step` turns one tick's input into edits, events and a digest.
//!
//! A tick is, in order: session, hands and held tools, contact, edit, islands, digest. Nothing else
//! changes the state but [`World::load`](crate::world::World::load).

use glam::Vec3;
use heapless::Vec;

use crate::contact::Contact;
use crate::dirty::Dirty;
use crate::edit::EditScratch;
use crate::events::Event;
use crate::frame::Frame;
use crate::hand::Hand;
use crate::input::{Input, Mode};
use crate::islands::Islands;
use crate::limits::{EVENTS, LONG_WAY, short_walk_steps, walk_steps};
use crate::maps::Maps;
use crate::size::{Grid, Size};
use crate::state::State;
use crate::tools::{Bit, Tool};
use crate::undo::Undo;
use crate::volume::Volume;
use crate::workbench::Workbench;

/// The volumes that sessions start from. All are tight; each figure lies within the lump.
#[derive(Debug)]
pub struct Starts<'a, const N: usize> {
    /// The roughly cut stone of the free-form and constrained modes.
    pub lump: &'a Maps<N>,
    /// The hidden figures of the constrained mode.
    pub figures: &'a [&'a Maps<N>],
    /// The shape of the creative mode.
    pub creative: &'a Maps<N>,
    /// A volume of the visitor's own.
    pub own: Option<&'a Maps<N>>,
}

/// Where a session stands.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum Session {
    /// No session yet: nothing can be taken or edited.
    Waiting = 0,
    /// The visitor sculpts.
    Sculpting = 1,
    /// The sculpture takes no more edits.
    Finished = 2,
}

/// The whole state of a session, with N voxels a side.
#[derive(Debug)]
pub struct World<const N: usize>
where
    Grid<N>: Size,
{
    pub(crate) volume: Volume<N>,
    pub(crate) mask: Maps<N>,
    pub(crate) undo: Undo<N>,
    pub(crate) islands: Islands<N>,
    pub(crate) state: State,
    pub(crate) scratch: EditScratch<N>,
    pub(crate) dirty: Dirty,
    pub(crate) events: Vec<Event, EVENTS>,
    /// Of the last tick; not optional, as the niche of an `Option` isn't all zero bytes.
    pub(crate) contacts: [Contact; 2],
    pub(crate) felt: [bool; 2],
}

impl<const N: usize> World<N>
where
    Grid<N>: Size,
{
    /// An empty world that waits for a session: all zero bytes. For static initialisers only.
    #[must_use]
    #[allow(clippy::new_without_default)] // a Default would hand the world about by value
    pub const fn new() -> Self {
        World {
            volume: Volume::new(),
            mask: Maps::new(),
            undo: Undo::new(),
            islands: Islands::new(),
            state: State::new(),
            scratch: EditScratch::new(),
            dirty: Dirty::new(),
            events: Vec::new(),
            contacts: [Contact::NONE; 2],
            felt: [false; 2],
        }
    }

    /// One tick, a 72nd of a second.
    pub fn step(&mut self, input: &Input, starts: &Starts<'_, N>) {
        self.events.clear();
        self.dirty.clear();
        self.felt = [false; 2];
        if input.start != Mode::None {
            self.start(input.start, starts);
        }
        if let Some((position, rotation)) = input.head.metres() {
            self.state.head = (position, rotation);
        }
        let did = [0, 1].map(|hand| self.state.hands[hand].update(&input.hands[hand]));
        if self.state.session == Session::Sculpting {
            self.turn_stool(input);
            let rewound = self.command(input, did);
            self.point(input.pointer);
            for (hand, did) in did.into_iter().enumerate() {
                self.reach(hand, did);
            }
            // To lay out the volume anew is a tick's work, and so are long ways: the islands wait.
            let most = if rewound { short_walk_steps(N) } else { walk_steps(N) };
            let mut way = 0;
            for (hand, did) in did.into_iter().enumerate() {
                way += self.sculpt(hand, did, most);
            }
            if !rewound && way <= LONG_WAY {
                self.clear_islands();
            }
        }
        self.state.bench.step();
        self.state.tick = self.state.tick.wrapping_add(1);
    }

    /// Ticks since the world began.
    #[must_use]
    pub const fn tick(&self) -> u64 {
        self.state.tick
    }

    /// Where the session stands.
    #[must_use]
    pub const fn session(&self) -> Session {
        self.state.session
    }

    /// How the session started.
    #[must_use]
    pub const fn mode(&self) -> Mode {
        self.state.mode
    }

    /// Whether edits are mirrored.
    #[must_use]
    pub const fn symmetry(&self) -> bool {
        self.state.symmetry
    }

    /// The volume.
    #[must_use]
    pub const fn volume(&self) -> &Volume<N> {
        &self.volume
    }

    /// The voxels that can't be removed; empty but in the constrained mode.
    #[must_use]
    pub const fn mask(&self) -> &Maps<N> {
        &self.mask
    }

    /// What happened in the last tick.
    #[must_use]
    pub fn events(&self) -> &[Event] {
        &self.events
    }

    /// Which parts of the maps changed in the last tick.
    #[must_use]
    pub const fn dirty(&self) -> &Dirty {
        &self.dirty
    }

    /// Strokes that can be undone and redone.
    #[must_use]
    pub fn undo_counts(&self) -> (usize, usize) {
        self.undo.counts()
    }

    /// The stool and its turn.
    #[must_use]
    pub fn frame(&self) -> Frame {
        Frame::new(self.state.stool, N)
    }

    /// The bench and what lies on it.
    #[must_use]
    pub const fn bench(&self) -> &Workbench {
        &self.state.bench
    }

    /// A hand's state.
    #[must_use]
    pub const fn hand(&self, hand: usize) -> &Hand {
        &self.state.hands[hand & 1]
    }

    /// The tool a hand holds and the bit on it.
    #[must_use]
    pub fn held(&self, hand: usize) -> Option<(Tool, Bit)> {
        let tool = self.state.bench.held(hand)?;
        Some((tool, self.state.bench.mounted(tool)))
    }

    /// What the held bit touched in the last tick.
    #[must_use]
    pub fn contact(&self, hand: usize) -> Option<Contact> {
        self.felt[hand & 1].then_some(self.contacts[hand & 1])
    }

    /// How far the volume pushes the held bit from where the hand has it, in metres in the room.
    #[must_use]
    pub fn push_out(&self, hand: usize) -> Vec3 {
        let (state, frame) = (self.hand(hand), self.frame());
        match state.bound {
            true => frame.to_room(&state.frozen).0 - frame.to_room(&state.raw).0,
            false => Vec3::ZERO,
        }
    }

    /// Everything is another than before: after a load.
    pub(crate) fn refresh(&mut self) {
        self.events.clear();
        self.felt = [false; 2];
        self.dirty.note_all(N);
    }
}
