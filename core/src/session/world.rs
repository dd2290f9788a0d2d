//! The world: the complete state of a session, and the fixed time step that advances it.
//!
//! [`World::step`] runs, in order: session start, input of head and hands, stool and commands, grabbing of
//! tools and sizes of bits, contact and edit of each hand, island search, fall of dropped tools, the visit.
//! Only `step` and [`World::load`] change the state.

use glam::Vec3;
use heapless::Vec;

use crate::edit::contact::Contact;
use crate::edit::islands::IslandSearch;
use crate::edit::operation::{EditReport, EditScratch};
use crate::edit::pose::Pose;
use crate::edit::undo::{UndoCounts, UndoHistory};
use crate::limits::MAX_EVENTS;
use crate::session::bared::BaredEnds;
use crate::session::events::WorldEvent;
use crate::session::hand::{HandPresses, HandState};
use crate::session::input::{HandInput, RawPose, SessionMode, TickInput};
use crate::session::ledger::TickLedger;
use crate::session::start_volumes::StartVolumes;
use crate::session::state::{SessionState, WorldState};
use crate::session::step::metres_from_um;
use crate::session::stool_frame::StoolFrame;
use crate::session::tools::{Tool, ToolBit, ToolBitSpec};
use crate::session::workbench::Workbench;
use crate::visit::Visit;
use crate::volume::dirty::DirtyRects;
use crate::volume::editable::Volume;
use crate::volume::range_maps::RangeMaps;
use crate::volume::size::{Grid, Size};

/// The complete state of a session on a grid of N^3 voxels.
#[derive(Debug)]
pub struct World<const N: usize, const K: usize = 1>
where
    Grid<N>: Size,
{
    /// The sculpture.
    pub(crate) volume: Volume<N, K>,
    /// The protected voxels, a part of `volume`.
    pub(crate) mask: RangeMaps<N, K>,
    /// Columns changed by each stroke, for undo and redo.
    pub(crate) undo: UndoHistory<N, K>,
    /// The search for unsupported voxels, which takes several ticks.
    pub(crate) islands: IslandSearch<N>,
    /// All other state that outlives a tick.
    pub(crate) state: WorldState,
    /// Working memory of an edit.
    pub(crate) scratch: EditScratch<N>,
    /// Columns changed in the last tick.
    pub(crate) dirty: DirtyRects,
    /// Events of the last tick.
    pub(crate) events: Vec<WorldEvent, MAX_EVENTS>,
    /// The part of the hidden figure that is bared, derived from volume and mask.
    pub(crate) bared: BaredEnds,
    /// Contacts of both hands in the last tick, valid where `has_contact` is `true`. Two fields, because
    /// `None` of an `Option<Contact>` isn't all zero bytes.
    pub(crate) contacts: [Contact; 2],
    /// `true` for each hand whose tool was stepped in the last tick.
    pub(crate) has_contact: [bool; 2],
}

impl<const N: usize, const K: usize> World<N, K>
where
    Grid<N>: Size,
{
    /// Creates an empty world that waits for a session; all zero bytes. Use it in a `static Mutex` or
    /// similar: `Box::new` builds it on the stack first, which overflows at 256.
    #[must_use]
    #[allow(clippy::new_without_default)] // a Default would hand the world about by value
    pub const fn new() -> Self {
        World {
            volume: Volume::new(),
            mask: RangeMaps::new(),
            undo: UndoHistory::new(),
            islands: IslandSearch::new(),
            state: WorldState::new(),
            scratch: EditScratch::new(),
            dirty: DirtyRects::new(),
            events: Vec::new(),
            bared: BaredEnds::NONE,
            contacts: [Contact::NONE; 2],
            has_contact: [false; 2],
        }
    }

    /// Advances the world by one tick, 1/72 s. The start volumes are read only if `input` or the visit starts
    /// a session.
    #[inline(never)]
    pub fn step(&mut self, input: &TickInput, starts: &StartVolumes<'_, N, K>) {
        self.events.clear();
        self.dirty.clear();
        self.has_contact = [false; 2];
        let has_started =
            input.start != SessionMode::None && self.start_session(input.start, starts);
        if let Some((position, rotation)) = input.head.to_clamped_metres() {
            self.state.head = (position, rotation);
        }
        let was_stroke_open = self.is_stroke_open();
        let last_stool = self.state.stool;
        let mut presses = [0, 1].map(|hand| self.state.hands[hand].apply_input(&input.hands[hand]));
        if self.state.session == SessionState::Sculpting {
            if self.state.visit.phase().lets_hands_work() {
                let rewound = self.apply_inputs_of_sculpting(input, &mut presses);
                if self.is_stroke_open() && !was_stroke_open {
                    self.undo.begin_stroke();
                }
                let counting = if has_started { 0 } else { self.count_next_axis() };
                self.share_out_work(presses, rewound, counting);
            } else {
                self.settle_without_hands();
            }
            self.tell_bared_part();
        }
        self.state.bench.step_dropped_items();
        self.advance_visit(&input.visit, last_stool, starts);
        self.state.tick = self.state.tick.wrapping_add(1);
    }

    /// Applies stool, commands, and the hands' grabbing, releasing and resizing. Returns the number of
    /// columns that undo or redo swapped. Swapping the hands clears their trigger presses.
    fn apply_inputs_of_sculpting(
        &mut self,
        input: &TickInput,
        presses: &mut [HandPresses; 2],
    ) -> u32 {
        self.turn_stool(input, *presses);
        let rewound = self.apply_commands(input, presses).rewound_columns;
        self.apply_pointer_command(input.pointer);
        for (hand, presses) in presses.iter().enumerate() {
            self.grab_or_release_on_squeeze(hand, *presses);
        }
        self.resize_bits(input.pointer, *presses);
        rewound
    }

    /// Continues the island search while the visit keeps hands off.
    fn settle_without_hands(&mut self) {
        self.state.hands.iter_mut().for_each(HandState::drop_trail);
        let mut ledger = TickLedger::open(N, K, 0, self.islands.is_removal_due());
        ledger.charge(self.count_next_axis());
        self.advance_island_search(ledger.island_row_visits());
    }

    /// Runs the hands' tools and the island search within the remaining work of a tick. The hands take turns
    /// in going first, so that neither always gets less than the other.
    fn share_out_work(&mut self, presses: [HandPresses; 2], rewound_columns: u32, done: u32) {
        let is_removal_due = self.islands.is_removal_due();
        let mut ledger = TickLedger::open(N, K, rewound_columns, is_removal_due);
        ledger.charge(done);
        let first = (self.state.tick & 1) as usize;
        let second = 1 - first;
        let hands_left = if self.is_tool_in_use(second) { 2 } else { 1 };
        for (hand, hands_left) in [(first, hands_left), (second, 1)] {
            let spent = self.step_tool(hand, presses[hand], ledger.hand_share(hands_left));
            ledger.charge(spent);
        }
        self.advance_island_search(ledger.island_row_visits());
    }

    /// Ticks since the world began.
    #[must_use]
    pub const fn tick(&self) -> u64 {
        self.state.tick
    }

    /// Returns the visit that the session belongs to; its phase is `Closed` if there are no visits.
    #[must_use]
    pub const fn visit(&self) -> &Visit {
        &self.state.visit
    }

    /// Returns the phase of the session.
    #[must_use]
    pub const fn session_state(&self) -> SessionState {
        self.state.session
    }

    /// Returns the mode in which the session started.
    #[must_use]
    pub const fn mode(&self) -> SessionMode {
        self.state.mode
    }

    /// Returns `true` if edits are mirrored.
    #[must_use]
    pub const fn is_mirrored(&self) -> bool {
        self.state.symmetry
    }

    /// Returns the volume.
    #[must_use]
    pub const fn volume(&self) -> &Volume<N, K> {
        &self.volume
    }

    /// Returns the voxels that can't be removed; empty except in the constrained mode.
    #[must_use]
    pub const fn mask(&self) -> &RangeMaps<N, K> {
        &self.mask
    }

    /// Returns the bared part of the hidden figure. Its ends are counted in the three ticks after a session's
    /// first; until then the result is empty.
    #[must_use]
    pub const fn bared_ends(&self) -> BaredEnds {
        if self.is_figure_counted() { self.bared } else { BaredEnds::NONE }
    }

    /// Returns `true` if no island search is running or requested.
    #[must_use]
    pub const fn is_settled(&self) -> bool {
        !self.islands.is_busy()
    }

    /// Returns the events of the last tick.
    #[must_use]
    pub fn events(&self) -> &[WorldEvent] {
        &self.events
    }

    /// Returns the combined report of a hand's edits in the last tick: the sum of its [`WorldEvent::Edited`].
    #[must_use]
    pub fn edit_report(&self, hand: usize) -> EditReport {
        let reports = self.events.iter().filter_map(|event| match event {
            WorldEvent::Edited { hand: of, report, .. } if usize::from(*of) == hand => Some(report),
            _ => None,
        });
        reports.fold(EditReport::default(), |sum, report| sum.sum_with(*report))
    }

    /// Returns the rectangles of each axis map that changed in the last tick.
    #[must_use]
    pub const fn dirty_rects(&self) -> &DirtyRects {
        &self.dirty
    }

    /// Returns the numbers of strokes that can be undone and redone.
    #[must_use]
    pub fn undo_counts(&self) -> UndoCounts {
        self.undo.undo_counts()
    }

    /// Returns the transform between the room and the grid on its stool.
    #[must_use]
    pub fn stool_frame(&self) -> StoolFrame {
        StoolFrame::new(self.state.stool, N)
    }

    /// Returns the bench and the places of all tools and bits.
    #[must_use]
    pub const fn workbench(&self) -> &Workbench {
        &self.state.bench
    }

    /// Returns the state of a hand: 0 left, 1 right.
    #[must_use]
    pub const fn hand_state(&self, hand: usize) -> &HandState {
        &self.state.hands[hand & 1]
    }

    /// Returns the tool in a hand and the bit on it.
    #[must_use]
    pub fn held_tool(&self, hand: usize) -> Option<(Tool, ToolBit)> {
        let tool = self.state.bench.held_tool(hand)?;
        Some((tool, self.state.bench.mounted_bit(tool)))
    }

    /// Returns the table entry of the held bit at its current size.
    #[must_use]
    pub fn held_bit_spec(&self, hand: usize) -> Option<ToolBitSpec> {
        let (_, bit) = self.held_tool(hand)?;
        Some(bit.spec_at(self.state.bench.size_of(bit)))
    }

    /// Returns the input of a tracked hand that holds its bit at `bit_pose`, in the grid, with nothing in its
    /// way: the inverse of how [`World::step`] interprets a grip's pose. Without a tool, `bit_pose` is the
    /// pose of the grip.
    #[must_use]
    pub fn hand_with_bit_at(&self, hand: usize, bit_pose: &Pose) -> HandInput {
        let length = self.held_tool(hand).map_or(0.0, |(tool, _)| tool.length_um() as f32 * 1e-6);
        let (tip, rotation) = self.stool_frame().to_room(bit_pose);
        let grip = RawPose::quantise(tip - rotation * Vec3::NEG_Z * length, rotation);
        HandInput { aim: grip, grip, tracked: true, ..HandInput::default() }
    }

    /// Returns `true` while a stroke is in progress: a hand of a sculpting session runs the tool that it
    /// holds, or its bit finishes the trail of the last pull. All edits of both hands from the first tick
    /// that ends with `true` belong to one undo entry, whichever triggers are pulled and released and
    /// whatever bits are exchanged meanwhile. The entry is complete in the first tick that ends with `false`,
    /// except for islands that fall later, and in a tick with an undo or redo.
    #[must_use]
    pub fn is_stroke_open(&self) -> bool {
        let runs = |hand: usize| {
            self.hand_state(hand).is_running() && self.state.bench.held_tool(hand).is_some()
        };
        self.state.session == SessionState::Sculpting && (runs(0) || runs(1))
    }

    /// Returns the contact of the held bit in the last tick, or `None` if no tool was stepped.
    #[must_use]
    pub fn hand_contact(&self, hand: usize) -> Option<Contact> {
        self.has_contact[hand & 1].then_some(self.contacts[hand & 1])
    }

    /// Returns the length of the string on which running bits are pulled behind their hands, in millimetres;
    /// 0 without a string.
    #[must_use]
    pub const fn string_mm(&self) -> u8 {
        self.state.string_mm
    }

    /// Returns the offset of the held bit from its position in the hand, caused by the volume and by the
    /// string; in metres, in the room.
    #[must_use]
    pub fn push_out_metres(&self, hand: usize) -> Vec3 {
        let (state, frame) = (self.hand_state(hand), self.stool_frame());
        match self.held_tool(hand).filter(|_| state.has_frozen_pose) {
            Some((tool, _)) => {
                let in_hand = state.bit_centre_pose(metres_from_um(tool.length_um())).0;
                frame.to_room(&state.frozen_pose).0 - in_hand
            }
            None => Vec3::ZERO,
        }
    }

    /// Marks all columns as changed and drops the last tick's events and contacts, after a load.
    pub(crate) fn mark_all_changed(&mut self) {
        self.events.clear();
        self.has_contact = [false; 2];
        self.dirty.mark_all(N);
    }
}
