//! A hand's tool in a tick: its bit follows the hand as far as the volume lets it, and edits.

use crate::edit::contact::{FreezeResult, Obstacle, WayBudget};
use crate::edit::grid_bit::GridBit;
use crate::edit::operation::{Edit, EditOperation, EditReport, apply_edit};
use crate::edit::pose::Pose;
use crate::limits::MAX_BITES_PER_TICK;
use crate::session::events::WorldEvent;
use crate::session::hand::{HandPresses, HandState, haptic_amplitude};
use crate::session::journals::StrokeJournal;
use crate::session::ledger::BitWork;
use crate::session::state::SessionState;
use crate::session::step::metres_from_um;
use crate::session::tools::{BitAction, ToolBit};
use crate::session::world::World;
use crate::volume::size::{Grid, Size};

/// The bit that a hand uses in a tick.
struct RunningBit<'a> {
    bit: ToolBit,
    grid_bit: &'a GridBit,
    is_new_pull: bool,
}

/// What became of a way toward a pose of the trail.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum WayEnd {
    /// The pose was reached.
    Passed,
    /// The bit gets no nearer to it, or closure brought back most of the bite.
    Stuck,
    /// The next bite may lead nearer.
    GoesOn,
    /// Nothing more can be done in this tick.
    Waits,
}

/// The way of a bit toward a pose.
struct BitWay {
    /// Where it led.
    freeze: FreezeResult,
    /// The pose from which an edit is swept to the end of the way, which is the end itself where the bit
    /// jumped or wasn't swept yet. `None` while the bit catches up: nothing is edited.
    sweep_start: Option<Pose>,
}

impl BitWay {
    /// What became of the way from `last` toward `target`, with the report of the edit along it, if one was
    /// made.
    fn end(&self, bit: &GridBit, last: &Pose, target: &Pose, report: Option<EditReport>) -> WayEnd {
        match (self.freeze.ran_out, self.freeze.blocked, report) {
            (true, ..) | (_, true, None) => WayEnd::Waits,
            (_, false, _) => WayEnd::Passed,
            (_, true, Some(report)) if report.is_mostly_refused_by_closure() => WayEnd::Stuck,
            (_, true, Some(report)) => {
                let is_nearer =
                    bit.path_steps(&self.freeze.pose, target) < bit.path_steps(last, target);
                if is_nearer || report.removed > 0 { WayEnd::GoesOn } else { WayEnd::Stuck }
            }
        }
    }
}

impl<const N: usize, const K: usize> World<N, K>
where
    Grid<N>: Size,
{
    /// Whether a hand has a tool to step: it holds one and is tracked, in a sculpting session.
    pub(crate) fn is_tool_in_use(&self, hand: usize) -> bool {
        let is_sculpting = self.state.session == SessionState::Sculpting;
        is_sculpting && self.state.hands[hand].tracked && self.held_tool(hand).is_some()
    }

    /// Moves the bit of a held tool with its hand, as far as the volume lets it, and applies the edits if
    /// the tool is running, all within its `share` of the tick's work. Returns what it spent. Nothing
    /// happens without a tool in use.
    pub(crate) fn step_tool(&mut self, hand: usize, presses: HandPresses, share: u32) -> u32 {
        let Some((tool, bit)) = self.held_tool(hand).filter(|_| self.is_tool_in_use(hand)) else {
            return 0;
        };
        let mut state = self.state.hands[hand];
        let frame = self.stool_frame();
        let grid_bit = bit.to_grid_bit(frame.voxel_metres() * 1e6);
        let (position, rotation) = state.bit_centre_pose(metres_from_um(tool.length_um()));
        let raw = frame.to_grid(position, rotation);
        // Haptics follow the speed of the hand, not that of the bit.
        let moved_voxels = match state.has_frozen_pose {
            true => (raw.position - state.raw_pose.position).length(),
            false => 0.0,
        };
        let speed_um = (moved_voxels * frame.voxel_metres() * 1e6).min(1e6) as u32;
        state.raw_pose = raw;

        let dropped_ticks = state.note_way(raw, presses.pulled, bit.spec());
        let is_running = state.is_running();
        let running = RunningBit { bit, grid_bit: &grid_bit, is_new_pull: presses.pulled };
        let (spent, report) = self.follow_hand(&running, &mut state, share);
        let contact = self.obstacle().contact_at(&grid_bit, &state.frozen_pose);
        state.haptic =
            haptic_amplitude(bit.spec(), &contact, is_running, state.trigger_ticks, speed_um);
        self.state.hands[hand] = state;
        self.contacts[hand] = contact;
        self.has_contact[hand] = true;
        let report = EditReport { dropped_ticks, ..report };
        if report != EditReport::default() {
            self.push_event(WorldEvent::Edited { hand: hand as u8, bit, report });
        }
        spent
    }

    /// Takes the bit along its trail, from one bite to the next, within its `share` of the tick's work: walk,
    /// bite, walk on. Without a trail it walks to its hand, and edits there if it runs. Returns the work spent
    /// and what the edits did together.
    fn follow_hand(
        &mut self,
        running: &RunningBit<'_>,
        state: &mut HandState,
        share: u32,
    ) -> (u32, EditReport) {
        let spec = running.bit.spec();
        let work = BitWork::of(running.grid_bit, N, self.state.symmetry);
        let is_running = state.is_running();
        let is_beat = is_running && spec.is_blow_at(state.trigger_ticks);
        let (mut left, mut total) = (share, EditReport::default());
        let mut is_stuck = false;
        for bite in 0..MAX_BITES_PER_TICK {
            if bite > 0 && !work.fits_bite(left) {
                break;
            }
            let target = state.trail.poses().first().copied().unwrap_or(state.raw_pose);
            let last = if state.has_frozen_pose { state.frozen_pose } else { target };
            let budget = work.way_budget(left, is_running);
            let slides = is_stuck || state.trail.is_empty();
            let way = self.find_bit_way(state, running, (&last, &target), slides, budget);
            (state.frozen_pose, state.has_frozen_pose) = (way.freeze.pose, true);
            state.can_sweep = way.sweep_start.is_some();
            let start = way.sweep_start.filter(|_| is_beat && work.fits_bite(left));
            left = left.saturating_sub(work.of_steps(way.freeze.steps));
            let report = start.map(|start| {
                let steps = running.grid_bit.path_steps(&start, &way.freeze.pose);
                left = left.saturating_sub(work.of_edit(steps));
                self.edit_along_path(running, &start, &way.freeze.pose)
            });
            total = total.sum_with(report.unwrap_or_default());
            let end = way.end(running.grid_bit, &last, &target, report);
            if end == WayEnd::Waits {
                break;
            }
            // One slide a pose: more would press the bit into a dimple of the figure, where it stands.
            let is_left_behind = end == WayEnd::Passed || slides;
            if is_left_behind {
                state.trail.pop_oldest();
            }
            // What closure refused there it would mostly refuse at the next pose of this tick.
            let is_refused = report.is_some_and(|report| report.is_mostly_refused_by_closure());
            if state.trail.is_empty() || is_left_behind && is_refused {
                break;
            }
            is_stuck = end == WayEnd::Stuck && !slides;
        }
        (share - left, total)
    }

    /// What bits collide with.
    fn obstacle(&self) -> Obstacle<'_, N, K> {
        let mask = self.state.masked.then_some(&self.mask);
        Obstacle { rows: self.volume.rows(), mask, is_mask_alone: false }
    }

    /// The way of a bit from its last pose toward a target, both in the grid.
    ///
    /// The volume doesn't hold a nozzle that runs, which would stick in its own paste; the mask does. One
    /// that was buried as it began to run jumps to its hand, so that no paste is laid on the way there.
    fn find_bit_way(
        &self,
        state: &HandState,
        running: &RunningBit<'_>,
        (last, target): (&Pose, &Pose),
        slides: bool,
        budget: WayBudget,
    ) -> BitWay {
        let grid_bit = running.grid_bit;
        let is_laying = state.trigger && running.bit.spec().action == BitAction::Fill;
        let mut can_sweep = state.can_sweep;
        let obstacle = self.obstacle();
        let holding = Obstacle { is_mask_alone: is_laying, ..obstacle };
        let begins = is_laying && (running.is_new_pull || !can_sweep);
        let freeze = if begins && obstacle.buries(grid_bit, last) {
            can_sweep = false;
            let jump = holding.jump_if_bite_allows(grid_bit, last, target, budget);
            FreezeResult { ran_out: !jump.jumped, ..jump }
        } else if slides {
            holding.freeze_bit(grid_bit, last, target, budget)
        } else {
            holding.freeze_bit_straight(grid_bit, last, target, budget)
        };
        let is_swept = can_sweep && !freeze.jumped;
        let sweep_start = match (is_swept, can_sweep || !freeze.ran_out) {
            (true, _) => Some(*last),
            (false, has_caught_up) => has_caught_up.then_some(freeze.pose),
        };
        BitWay { freeze, sweep_start }
    }

    /// Applies a bit's edit along its path between two poses in the grid.
    fn edit_along_path(&mut self, running: &RunningBit<'_>, from: &Pose, to: &Pose) -> EditReport {
        let grid_bit = running.grid_bit;
        let depth = grid_bit.bite_depth_voxels();
        let operation = match running.bit.spec().action {
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
        let report = apply_brush(grid_bit.swept_brush(from, to))
            .or_else(|_| apply_brush(grid_bit.piece_at(to).into()))
            .unwrap_or_default();
        self.dirty.end_edit();
        if report.changed_volume() {
            self.islands.request_pass();
        }
        report
    }
}
