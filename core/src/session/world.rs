//! The world: the complete state of a session, and the fixed time step that advances it.
//!
//! [`World::step`] runs, in order: session start, input of head and hands, stool and commands, grabbing
//! of tools and sizes of bits, contact and edit of each hand, island search, fall of dropped tools, the visit. Only it and
//! [`World::load`] change the state.

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
    /// How much of the hidden figure is bared: follows from volume and mask.
    pub(crate) bared: BaredEnds,
    /// Contacts of both hands in the last tick, valid where `has_contact`. Two fields, because `None` of
    /// an `Option<Contact>` isn't all zero bytes.
    pub(crate) contacts: [Contact; 2],
    /// Whether the hand's tool was stepped in the last tick.
    pub(crate) has_contact: [bool; 2],
}

impl<const N: usize, const K: usize> World<N, K>
where
    Grid<N>: Size,
{
    /// An empty world that waits for a session; all zero bytes. For a `static Mutex` or the
    /// like: `Box::new` builds it on the stack first, which at 256 overflows.
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

    /// Advances the world by one tick, 1/72 s. Start volumes are read only where `input` starts a
    /// session.
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

    /// Stool, commands, and what hands take, let go of and resize. Returns the columns that undo or redo swapped. A
    /// pull that a swap of the hands has ended is no press any more.
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

    /// Lets what is unsupported fall, while the visit has hands off.
    fn settle_without_hands(&mut self) {
        self.state.hands.iter_mut().for_each(HandState::drop_trail);
        let mut ledger = TickLedger::open(N, K, 0, self.islands.is_removal_due());
        ledger.charge(self.count_next_axis());
        self.advance_island_search(ledger.island_row_visits());
    }

    /// What the hands' tools and the island search do, within what is left of a tick's work. Hands begin in turn, so that
    /// neither always finds less than the other.
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

    /// The visit that the session belongs to, if visits are held.
    #[must_use]
    pub const fn visit(&self) -> &Visit {
        &self.state.visit
    }

    /// The phase of the session.
    #[must_use]
    pub const fn session_state(&self) -> SessionState {
        self.state.session
    }

    /// How the session started.
    #[must_use]
    pub const fn mode(&self) -> SessionMode {
        self.state.mode
    }

    /// Whether edits are mirrored.
    #[must_use]
    pub const fn is_mirrored(&self) -> bool {
        self.state.symmetry
    }

    /// The volume.
    #[must_use]
    pub const fn volume(&self) -> &Volume<N, K> {
        &self.volume
    }

    /// The voxels that can't be removed; empty but in the constrained mode.
    #[must_use]
    pub const fn mask(&self) -> &RangeMaps<N, K> {
        &self.mask
    }

    /// How much of the hidden figure is bared. Its ends are counted in the three ticks after a session's first; until
    /// then there are none.
    #[must_use]
    pub const fn bared_ends(&self) -> BaredEnds {
        if self.is_figure_counted() { self.bared } else { BaredEnds::NONE }
    }

    /// Whether no unsupported stone is looked for, and no edit calls for a search.
    #[must_use]
    pub const fn is_settled(&self) -> bool {
        !self.islands.is_busy()
    }

    /// What happened in the last tick.
    #[must_use]
    pub fn events(&self) -> &[WorldEvent] {
        &self.events
    }

    /// What a hand's edits of the last tick did, together: the sum of its [`WorldEvent::Edited`].
    #[must_use]
    pub fn edit_report(&self, hand: usize) -> EditReport {
        let reports = self.events.iter().filter_map(|event| match event {
            WorldEvent::Edited { hand: of, report, .. } if usize::from(*of) == hand => Some(report),
            _ => None,
        });
        reports.fold(EditReport::default(), |sum, report| sum.sum_with(*report))
    }

    /// The rectangles of each axis map that changed in the last tick.
    #[must_use]
    pub const fn dirty_rects(&self) -> &DirtyRects {
        &self.dirty
    }

    /// The numbers of strokes that can be undone and redone.
    #[must_use]
    pub fn undo_counts(&self) -> UndoCounts {
        self.undo.undo_counts()
    }

    /// The transform between the room and the grid on its stool.
    #[must_use]
    pub fn stool_frame(&self) -> StoolFrame {
        StoolFrame::new(self.state.stool, N)
    }

    /// The bench and the places of all tools and bits.
    #[must_use]
    pub const fn workbench(&self) -> &Workbench {
        &self.state.bench
    }

    /// The state of a hand: 0 left, 1 right.
    #[must_use]
    pub const fn hand_state(&self, hand: usize) -> &HandState {
        &self.state.hands[hand & 1]
    }

    /// The tool a hand holds and the bit on it.
    #[must_use]
    pub fn held_tool(&self, hand: usize) -> Option<(Tool, ToolBit)> {
        let tool = self.state.bench.held_tool(hand)?;
        Some((tool, self.state.bench.mounted_bit(tool)))
    }

    /// The bit that a hand holds, of the size that it has.
    #[must_use]
    pub fn held_bit_spec(&self, hand: usize) -> Option<ToolBitSpec> {
        let (_, bit) = self.held_tool(hand)?;
        Some(bit.spec_at(self.state.bench.size_of(bit)))
    }

    /// The input of a tracked hand that holds its bit at `bit_pose`, in the grid, while nothing is in its
    /// way: the inverse of what [`World::step`] does with a grip's pose. Without a tool it is the grip
    /// that is there.
    #[must_use]
    pub fn hand_with_bit_at(&self, hand: usize, bit_pose: &Pose) -> HandInput {
        let length = self.held_tool(hand).map_or(0.0, |(tool, _)| tool.length_um() as f32 * 1e-6);
        let (tip, rotation) = self.stool_frame().to_room(bit_pose);
        let grip = RawPose::quantise(tip - rotation * Vec3::NEG_Z * length, rotation);
        HandInput { aim: grip, grip, tracked: true, ..HandInput::default() }
    }

    /// Whether a stroke is under way: a hand of a sculpting session runs the tool that it holds, or its bit
    /// finishes the way of the last pull. What both
    /// hands edit from the first tick that ends with `true` belongs to one undo entry, whichever triggers
    /// are pulled and released and whatever bits are exchanged meanwhile. The entry is complete in the
    /// first tick that ends with `false`, but for islands that fall later, and in one of an undo or redo.
    #[must_use]
    pub fn is_stroke_open(&self) -> bool {
        let runs = |hand: usize| {
            self.hand_state(hand).is_running() && self.state.bench.held_tool(hand).is_some()
        };
        self.state.session == SessionState::Sculpting && (runs(0) || runs(1))
    }

    /// The contact of the held bit in the last tick; `None` where no tool was stepped.
    #[must_use]
    pub fn hand_contact(&self, hand: usize) -> Option<Contact> {
        self.has_contact[hand & 1].then_some(self.contacts[hand & 1])
    }

    /// The length of the string on which running bits are drawn behind their hands, in millimetres; 0 without one.
    #[must_use]
    pub const fn string_mm(&self) -> u8 {
        self.state.string_mm
    }

    /// The offset of the held bit from where its hand has it, as the volume holds it back and a string draws it; in
    /// metres, in the room.
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
