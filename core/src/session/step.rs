//! The parts of a tick, in the order in which [`World::step`] calls them.

use crate::edit::contact::{FreezeResult, Obstacle};
use crate::edit::islands::IslandSearch;
use crate::edit::operation::{Edit, EditOperation, EditReport, apply_edit};
use crate::edit::pose::Pose;
use crate::edit::undo::UndoHistory;
use crate::limits::island_row_visits_per_tick;
use crate::session::events::WorldEvent;
use crate::session::hand::{HandPresses, haptic_amplitude};
use crate::session::input::{PointerCommand, SessionMode, TICK_RATE, TickInput, buttons, commands};
use crate::session::start_volumes::StartVolumes;
use crate::session::state::{SessionState, WorldState};
use crate::session::tools::{BitAction, ToolBit};
use crate::session::workbench::BenchItem;
use crate::session::world::World;
use crate::volume::column_digest::copy_and_digest_maps;
use crate::volume::dirty::DirtyRects;
use crate::volume::editable::Volume;
use crate::volume::journal::Journal;
use crate::volume::range_maps::{Axis, Column, RowAddress};
use crate::volume::size::{Grid, Size};

/// What the commands of a tick did.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct CommandEffects {
    /// Whether undo or redo changed the volume.
    pub(crate) volume_rewound: bool,
}

/// The work done for one hand in a tick.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub(crate) struct StepCost {
    /// Steps that the bit moved, as counted by the path traversal.
    pub(crate) bit_steps: u32,
    /// Convex pieces of the brush that was applied.
    pub(crate) brush_pieces: u32,
}

impl StepCost {
    /// The cost in steps; a brush piece counts as one step.
    pub(crate) const fn total_steps(self) -> u32 {
        self.bit_steps + self.brush_pieces
    }
}

impl<const N: usize, const K: usize> World<N, K>
where
    Grid<N>: Size,
{
    /// Starts a session in this mode and resets all but tick and head. Without a start volume for the
    /// mode, only [`WorldEvent::NoSuchStart`] is reported.
    pub(crate) fn start_session(&mut self, mode: SessionMode, starts: &StartVolumes<'_, N, K>) {
        let volume = match mode {
            SessionMode::None => None,
            SessionMode::FreeForm => Some(starts.lump),
            SessionMode::Constrained { figure } => {
                starts.figures.get(usize::from(figure)).map(|_| starts.lump)
            }
            SessionMode::Creative => Some(starts.creative),
            SessionMode::Own => starts.own,
        };
        let Some(volume) = volume else {
            self.push_event(WorldEvent::NoSuchStart);
            return;
        };
        self.volume.set_maps(volume);
        let (tick, head) = (self.state.tick, self.state.head);
        self.state =
            WorldState { tick, head, mode, session: SessionState::Sculpting, ..WorldState::new() };
        if let SessionMode::Constrained { figure } = mode {
            let hidden = starts.figures[usize::from(figure)];
            self.state.mask_digest = copy_and_digest_maps(hidden, &mut self.mask);
            self.state.masked = !self.mask.is_empty();
        } else {
            self.mask.clear();
        }
        self.state.bench.reset_items();
        self.undo.clear();
        self.islands.reset();
        self.dirty.mark_all(N);
        self.push_event(WorldEvent::Started(mode));
    }

    /// Turns the stool: by the sticks, up to a quarter turn a second each, and by the pointer.
    pub(crate) fn turn_stool(&mut self, input: &TickInput) {
        let mut turn = 0i32;
        for (hand, state) in input.hands.iter().zip(&self.state.hands) {
            let push = i32::from(hand.stick[0]);
            if state.tracked && push.abs() > 30 {
                turn += push * (65_536 / 4) / (127 * TICK_RATE as i32);
            }
        }
        if let PointerCommand::Turn { by } = input.pointer {
            turn += i32::from(by);
        }
        self.state.stool = self.state.stool.wrapping_add(turn as u16);
    }

    /// Runs the commands of shells and buttons: undo, redo, symmetry and finish. Undo together with
    /// redo does neither.
    pub(crate) fn apply_commands(
        &mut self,
        input: &TickInput,
        presses: [HandPresses; 2],
    ) -> CommandEffects {
        let pressed = presses[0].buttons | presses[1].buttons;
        let asked =
            |command: u8, button: u8| input.commands & command != 0 || pressed & button != 0;
        let undo = asked(commands::UNDO, buttons::LOWER);
        let redo = asked(commands::REDO, buttons::UPPER);
        let rewound = match (undo, redo) {
            (true, false) => self.try_undo_or_redo(WorldEvent::Undone, UndoHistory::try_undo),
            (false, true) => self.try_undo_or_redo(WorldEvent::Redone, UndoHistory::try_redo),
            _ => false,
        };
        if asked(commands::SYMMETRY, buttons::STICK) {
            self.state.symmetry = !self.state.symmetry;
            self.push_event(WorldEvent::Symmetry(self.state.symmetry));
        }
        if input.commands & commands::FINISH != 0 {
            self.state.session = SessionState::Finished;
            self.islands.cancel_passes();
            self.push_event(WorldEvent::Finished);
        }
        CommandEffects { volume_rewound: rewound }
    }

    /// Undoes or redoes one stroke, which ends a running island pass without a new one. Returns whether
    /// there was such a stroke.
    fn try_undo_or_redo(
        &mut self,
        event: WorldEvent,
        undo_or_redo: fn(&mut UndoHistory<N, K>, &mut Volume<N, K>, &mut DirtyRects) -> bool,
    ) -> bool {
        let rewound = undo_or_redo(&mut self.undo, &mut self.volume, &mut self.dirty);
        if rewound {
            self.islands.cancel_passes();
            self.push_event(event);
        }
        rewound
    }

    /// Takes or returns an item for a pointer. [`World::turn_stool`] handles its turns.
    pub(crate) fn apply_pointer_command(&mut self, pointer: PointerCommand) {
        match pointer {
            PointerCommand::Take { hand, item } => {
                if let Some(item) = BenchItem::from_number(item.into()) {
                    self.take_item(usize::from(hand & 1), item);
                }
            }
            PointerCommand::Return { hand } => {
                let hand = usize::from(hand & 1);
                if let Some(tool) = self.state.bench.return_tool_home(hand) {
                    self.state.hands[hand].invalidate_bit_pose();
                    self.push_event(WorldEvent::Returned { hand: hand as u8, tool });
                }
            }
            PointerCommand::None | PointerCommand::Turn { .. } => {}
        }
    }

    /// On the edge of a squeeze: takes the nearest item in reach, else releases the held tool.
    pub(crate) fn grab_or_release(&mut self, hand: usize, presses: HandPresses) {
        if !presses.squeezed {
            return;
        }
        let state = self.state.hands[hand];
        let tip = self
            .state
            .bench
            .held_tool(hand)
            .map(|tool| state.bit_centre_pose(metres_from_um(tool.length_um())).0);
        let tip = tip.unwrap_or(state.grip.0);
        if let Some(item) = self.state.bench.nearest_in_reach(hand, state.grip.0, tip) {
            self.take_item(hand, item);
        } else if let Some(tool) = self.state.bench.let_tool_fall_or_return_home(hand, state.grip) {
            self.state.hands[hand].invalidate_bit_pose();
            self.push_event(WorldEvent::Released { hand: hand as u8, tool });
        }
    }

    fn take_item(&mut self, hand: usize, item: BenchItem) {
        let other = self.state.bench.held_tool(1 - hand);
        if self.state.bench.try_take_item(hand, item) {
            self.state.hands[hand].invalidate_bit_pose();
            if self.state.bench.held_tool(1 - hand) != other {
                self.state.hands[1 - hand].invalidate_bit_pose();
            }
            self.push_event(WorldEvent::Took { hand: hand as u8, item });
        }
    }

    /// Moves the bit of a held tool with its hand, as far as the volume lets it, and applies the edit if
    /// the tool is running. `max_bit_steps` limits the path traversal. Nothing happens without a tool,
    /// without tracking, or outside a sculpting session.
    pub(crate) fn step_tool(
        &mut self,
        hand: usize,
        presses: HandPresses,
        max_bit_steps: u32,
    ) -> StepCost {
        let Some((tool, bit)) = self.held_tool(hand) else {
            return StepCost::default();
        };
        let mut state = self.state.hands[hand];
        if !state.tracked || self.state.session != SessionState::Sculpting {
            return StepCost::default();
        }

        // The wanted pose, and the allowed pose that contact gives for it.
        let frame = self.stool_frame();
        let grid_bit = bit.to_grid_bit(frame.voxel_metres() * 1e6);
        let (position, rotation) = state.bit_centre_pose(metres_from_um(tool.length_um()));
        let raw = frame.to_grid(position, rotation);
        let last = if state.has_frozen_pose { state.frozen_pose } else { raw };
        let mask = self.state.masked.then_some(&self.mask);
        let obstacle = Obstacle { rows: self.volume.rows(), mask };
        let FreezeResult { pose: frozen, steps: bit_steps, .. } =
            obstacle.freeze_bit(&grid_bit, &last, &raw, max_bit_steps);
        let contact = obstacle.contact_at(&grid_bit, &frozen);

        // Haptics follow the speed of the hand, not that of the bit.
        let moved_voxels = match state.has_frozen_pose {
            true => (raw.position - state.raw_pose.position).length(),
            false => 0.0,
        };
        let speed_um = (moved_voxels * frame.voxel_metres() * 1e6).min(1e6) as u32;
        let (running, ticks) = (state.trigger, state.trigger_ticks);
        state.haptic = haptic_amplitude(bit.spec(), &contact, running, ticks, speed_um);

        let sweep_start = if state.can_sweep { last } else { frozen };
        let is_new_bit = !state.has_frozen_pose;
        (state.raw_pose, state.frozen_pose) = (raw, frozen);
        (state.can_sweep, state.has_frozen_pose) = (true, true);
        self.state.hands[hand] = state;
        self.contacts[hand] = contact;
        self.has_contact[hand] = true;

        if presses.pulled || running && is_new_bit {
            self.undo.begin_stroke();
        }
        let mut brush_pieces = 0;
        if running && ticks.is_multiple_of(u16::from(bit.spec().bite_period)) {
            brush_pieces = self.edit_along_path_counting_pieces(hand, bit, &sweep_start, &frozen);
        }
        StepCost { bit_steps, brush_pieces }
    }

    /// Applies a bit's edit along its path between two poses in the grid. Returns the number of convex
    /// pieces in the brush.
    fn edit_along_path_counting_pieces(
        &mut self,
        hand: usize,
        bit: ToolBit,
        from: &Pose,
        to: &Pose,
    ) -> u32 {
        let grid_bit = bit.to_grid_bit(self.stool_frame().voxel_metres() * 1e6);
        let depth = grid_bit.bite_depth_voxels();
        let operation = match bit.spec().action {
            BitAction::Carve => EditOperation::Carve { depth },
            BitAction::Fill => EditOperation::Fill { depth },
            BitAction::Smooth => EditOperation::Smooth,
        };
        let mirrored = self.state.symmetry;
        let mut journal = StrokeJournal {
            undo: &mut self.undo,
            dirty: &mut self.dirty,
            islands: &mut self.islands,
        };
        let mut apply_brush = |brush| {
            let edit = Edit { brush: &brush, operation, mirrored };
            apply_edit(&mut self.volume, &self.mask, &edit, &mut self.scratch, &mut journal)
        };
        // A smoothing brush too large for the scratch memory is replaced by the bit at its last pose.
        let brush = grid_bit.swept_brush(from, to);
        let pieces = brush.pieces().len() as u32;
        let report = apply_brush(brush)
            .or_else(|_| apply_brush(grid_bit.piece_at(to).into()))
            .unwrap_or_default();
        self.dirty.end_edit();
        if report.changed_volume() {
            self.islands.request_pass();
        }
        if report != EditReport::default() {
            self.push_event(WorldEvent::Edited { hand: hand as u8, bit, report });
        }
        pieces
    }

    /// Spends one tick's budget on the island search and reports a pass that removed or kept voxels.
    pub(crate) fn advance_island_search(&mut self) {
        let mut journal = RemovalJournal { undo: &mut self.undo, dirty: &mut self.dirty };
        let report = self.islands.advance_pass(
            &mut self.volume,
            &self.mask,
            island_row_visits_per_tick(N),
            &mut journal,
        );
        self.dirty.end_edit();
        if let Some(report) = report
            && (report.removed != 0 || report.kept != 0 || report.unsupported)
        {
            self.push_event(WorldEvent::Islands(report));
        }
    }

    /// Reports an event. It is dropped when the list is full: events only inform, the state is complete
    /// without them.
    fn push_event(&mut self, event: WorldEvent) {
        let _ = self.events.push(event);
    }
}

/// Journal of an island removal: notes its columns for undo and for the renderer.
#[derive(Debug)]
pub struct RemovalJournal<'a, const N: usize, const K: usize = 1>
where
    Grid<N>: Size,
{
    /// The history; the removal joins its newest entry.
    pub undo: &'a mut UndoHistory<N, K>,
    /// The rectangles that cover the changed columns.
    pub dirty: &'a mut DirtyRects,
}

/// Journal of a stroke's edit: notes its columns for undo and for the renderer, and the added voxels
/// for a running island pass.
#[derive(Debug)]
pub struct StrokeJournal<'a, const N: usize, const K: usize = 1>
where
    Grid<N>: Size,
{
    /// The history that records the stroke.
    pub undo: &'a mut UndoHistory<N, K>,
    /// The rectangles that cover the changed columns.
    pub dirty: &'a mut DirtyRects,
    /// The search that counts added voxels as supported.
    pub islands: &'a mut IslandSearch<N>,
}

impl<const N: usize, const K: usize> Journal<N, K> for RemovalJournal<'_, N, K>
where
    Grid<N>: Size,
{
    fn record_columns(
        &mut self,
        axis: Axis,
        line: usize,
        places: <Grid<N> as Size>::Row,
        old_columns: &[Column<K>; N],
    ) {
        self.undo.record_into_newest_entry(axis, line, places, old_columns);
        self.dirty.mark_columns(axis, line, places);
    }

    fn record_added(&mut self, _: RowAddress, _: <Grid<N> as Size>::Row) {}
}

impl<const N: usize, const K: usize> Journal<N, K> for StrokeJournal<'_, N, K>
where
    Grid<N>: Size,
{
    fn record_columns(
        &mut self,
        axis: Axis,
        line: usize,
        places: <Grid<N> as Size>::Row,
        old_columns: &[Column<K>; N],
    ) {
        self.undo.record_columns(axis, line, places, old_columns);
        self.dirty.mark_columns(axis, line, places);
    }

    fn record_added(&mut self, row: RowAddress, voxels: <Grid<N> as Size>::Row) {
        self.islands.mark_added_as_reached(row, voxels);
    }
}

fn metres_from_um(micrometres: i32) -> f32 {
    micrometres as f32 * 1e-6
}
