//! A hand's tool in a tick: its bit follows the hand as far as the volume allows, and edits.

use crate::edit::contact::{Contact, FreezeResult, Obstacle, WayBudget};
use crate::edit::grid_bit::GridBit;
use crate::edit::half_space::HalfSpace;
use crate::edit::operation::{Dither, EditReport};
use crate::edit::pose::{Pose, SUBUNITS_PER_VOXEL};
use crate::limits::{
    DITHER_RIM_VOXELS, LIGHT_SMOOTHING_PERIOD, MAX_BITES_PER_TICK, SMOOTHING_PERIOD,
};
use crate::session::events::WorldEvent;
use crate::session::hand::{HandPresses, HandState, haptic_amplitude};
use crate::session::ledger::{BitWork, work_of_contact};
use crate::session::state::SessionState;
use crate::session::step::metres_from_um;
use crate::session::tools::{BitAction, ToolBit, ToolBitSpec};
use crate::session::world::World;
use crate::volume::size::{Grid, Size};

/// The bit that a hand uses in a tick.
pub(super) struct RunningBit<'a> {
    pub(super) bit: ToolBit,
    /// Its table entry at its current size.
    pub(super) spec: &'a ToolBitSpec,
    pub(super) grid_bit: &'a GridBit,
    /// Its brush: the bit enlarged by its reach.
    pub(super) brush: &'a GridBit,
    is_new_pull: bool,
    /// `true` if a file works lightly.
    pub(super) is_light: bool,
    /// The dither seed of this tick.
    dither: Option<DitherSeed>,
    /// `true` if its blow has split off a flake: then it doesn't also chip.
    has_split: bool,
    /// The half-space that a float removes.
    pub(super) above_float: HalfSpace,
}

/// A seed of smoothing's dither, present while a file runs and isn't finishing.
#[derive(Clone, Copy)]
pub(super) struct DitherSeed(u64);

/// The outcome of a movement toward a pose of the trail.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum WayEnd {
    /// The pose was reached.
    Passed,
    /// The bit gets no nearer to the pose, or closure restored most of the bite.
    Stuck,
    /// The next bite may lead nearer.
    GoesOn,
    /// Nothing more can be done in this tick.
    Waits,
}

/// The movement of a bit toward a pose.
struct BitWay {
    /// The result of the movement.
    freeze: FreezeResult,
    /// The pose from which an edit is swept to the end of the movement. It is the end itself if the bit
    /// jumped or wasn't swept yet. `None` while the bit catches up: then nothing is edited.
    sweep_start: Option<Pose>,
}

impl BitWay {
    /// Returns the outcome of the movement from `last` toward `target`. `report` is the report of the edit
    /// along it, if there was an edit.
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

impl RunningBit<'_> {
    /// Returns the dithered region of an edit that ends at a pose: inside the brush at that pose, so that the
    /// next edit, which is swept from there, covers all of it again. Excludes the brush's rim, which leaves
    /// last.
    pub(super) fn dither_at(&self, pose: &Pose) -> Option<Dither> {
        let DitherSeed(seed) = self.dither?;
        let inside = self.brush.shrunk_by(DITHER_RIM_VOXELS * SUBUNITS_PER_VOXEL)?;
        Some(Dither { piece: inside.piece_at(pose), seed })
    }
}

impl<const N: usize, const K: usize> World<N, K>
where
    Grid<N>: Size,
{
    /// Returns `true` if a hand has a tool to step: it holds a tool and is tracked, in a sculpting session.
    pub(crate) fn is_tool_in_use(&self, hand: usize) -> bool {
        let is_sculpting = self.state.session == SessionState::Sculpting;
        is_sculpting && self.state.hands[hand].tracked && self.held_tool(hand).is_some()
    }

    /// Moves the bit of a held tool with its hand, as far as the volume allows, and applies the edits if the
    /// tool is running, all within its `share` of the tick's work. Returns the work spent. Does nothing
    /// without a tool in use.
    pub(crate) fn step_tool(&mut self, hand: usize, presses: HandPresses, share: u32) -> u32 {
        let Some((tool, bit)) = self.held_tool(hand).filter(|_| self.is_tool_in_use(hand)) else {
            return 0;
        };
        let mut state = self.state.hands[hand];
        let frame = self.stool_frame();
        let voxel_um = frame.voxel_metres() * 1e6;
        let spec = bit.spec_at(self.state.bench.size_of(bit));
        let (grid_bit, brush) = (spec.to_grid_bit(voxel_um), spec.to_grid_brush(voxel_um));
        let (position, rotation) = state.bit_centre_pose(metres_from_um(tool.length_um()));
        let wanted = frame.to_grid(position, rotation);
        let string_voxels = f32::from(self.state.string_mm) * 1e-3 / frame.voxel_metres();
        let raw = state.drawn_pose(wanted, presses.pulled, string_voxels);
        // Haptics follow the speed of the hand, not that of the bit.
        let moved_voxels = match state.has_frozen_pose {
            true => (raw.position - state.raw_pose.position).length(),
            false => 0.0,
        };
        let speed_um = (moved_voxels * voxel_um).min(1e6) as u32;
        state.raw_pose = raw;

        let dropped_ticks = state.note_way(raw, presses.pulled, bit.spec());
        let prepared = self.lay_or_strike(hand, (bit, &grid_bit), &mut state, presses, share);
        let share = share.saturating_sub(prepared.work);
        let is_running = state.is_running();
        let seed = DitherSeed(self.state.tick.wrapping_mul(2).wrapping_add(hand as u64));
        let running = RunningBit {
            bit,
            spec: &spec,
            grid_bit: &grid_bit,
            brush: &brush,
            is_new_pull: presses.pulled,
            is_light: state.is_light,
            dither: state.trigger.then_some(seed),
            has_split: prepared.split.is_some(),
            above_float: state.above_float,
        };
        let is_rubbing = bit.spec().action.is_rubbing();
        let (spent, report) = if is_rubbing {
            let has_turn = self.has_files_turn(hand, state.is_light);
            self.follow_with_file(&running, &mut state, has_turn, share)
        } else {
            self.follow_hand(&running, &mut state, share)
        };
        let contact = self.obstacle().contact_at(&grid_bit, &state.frozen_pose);
        // A bit that keeps up with its hand has cut itself free when the tick ends, and touches nothing any
        // more.
        let felt = Contact { overlap: contact.overlap + report.removed + report.added, ..contact };
        state.haptic =
            haptic_amplitude(bit.spec(), &felt, is_running, state.trigger_ticks, speed_um);
        let spent = if is_rubbing { spent } else { spent + work_of_contact(&grid_bit, &contact) };
        let left = share.saturating_sub(spent);
        let (spall_work, spalled) = self.spall_off_figure(&running, &state, &contact, left);
        self.state.hands[hand] = state;
        self.contacts[hand] = contact;
        self.has_contact[hand] = true;
        let report = report.sum_with(spalled).sum_with(prepared.split.unwrap_or_default());
        let report = EditReport { dropped_ticks, ..report };
        if report != EditReport::default() {
            self.push_event(WorldEvent::Edited { hand: hand as u8, bit, report });
        }
        prepared.work + spent + spall_work
    }

    /// Moves the bit along its trail, from one bite to the next, within its `share` of the tick's work: walk,
    /// bite, walk on. Without a trail it walks to its hand, and edits there if it runs. Returns the work
    /// spent and the combined report of the edits.
    fn follow_hand(
        &mut self,
        running: &RunningBit<'_>,
        state: &mut HandState,
        share: u32,
    ) -> (u32, EditReport) {
        let spec = running.bit.spec();
        let work = BitWork::of(running.grid_bit, N, self.state.symmetry);
        let is_running = state.is_running();
        let is_beat = is_running && spec.is_blow_at(state.trigger_ticks) && !running.has_split;
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

    /// Removes the stone around a bit that touches the hidden figure, so that the figure shows, if the work
    /// `left` suffices. Returns the work spent and the report of the edit.
    fn spall_off_figure(
        &mut self,
        running: &RunningBit<'_>,
        state: &HandState,
        contact: &Contact,
        left: u32,
    ) -> (u32, EditReport) {
        let works = state.is_running() && running.bit.spec().is_blow_at(state.trigger_ticks);
        let spalls = contact.on_mask && works && state.can_sweep;
        let voxel_um = self.stool_frame().voxel_metres() * 1e6;
        let spall = running.spec.to_grid_spall(voxel_um).filter(|_| spalls);
        let Some(spall) = spall else { return (0, EditReport::default()) };
        let work = BitWork::of_spall(&spall, self.state.symmetry);
        if work > left {
            return (0, EditReport::default());
        }
        let spalling = RunningBit { grid_bit: &spall, brush: &spall, ..*running };
        let pose = &state.frozen_pose;
        (work, self.edit_along_path(&spalling, pose, pose))
    }

    /// Returns `true` if a file may smooth in this tick: in every other tick, or less often if it works
    /// lightly. It is a tick in which its hand goes second and gets the work that the first hand left.
    const fn has_files_turn(&self, hand: usize, is_light: bool) -> bool {
        let period = if is_light { LIGHT_SMOOTHING_PERIOD } else { SMOOTHING_PERIOD };
        self.state.tick % period == 1 - hand as u64
    }

    /// Moves a file to its hand, and smooths if it is its turn. A released file finishes at its last
    /// position. Stays within its `share` of the tick's work. Returns the work spent and the report of the
    /// edit.
    fn follow_with_file(
        &mut self,
        running: &RunningBit<'_>,
        state: &mut HandState,
        has_turn: bool,
        share: u32,
    ) -> (u32, EditReport) {
        let work = BitWork::of_file(running.grid_bit, running.brush, N, self.state.symmetry);
        let rest = state.trail.poses().first().filter(|_| !state.trigger);
        let target = rest.copied().unwrap_or(state.raw_pose);
        let last = if state.has_frozen_pose { state.frozen_pose } else { target };
        let edits = state.is_running() && has_turn;
        let budget = match edits {
            true => work.way_budget_beside_edit(share),
            false => work.way_budget(share, false),
        };
        let way = self.find_bit_way(state, running, (&last, &target), true, budget);
        (state.frozen_pose, state.has_frozen_pose) = (way.freeze.pose, true);
        state.can_sweep = way.sweep_start.is_some();
        let mut left = share.saturating_sub(work.of_steps(way.freeze.steps) + work.of_contact());
        if !edits || !work.fits_bite(share) || way.sweep_start.is_none() {
            return (share - left, EditReport::default());
        }
        // Sweeps from the last edit, unless that would exceed the tick's work.
        let end = way.freeze.pose;
        let edit_work_from = |start: &Pose| work.of_edit(running.brush.path_steps(start, &end));
        let start = state.trail.poses().first().copied();
        let start = start.filter(|start| edit_work_from(start) <= left).unwrap_or(end);
        if state.trigger {
            state.note_smoothed_pose();
        } else {
            state.trail.pop_oldest();
        }
        left = left.saturating_sub(edit_work_from(&start));
        (share - left, self.edit_along_path(running, &start, &end))
    }

    /// Returns the obstacle that bits collide with.
    pub(super) fn obstacle(&self) -> Obstacle<'_, N, K> {
        let mask = self.state.masked.then_some(&self.mask);
        Obstacle { rows: self.volume.rows(), mask, is_mask_alone: false }
    }

    /// Moves a bit from its last pose toward a target, both in the grid.
    ///
    /// The volume doesn't stop a running nozzle or file, which would otherwise stick in its own paste, or
    /// between two ridges that it should even out; the mask does. A bit that was buried when it began to run
    /// jumps to its hand, so that no paste is applied on the way there.
    fn find_bit_way(
        &self,
        state: &HandState,
        running: &RunningBit<'_>,
        (last, target): (&Pose, &Pose),
        slides: bool,
        budget: WayBudget,
    ) -> BitWay {
        let grid_bit = running.grid_bit;
        let goes_through_stone = match running.bit.spec().action {
            BitAction::Carve => false,
            BitAction::Fill => state.is_running(),
            BitAction::Smooth | BitAction::Flatten => state.trigger,
        };
        let mut can_sweep = state.can_sweep;
        let obstacle = self.obstacle();
        let holding = Obstacle { is_mask_alone: goes_through_stone, ..obstacle };
        let begins = goes_through_stone && (running.is_new_pull || !can_sweep);
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
}
