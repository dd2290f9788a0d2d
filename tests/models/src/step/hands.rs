//! Model of a hand: its actions in a tick with the tool that it holds.

use paros_core::edit::{ANY_DEPTH, Contact, EditOperation, EditReport, Pose};
use paros_core::internals::{BURIED_WITHIN, BitAction, FreezeResult, GridBit, WayBudget};
use paros_core::limits::{MAX_BITES_PER_TICK, SMOOTH_LINES, max_trail_ticks};
use paros_core::session::{HandState, SessionState, Tool, ToolBit};
use paros_core::{Brush, WorldEvent};

use crate::contact::ContactModel;
use crate::dense::DenseVolume;
use crate::path::path_poses;
use crate::step::hand_input::HandPresses;
use crate::step::ledger::{HandWork, Ledger, work_of_contact};
use crate::step::volume::{voxels_of_brush, whole_voxels};
use crate::step::{StepModel, ensure};

/// Returns the distance from grip to bit, in metres.
pub(super) fn length_metres(tool: Tool) -> f32 {
    tool.length_um() as f32 * 1e-6
}

/// The ends of a path to find, and the bit that moves along it.
pub(super) struct WayToFind<'a> {
    pub grid_bit: &'a GridBit,
    pub from: &'a Pose,
    pub wanted: &'a Pose,
    /// `true` if the bit slides when it is stopped.
    pub slides: bool,
    /// `true` if only the mask stops the bit.
    pub goes_through_stone: bool,
}

/// The path of a bit toward a pose.
pub(super) struct BitWay {
    /// The obstacle that stopped the bit.
    obstacle: ContactModel,
    pub freeze: FreezeResult,
    /// The start of an edit's sweep; `None` if the edit is made only at the path's end.
    swept_from: Option<Pose>,
    /// `true` if the bit may edit: it was swept in the tick before, or has caught up with its hand.
    pub may_edit: bool,
}

impl<const K: usize> StepModel<K> {
    /// Forgets the bit's pose after a change of tool or bit.
    pub(super) fn forget_bit(&mut self, hand: usize) {
        let state = &mut self.hands[hand];
        (state.can_sweep, state.has_frozen_pose, state.trigger_ticks) = (false, false, 0);
        self.trails[hand].clear();
    }

    /// Returns `true` if a hand's tool runs: its trigger is pulled, or a part of the last pull's path is
    /// left.
    pub(super) fn runs_tool(&self, hand: usize) -> bool {
        self.hands[hand].trigger || !self.trails[hand].is_empty()
    }

    /// Returns the tool and bit that a hand uses.
    pub(super) fn tool_in_use(&self, hand: usize) -> Option<(Tool, ToolBit)> {
        let is_idle = !self.hands[hand].tracked || self.session != SessionState::Sculpting;
        self.bench.held(hand).filter(|_| !is_idle)
    }

    /// Moves a hand's bit as far as volume and mask allow, and edits if its tool runs.
    ///
    /// # Errors
    /// The path leads where it may not.
    pub(super) fn step_tool(
        &mut self,
        hand: usize,
        presses: HandPresses,
        ledger: &mut Ledger,
    ) -> Result<(), String> {
        let Some((tool, bit)) = self.tool_in_use(hand) else { return Ok(()) };
        let voxel_metres = self.stool_frame().voxel_metres();
        let grid_bit = self.spec_of(bit).to_grid_bit(voxel_metres * 1e6);
        let in_hand = self.wanted_pose(hand, tool);
        let wanted = self.pull_string(hand, in_hand, presses.pulled);
        let state = &mut self.hands[hand];
        let voxels_moved = match state.has_frozen_pose {
            true => (wanted.position - state.raw_pose.position).length(),
            false => 0.0,
        };
        let speed_um = (voxels_moved * (voxel_metres * 1e6)).min(1e6) as u32;
        state.raw_pose = wanted;
        let dropped_ticks = self.note_way(hand, bit, presses.pulled);
        let runs = self.runs_tool(hand);
        let is_rubbed = matches!(bit.spec().action, BitAction::Smooth | BitAction::Flatten);
        let file = is_rubbed.then(|| self.brush_of(bit));
        let mut share = ledger.work_of_next_hand(&grid_bit, file.as_ref());
        if bit.spec().action == BitAction::Flatten && presses.pulled {
            let work = self.lay_float(hand, &grid_bit);
            share.charge_other(work);
            ledger.charge_work(work);
        }
        let split = self.strike(hand, (bit, &grid_bit), &share);
        let (split, work) = split.map_or((None, 0), |(report, work)| (Some(report), work));
        share.charge_other(work);
        ledger.charge_work(work);
        let (after, report) = match bit.spec().action {
            BitAction::Smooth | BitAction::Flatten => {
                self.rub(hand, presses, (bit, &grid_bit), share)?
            }
            _ => self.follow_way(hand, presses, (bit, &grid_bit), split.is_some(), share)?,
        };
        ledger.charge(&share, &after);
        let contact = self.stone().contact_at(&grid_bit, &self.hands[hand].frozen_pose);
        let contact_work = if file.is_none() { work_of_contact(&grid_bit, &contact) } else { 0 };
        ledger.charge_work(contact_work);
        // Voxels cut or laid are felt like voxels touched.
        let felt = Contact { overlap: contact.overlap + report.removed + report.added, ..contact };
        self.hands[hand].haptic = pulse(bit, &felt, &self.hands[hand], runs, speed_um);
        self.contacts[hand] = Some(contact);
        let spalled = match contact.on_mask {
            true => self.spall(hand, bit, after.left_beside(contact_work), ledger),
            false => EditReport::default(),
        };
        let report = report.sum_with(spalled).sum_with(split.unwrap_or_default());
        let report = EditReport { dropped_ticks, ..report };
        if report != EditReport::default() {
            self.events.push(WorldEvent::Edited { hand: hand as u8, bit, report });
        }
        Ok(())
    }

    /// Appends the pose that a hand wants to the path that its bit is to cut. Returns the number of dropped
    /// poses, which were too old.
    fn note_way(&mut self, hand: usize, bit: ToolBit, is_new_pull: bool) -> u32 {
        let (state, trail) = (&self.hands[hand], &mut self.trails[hand]);
        if is_new_pull || !state.can_sweep {
            trail.clear();
        }
        if !state.trigger || matches!(bit.spec().action, BitAction::Smooth | BitAction::Flatten) {
            return 0;
        }
        trail.push_back(state.raw_pose);
        let too_many = trail.len().saturating_sub(max_trail_ticks(bit.spec().bite_period));
        trail.drain(..too_many);
        too_many as u32
    }

    /// Walks to the oldest pose of the path and bites. Repeats this until no path or no work is left, or the
    /// tool has no blow. The walk is straight; if neither the walk nor the bite leads nearer to a pose, the
    /// pose is dropped after a slide toward it.
    fn follow_way(
        &mut self,
        hand: usize,
        presses: HandPresses,
        (bit, grid_bit): (ToolBit, &GridBit),
        has_split: bool,
        mut work: HandWork,
    ) -> Result<(HandWork, EditReport), String> {
        let runs = self.runs_tool(hand);
        let depth = whole_voxels(grid_bit.bite);
        let operation = match bit.spec().action {
            BitAction::Carve => EditOperation::Carve { depth },
            BitAction::Fill => EditOperation::Fill { depth: ANY_DEPTH },
            BitAction::Smooth | BitAction::Flatten => return Err("a file follows no way".into()),
        };
        let is_beat = is_blow_at(bit, self.hands[hand].trigger_ticks) && !has_split;
        let (mut total, mut is_stuck) = (EditReport::default(), false);
        for bites in 0..MAX_BITES_PER_TICK {
            let share = work.share(runs);
            if bites > 0 && !share.may_edit {
                break;
            }
            let state = self.hands[hand];
            let wanted = self.trails[hand].front().copied().unwrap_or(state.raw_pose);
            let from = if state.has_frozen_pose { state.frozen_pose } else { wanted };
            let slides = is_stuck || self.trails[hand].is_empty();
            // A released nozzle also lays paste on the rest of its path.
            let goes_through_stone = bit.spec().action == BitAction::Fill && self.runs_tool(hand);
            let way_of =
                WayToFind { grid_bit, from: &from, wanted: &wanted, slides, goes_through_stone };
            let way = self.find_way(&state, presses, &way_of, share.way);
            self.check_way(hand, &way, grid_bit, goes_through_stone)?;
            let frozen = way.freeze.pose;
            let state = &mut self.hands[hand];
            (state.frozen_pose, state.has_frozen_pose) = (frozen, true);
            state.can_sweep = way.may_edit;
            work.charge_steps(way.freeze.steps);
            let edits = runs && is_beat && way.may_edit && share.may_edit;
            let mut report = EditReport::default();
            if edits {
                let start = way.swept_from.unwrap_or(frozen);
                work.charge_edit(grid_bit, &start, &frozen);
                let swept = grid_bit.swept_brush(&start, &frozen);
                report = match bit.spec().action {
                    BitAction::Fill => self.lay_paste(&swept),
                    _ => self.edit(operation, &swept, &grid_bit.piece_at(&frozen).into()),
                };
                total = total.sum_with(report);
            }
            let steps_to_go = |pose: &Pose| path_poses(grid_bit, pose, &wanted).count();
            let is_refused = report.refused_by_closure > report.removed;
            let is_nearer = steps_to_go(&frozen) < steps_to_go(&from);
            let helped = !is_refused && (report.removed > 0 || is_nearer);
            if way.freeze.ran_out || (way.freeze.blocked && !edits) {
                break;
            }
            let leaves = !way.freeze.blocked || slides;
            if leaves {
                self.trails[hand].pop_front();
            }
            is_stuck = way.freeze.blocked && !helped && !slides;
            if leaves && is_refused {
                break;
            }
            if self.trails[hand].is_empty() {
                break;
            }
        }
        Ok((work, total))
    }

    /// Checks that a path leads the bit neither deeper than allowed nor through stone.
    pub(super) fn check_way(
        &self,
        hand: usize,
        way: &BitWay,
        grid_bit: &GridBit,
        goes_through_stone: bool,
    ) -> Result<(), String> {
        let state = &self.hands[hand];
        if way.freeze.jumped || !state.has_frozen_pose {
            return Ok(());
        }
        let (from, to) = (&state.frozen_pose, &way.freeze.pose);
        check_depths(&way.obstacle, grid_bit, from, to)?;
        let is_open = goes_through_stone || is_way_open(self.volume.voxels(), grid_bit, from, to);
        ensure!(is_open, "hand {hand} goes through stone from {from:?} to {to:?}");
        Ok(())
    }

    /// Finds the path of a hand's bit. The volume doesn't stop a nozzle that lays paste or a file that
    /// smooths; if one of these starts inside stone, it jumps to its hand if the mask allows that.
    pub(super) fn find_way(
        &self,
        state: &HandState,
        presses: HandPresses,
        way: &WayToFind<'_>,
        budget: WayBudget,
    ) -> BitWay {
        let WayToFind { grid_bit, from, wanted, goes_through_stone, .. } = *way;
        if !goes_through_stone {
            return BitWay::walked(self.stone(), state, way, budget);
        }
        let mask = ContactModel::of_mask_alone(self.mask.voxels());
        let begins = presses.pulled || !state.can_sweep;
        if begins && self.stone().buries(grid_bit, from) {
            let freeze = mask.jump_if_bite_allows(grid_bit, from, wanted, budget);
            return BitWay { obstacle: mask, may_edit: freeze.jumped, freeze, swept_from: None };
        }
        BitWay::walked(mask, state, way, budget)
    }

    /// Returns the obstacle for bits: volume and mask.
    pub(super) fn stone(&self) -> ContactModel {
        ContactModel::of_shared(self.volume.voxels(), self.mask.voxels())
    }

    /// Applies a bit's edit with its brush, or with `smaller` if the brush is too large for smoothing.
    pub(super) fn edit(
        &mut self,
        operation: EditOperation,
        brush: &Brush,
        smaller: &Brush,
    ) -> EditReport {
        let fits = |brush: &&Brush| {
            !matches!(operation, EditOperation::Smooth { .. } | EditOperation::Flatten { .. })
                || brush.bounds(self.side()).is_none_or(|bounds| {
                    let rows = [1, 2].map(|axis| bounds.hi[axis] - bounds.lo[axis] + 1);
                    rows[0] * rows[1] <= SMOOTH_LINES * self.side()
                })
        };
        let Some(brush) = [brush, smaller].into_iter().find(fits) else {
            return EditReport::default();
        };
        let voxels = voxels_of_brush(brush, self.side(), self.is_mirrored);
        self.edit_voxels(operation, &voxels, self.is_mirrored)
    }

    /// Applies an edit of a set of voxels, which includes the mirror image if the edit is mirrored.
    pub(super) fn edit_voxels(
        &mut self,
        operation: EditOperation,
        voxels: &[[i32; 3]],
        is_mirrored: bool,
    ) -> EditReport {
        let before = self.volume.columns().clone();
        let (report, change) =
            self.volume.apply_edit(self.mask.voxels(), voxels, operation, is_mirrored);
        self.history.note_edit(&before, &change.columns);
        self.islands.note_added(&change.added);
        if report.changed_volume() {
            self.islands.request_pass(self.tick);
        }
        report
    }
}

impl BitWay {
    /// Finds the path of a bit that isn't swept yet: it edits nothing until its path ends for a reason other
    /// than the budget. A bit that jumped doesn't sweep the jump.
    fn walked(
        obstacle: ContactModel,
        state: &HandState,
        way: &WayToFind<'_>,
        budget: WayBudget,
    ) -> Self {
        let WayToFind { grid_bit, from, wanted, .. } = *way;
        let freeze = match way.slides {
            true => obstacle.freeze_by_walk(grid_bit, from, wanted, budget),
            false => obstacle.freeze_by_walk_straight(grid_bit, from, wanted, budget),
        };
        BitWay {
            obstacle,
            freeze,
            swept_from: (state.can_sweep && !freeze.jumped).then_some(*from),
            may_edit: state.can_sweep || !freeze.ran_out,
        }
    }
}

/// Returns `true` if a bit edits this many ticks after its trigger was pulled.
pub(super) fn is_blow_at(bit: ToolBit, trigger_ticks: u16) -> bool {
    let period = u16::from(bit.spec().bite_period);
    match bit.spec().flake_um {
        0 => 2 * (trigger_ticks % period) < period,
        _ => trigger_ticks.is_multiple_of(period),
    }
}

/// Checks that a bit is no deeper than its bite or its previous depth.
fn check_depths(
    obstacle: &ContactModel,
    bit: &GridBit,
    from: &Pose,
    to: &Pose,
) -> Result<(), String> {
    let [before, after] = [from, to].map(|pose| obstacle.penetration_at(bit, pose));
    ensure!(after.mask <= before.mask, "deeper in the mask: {before:?}, {after:?}");
    let most = before.volume.max(bit.bite);
    ensure!(after.volume <= most, "deeper in the volume: {before:?}, {after:?}");
    Ok(())
}

/// Returns `true` if the straight path of a bit's centre is free of stone, by sampling points a 64th of a
/// voxel apart. A bit so small that its bite lets its centre into a voxel may be anywhere.
fn is_way_open(volume: &DenseVolume, bit: &GridBit, from: &Pose, to: &Pose) -> bool {
    if from == to || bit.inscribed_radius_subunits() - BURIED_WITHIN < bit.bite {
        return true;
    }
    let points = (from.position.distance(to.position) * 64.0).ceil().max(1.0) as u32;
    (0..=points).all(|i| {
        let point = from.position.lerp(to.position, i as f32 / points as f32);
        !volume.contains(point.floor().as_ivec3().to_array())
    })
}

/// Returns the strength of a hand's pulse, 0 to 255: zero without contact, strongest on the mask, otherwise
/// by speed; in the tool's rhythm while it runs, a quarter at rest.
fn pulse(
    bit: ToolBit,
    contact: &Contact,
    hand: &HandState,
    runs: bool,
    speed_um_per_tick: u32,
) -> u8 {
    let strength = match (contact.on_mask, contact.overlap) {
        (true, _) => 255,
        (false, 0) => return 0,
        (false, _) => 80 + (speed_um_per_tick / 250).min(120),
    };
    let rhythm = bit.spec().haptic_train;
    let beat = match runs {
        true => u32::from(rhythm[usize::from(hand.trigger_ticks) % rhythm.len()]),
        false => 64,
    };
    (strength * beat / 255) as u8
}
