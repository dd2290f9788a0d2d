//! Dense model of `World::step`: the whole tick by its rules, slow and without optimisations. It takes the
//! same inputs and start volumes as the world, and computes the expected state, events and volume.
//!
//! It has its own bench, hands, strokes, ledger of work, undo history and islands. What it borrows from the
//! core makes no decision about voxels: poses, shapes of bits and brushes, the table of tools, capacities. It
//! reads one thing from the world's save: the voxels that the island search had reached a tick ago, which
//! [`islands`] checks.

mod bared;
pub mod bench;
pub mod comparison;
mod file;
mod float;
pub mod hand_input;
pub mod hands;
pub mod history;
pub mod islands;
pub mod ledger;
mod paste;
pub mod plan;
mod resize;
pub mod save;
pub mod session;
mod spall;
pub mod starts;
mod stool;
mod strike;
mod string;
pub mod trace;
pub mod volume;

use std::collections::VecDeque;

use glam::{Quat, Vec3};
use paros_core::edit::{Contact, IslandReport, Pose};
use paros_core::internals::{RoomPose, maps_digest};
use paros_core::limits::MAX_STRING_MM;
use paros_core::session::{
    BenchItem, HandState, PointerCommand, SessionMode, SessionState, StoolFrame, Tool, buttons,
    commands,
};
use paros_core::{StartVolumes, TickInput, WorldEvent};

use bench::BenchModel;
use hand_input::HandPresses;
use history::HistoryModel;
use islands::{IslandModel, IslandTick, PassEnd};
use ledger::Ledger;
use save::SeenPass;
use volume::StepVolume;

/// Returns an error from a function with `String` errors if a condition is false.
macro_rules! ensure {
    ($condition:expr, $($message:tt)+) => {
        if !$condition {
            return Err(format!($($message)+));
        }
    };
}
pub(crate) use ensure;

/// The model's state of a world.
#[derive(Clone, Debug)]
pub struct StepModel<const K: usize> {
    /// Number of ticks so far.
    pub tick: u64,
    /// The phase of the session.
    pub session: SessionState,
    /// The mode in which it started.
    pub mode: SessionMode,
    /// `true` if edits are mirrored.
    pub is_mirrored: bool,
    /// The length in millimetres of the string on which running bits follow their hands.
    pub string_mm: u8,
    /// The stool's rotation, in 65,536ths of a turn.
    pub stool: u16,
    /// The head's pose in the room.
    pub head: RoomPose,
    /// The state of both hands. Only the data type is the core's.
    pub hands: [HandState; 2],
    /// The poses of both hands, one a tick, that their running bits haven't followed yet.
    pub trails: [VecDeque<Pose>; 2],
    /// The places of tools and bits.
    pub bench: BenchModel,
    /// The sculpture.
    pub volume: StepVolume<K>,
    /// The hidden figure.
    pub mask: StepVolume<K>,
    /// The digest of the hidden figure.
    pub mask_digest: u64,
    /// Number of axes whose column ends are counted, one in each tick after the first.
    pub counted_axes: u8,
    /// The reported bared share in a save's encoding: tenths, 10 once the figure is found, 11 if all is
    /// bared.
    pub told: u8,
    /// The undo history.
    pub history: HistoryModel<K>,
    /// The island passes.
    pub islands: IslandModel,
    /// The events of the last tick.
    pub events: Vec<WorldEvent>,
    /// The contacts of both hands' bits in the last tick.
    pub contacts: [Option<Contact>; 2],
}

/// The initial pose of everything: all zeros.
const NOWHERE: RoomPose = (Vec3::ZERO, Quat::from_xyzw(0.0, 0.0, 0.0, 0.0));

impl<const K: usize> StepModel<K> {
    /// Creates the world before any session.
    pub fn new(side: usize) -> Self {
        StepModel {
            tick: 0,
            session: SessionState::Waiting,
            mode: SessionMode::None,
            is_mirrored: false,
            string_mm: 0,
            stool: 0,
            head: NOWHERE,
            hands: [hand_input::untracked_hand(); 2],
            trails: [VecDeque::new(), VecDeque::new()],
            bench: BenchModel::before_sessions(),
            volume: StepVolume::empty(side),
            mask: StepVolume::empty(side),
            mask_digest: 0,
            counted_axes: 0,
            told: 0,
            history: HistoryModel::new(side),
            islands: IslandModel::new(side),
            events: Vec::new(),
            contacts: [None; 2],
        }
    }

    /// Returns the grid's side in voxels.
    pub fn side(&self) -> usize {
        self.volume.voxels().side()
    }

    /// Returns the transform between room and grid.
    pub fn stool_frame(&self) -> StoolFrame {
        StoolFrame::new(self.stool, self.side())
    }

    /// Runs a tick. `seen` is the island search in the world's save after the same tick, `told` the world's
    /// events.
    ///
    /// # Errors
    /// The world's island search violates the bounds.
    pub fn step<const N: usize>(
        &mut self,
        input: &TickInput,
        starts: &StartVolumes<'_, N, K>,
        seen: &SeenPass,
        told: &[WorldEvent],
    ) -> Result<(), String> {
        self.events.clear();
        self.contacts = [None; 2];
        if input.start != SessionMode::None {
            self.start_session(input.start, starts);
        }
        let ran_a_tool = self.is_a_tool_running();
        if let Some(head) = input.head.to_clamped_metres() {
            self.head = head;
        }
        let mut presses =
            [0, 1].map(|i: usize| hand_input::apply_input(&mut self.hands[i], &input.hands[i]));
        for (trail, hand) in self.trails.iter_mut().zip(&self.hands) {
            if !hand.tracked {
                trail.clear();
            }
        }
        if self.session == SessionState::Sculpting {
            self.turn_stool(input, &presses);
            let rewound = self.apply_commands(input, &mut presses);
            self.apply_pointer(input.pointer);
            for (hand, presses) in presses.iter().enumerate() {
                self.grab_or_release_on_squeeze(hand, *presses);
            }
            for (hand, presses) in presses.iter().enumerate() {
                self.resize_held_bit(hand, presses.larger_by, input.pointer);
            }
            let has_started =
                self.events.iter().any(|event| matches!(event, WorldEvent::Started(_)));
            let counts = !has_started && self.count_next_axis();
            self.step_tools(&presses, ran_a_tool, (rewound, counts))?;
            let is_told = told.iter().any(|event| matches!(event, WorldEvent::Islands(_)));
            self.advance_islands(seen, is_told)?;
            self.tell_bared_part();
        }
        self.bench.step_dropped();
        self.tick += 1;
        Ok(())
    }

    /// Starts a session from its volume and resets everything except the clock and the head.
    fn start_session<const N: usize>(
        &mut self,
        mode: SessionMode,
        starts: &StartVolumes<'_, N, K>,
    ) {
        let (volume, mask) = match mode {
            SessionMode::None => (None, None),
            SessionMode::FreeForm => (Some(starts.lump), None),
            SessionMode::Constrained { figure: number } => {
                let hidden = starts.figures.get(usize::from(number));
                (hidden.map(|hidden| hidden.stone), hidden.map(|hidden| hidden.figure))
            }
            SessionMode::Creative => (Some(starts.creative), None),
            SessionMode::Own => (starts.own, None),
        };
        let Some(volume) = volume else {
            self.events.push(WorldEvent::NoSuchStart);
            return;
        };
        *self = StepModel {
            tick: self.tick,
            head: self.head,
            session: SessionState::Sculpting,
            mode,
            bench: BenchModel::at_start(),
            volume: StepVolume::from_maps(volume),
            events: vec![WorldEvent::Started(mode)],
            ..StepModel::new(N)
        };
        if let Some(figure) = mask {
            self.mask = StepVolume::from_maps(figure);
            self.mask_digest = maps_digest(figure);
        }
    }

    /// Runs undo, redo, mirror, swap of hands and finish. Returns `true` if the volume changed.
    fn apply_commands(&mut self, input: &TickInput, presses: &mut [HandPresses; 2]) -> bool {
        let asked = |command: u8, button: u8| {
            input.commands & command != 0
                || presses.iter().any(|presses| presses.buttons & button != 0)
        };
        let undo = asked(commands::UNDO, buttons::LOWER);
        let redo = asked(commands::REDO, buttons::UPPER);
        if undo || redo || input.commands & commands::FINISH != 0 {
            self.trails.iter_mut().for_each(VecDeque::clear);
        }
        let rewound = undo != redo
            && match undo {
                true => self.history.undo(&mut self.volume),
                false => self.history.redo(&mut self.volume),
            };
        if rewound {
            self.islands.cancel_passes();
            self.islands.request_pass(self.tick);
            self.events.push(if undo { WorldEvent::Undone } else { WorldEvent::Redone });
        }
        if asked(commands::SYMMETRY, buttons::STICK) {
            self.is_mirrored = !self.is_mirrored;
            self.events.push(WorldEvent::Symmetry(self.is_mirrored));
        }
        if input.commands & commands::SWAP_HANDS != 0 && self.swap_hands() {
            presses.iter_mut().for_each(|presses| presses.pulled = false);
        }
        if input.commands & commands::FINISH != 0 {
            self.session = SessionState::Finished;
            self.islands.cancel_passes();
            self.events.push(WorldEvent::Finished);
        }
        rewound
    }

    /// Swaps the tools of the hands, unless a tool would come into an untracked hand. Pulls of the triggers
    /// end. Returns `true` if the tools were swapped.
    fn swap_hands(&mut self) -> bool {
        let tools = [0, 1].map(|hand| self.bench.held(hand).map(|(tool, _)| tool));
        let [left, right] = [0, 1].map(|hand: usize| self.hands[hand].tracked);
        let swaps = match tools {
            [None, None] => false,
            [Some(_), None] => right,
            [None, Some(_)] => left,
            [Some(_), Some(_)] => left && right,
        };
        if swaps {
            self.bench.put_into_hands([tools[1], tools[0]]);
            for hand in 0..2 {
                self.forget_bit(hand);
                let state = &mut self.hands[hand];
                state.awaits_release = state.awaits_release || state.trigger;
                (state.trigger, state.holds_stool) = (false, false);
            }
            self.events.push(WorldEvent::HandsSwapped);
        }
        swaps
    }

    fn apply_pointer(&mut self, pointer: PointerCommand) {
        match pointer {
            PointerCommand::Take { hand, item } => {
                if let Some(item) = BenchItem::from_number(item.into()) {
                    self.take(usize::from(hand % 2), item);
                }
            }
            PointerCommand::Return { hand } => {
                let hand = hand % 2;
                if let Some(tool) = self.bench.return_home(hand.into()) {
                    self.forget_bit(hand.into());
                    self.events.push(WorldEvent::Returned { hand, tool });
                }
            }
            PointerCommand::Steady { string_mm } => self.string_mm = string_mm.min(MAX_STRING_MM),
            PointerCommand::None | PointerCommand::Turn { .. } | PointerCommand::Resize { .. } => {}
        }
    }

    /// Handles a squeeze: takes the item in reach, drops the held tool, or grabs the stool.
    fn grab_or_release_on_squeeze(&mut self, hand: usize, presses: HandPresses) {
        if !presses.squeezed {
            return;
        }
        let grip = self.hands[hand].grip;
        let tip = match self.bench.held(hand) {
            Some((tool, _)) => self.hands[hand].bit_centre_pose(hands::length_metres(tool)).0,
            None => grip.0,
        };
        if let Some(item) = self.bench.item_in_reach(hand, grip.0, tip) {
            self.take(hand, item);
        } else if let Some(tool) = self.bench.drop_tool(hand, grip) {
            self.forget_bit(hand);
            self.events.push(WorldEvent::Released { hand: hand as u8, tool });
        } else if stool::is_at_rim(grip.0) {
            self.hands[hand].holds_stool = true;
        }
    }

    fn take(&mut self, hand: usize, item: BenchItem) {
        let tool_of = |bench: &BenchModel| bench.held(1 - hand).map(|(tool, _)| tool);
        let other = tool_of(&self.bench);
        if self.bench.take(hand, item) {
            self.forget_bit(hand);
            self.hands[hand].holds_stool = false;
            if tool_of(&self.bench) != other {
                self.forget_bit(1 - hand);
            }
            self.events.push(WorldEvent::Took { hand: hand as u8, item });
        }
    }

    /// Returns `true` if a hand runs the tool that it holds, or its bit follows the rest of the last pull's
    /// path.
    fn is_a_tool_running(&self) -> bool {
        let runs = |hand: usize| self.runs_tool(hand) && self.bench.held(hand).is_some();
        self.session == SessionState::Sculpting && (runs(0) || runs(1))
    }

    /// Steps both hands' tools, hand 0 first in even ticks. A stroke lasts from the first tick in which a
    /// tool runs until a tick in which none runs.
    fn step_tools(
        &mut self,
        presses: &[HandPresses; 2],
        ran_a_tool: bool,
        work_done: (bool, bool),
    ) -> Result<(), String> {
        if self.is_a_tool_running() && !ran_a_tool {
            self.history.begin_stroke();
        }
        let hands = [0, 1].into_iter().filter(|hand| self.tool_in_use(*hand).is_some()).count();
        let mut ledger = Ledger::of_tick(self, work_done, hands);
        let first = (self.tick % 2) as usize;
        [first, 1 - first]
            .into_iter()
            .try_for_each(|hand| self.step_tool(hand, presses[hand], &mut ledger))
    }

    /// Runs the islands' part of a tick.
    fn advance_islands(&mut self, seen: &SeenPass, is_told: bool) -> Result<(), String> {
        let end = self.islands.advance(IslandTick {
            tick: self.tick,
            volume: self.volume.voxels(),
            mask: self.mask.voxels(),
            is_held: self.history.counts().redoable > 0,
            is_told,
            seen,
        })?;
        let report = match end {
            None => return Ok(()),
            Some(PassEnd::Unsupported) => IslandReport { unsupported: true, ..Default::default() },
            Some(PassEnd::Removes(islands)) => {
                let before = self.volume.columns().clone();
                let change = self.volume.remove_voxels(&islands);
                self.history.note_removal(&before, &change.columns);
                let kept = change.back.into_iter().collect();
                self.islands.report_removal(change.removed.len(), kept)
            }
        };
        if report != IslandReport::default() {
            self.events.push(WorldEvent::Islands(report));
        }
        Ok(())
    }

    /// Returns the pose in the grid that a hand wants for a tool.
    fn wanted_pose(&self, hand: usize, tool: Tool) -> Pose {
        let (position, rotation) = self.hands[hand].bit_centre_pose(hands::length_metres(tool));
        self.stool_frame().to_grid(position, rotation)
    }
}
