//! Model of island removal in a volume that is edited meanwhile. When a pass runs is read from the save of
//! the core's search. The voxels removed at its end follow from what the search had reached the tick before.
//! The model bounds the reached voxels: the search never reaches a voxel without a connection to ground, mask
//! or an addition, and it ends in time.

use std::collections::BTreeSet;

use paros_core::edit::IslandReport;

use crate::dense::{DenseVolume, face_neighbours};
use crate::step::ensure;
use crate::step::save::SeenPass;
use crate::step::volume::Voxel;

/// Longest time from an edit to the end of its pass, in ticks, if one tick's visits are enough for the pass.
pub const LONGEST_WAIT: u64 = 12;

/// Longest such time with a mask.
pub const LONGEST_WAIT_BESIDE_MASK: u64 = 24;

/// The model of a session's passes.
#[derive(Clone, Debug)]
pub struct IslandModel {
    side: usize,
    /// The tick of the oldest change that the running pass doesn't cover.
    requested_in: Option<u64>,
    running: Option<RunningPass>,
    /// Voxels that edits added in this tick.
    added: BTreeSet<Voxel>,
    /// The voxels that the last pass reported as kept.
    kept: BTreeSet<Voxel>,
    /// Number of passes so far.
    passes: u32,
    /// The pass in the core's save after the last tick.
    seen: SeenPass,
}

/// A pass in flight.
#[derive(Clone, Debug)]
struct RunningPass {
    /// The tick of the oldest change that the pass covers.
    requested_in: u64,
    /// All voxels that the pass may have reached: ground and mask, additions since its start, and all voxels
    /// connected to these at the end of any tick. `None` in most passes of large grids, to save time.
    reachable: Option<DenseVolume>,
    added: BTreeSet<Voxel>,
}

/// The inputs of the islands' part of a tick.
#[derive(Clone, Copy, Debug)]
pub struct IslandTick<'a> {
    /// The tick's number.
    pub tick: u64,
    /// The volume after the hands' edits.
    pub volume: &'a DenseVolume,
    /// The mask.
    pub mask: &'a DenseVolume,
    /// `true` if a redo is possible, which holds back a requested pass.
    pub is_held: bool,
    /// `true` if the world reported the end of a pass in this tick.
    pub is_told: bool,
    /// The pass in the core's save after the tick.
    pub seen: &'a SeenPass,
}

/// The end of a pass.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum PassEnd {
    /// Nothing is supported by ground or mask, so nothing is removed.
    Unsupported,
    /// These voxels are removed unless closure keeps them.
    Removes(Vec<Voxel>),
}

impl IslandModel {
    /// Creates the model without a running or requested pass.
    pub fn new(side: usize) -> Self {
        IslandModel {
            side,
            requested_in: None,
            running: None,
            added: BTreeSet::new(),
            kept: BTreeSet::new(),
            passes: 0,
            seen: SeenPass::none(side),
        }
    }

    /// Requests a pass after an edit, undo or redo.
    pub fn request_pass(&mut self, tick: u64) {
        self.requested_in = self.requested_in.or(Some(tick));
    }

    /// Records voxels added by edits.
    pub fn note_added(&mut self, voxels: &[Voxel]) {
        self.added.extend(voxels);
    }

    /// Aborts the running pass and drops the requested one.
    pub fn cancel_passes(&mut self) {
        (self.requested_in, self.running) = (None, None);
    }

    /// Returns `true` if the running pass has finished its search and only the removal is left.
    pub fn is_removal_due(&self) -> bool {
        self.running.is_some() && self.seen.is_done_searching()
    }

    /// Runs the islands' part of a tick. Returns the end of a pass, if one ended.
    ///
    /// # Errors
    /// The core's search violates the bounds.
    pub fn advance(&mut self, now: IslandTick<'_>) -> Result<Option<PassEnd>, String> {
        let mut added = std::mem::take(&mut self.added);
        let mut reached = DenseVolume::empty(self.side);
        if self.running.is_some() {
            reached = DenseVolume::clone(&self.seen.reached);
        } else if !now.is_held
            && let Some(requested_in) = self.requested_in.take()
        {
            // A pass begins with the volume after both hands' edits.
            added.clear();
            let is_watched = self.side <= 64 || self.passes.is_multiple_of(8);
            let reachable = is_watched.then(|| DenseVolume::empty(self.side));
            self.passes += 1;
            self.running = Some(RunningPass { requested_in, reachable, added: BTreeSet::new() });
        }
        let Some(pass) = &mut self.running else {
            ensure!(!now.seen.is_running, "a pass runs that wasn't called for, or is held");
            return self.check_flags(&now).map(|()| None);
        };
        pass.added.extend(&added);
        added.iter().for_each(|&voxel| reached.set(voxel, true));
        if let Some(reachable) = &mut pass.reachable {
            reachable.extend(&reached);
            let connected = connected_to_reached(&now, reachable);
            reachable.extend(&connected);
        }
        let mut end = None;
        if now.seen.is_running {
            pass.check_reached(&now)?;
        } else {
            end = Some(pass.find_end(&now, &reached, !self.kept.is_empty())?);
            self.running = None;
        }
        self.check_flags(&now)?;
        Ok(end)
    }

    /// Returns the report of a pass that removed `removed` voxels and couldn't remove `kept`; the same kept
    /// voxels are reported only once.
    pub fn report_removal(&mut self, removed: usize, kept: BTreeSet<Voxel>) -> IslandReport {
        let is_known = kept == self.kept;
        let told = if is_known { 0 } else { kept.len() as u32 };
        self.kept = kept;
        IslandReport { removed: removed as u32, kept: told, unsupported: false }
    }

    /// Returns the number of ticks for which the oldest change has waited for the end of its pass; `None` if
    /// nothing waits, or if the pass is held back.
    pub fn waited(&self, tick: u64, is_held: bool) -> Option<u64> {
        let requested = if is_held { None } else { self.requested_in };
        let running = self.running.as_ref().map(|pass| pass.requested_in);
        running.or(requested).map(|since| tick - since)
    }

    /// Stores the pass of the core's save after the tick, and checks that a pass is requested if one is
    /// needed.
    fn check_flags(&mut self, now: &IslandTick<'_>) -> Result<(), String> {
        let is_requested = self.requested_in.is_some();
        ensure!(
            now.seen.is_requested == is_requested,
            "a pass is requested: {}, should be {is_requested}",
            now.seen.is_requested
        );
        ensure!(now.seen.is_running == self.running.is_some(), "a pass runs that has ended");
        if now.is_held && is_requested {
            // The time limit starts once the pass is no longer held back.
            self.requested_in = Some(now.tick + 1);
        }
        self.seen = now.seen.clone();
        Ok(())
    }
}

impl RunningPass {
    /// Returns the end of a pass that had reached these voxels before. If an unwatched pass isn't reported,
    /// it removed nothing, and kept at most voxels that an earlier pass may have kept, which aren't reported
    /// again.
    fn find_end(
        &self,
        now: &IslandTick<'_>,
        reached: &DenseVolume,
        was_any_kept: bool,
    ) -> Result<PassEnd, String> {
        let touches_ground = || now.volume.occupied().any(|[_, y, _]| y == 0);
        if now.mask.is_empty() && !touches_ground() {
            return Ok(PassEnd::Unsupported);
        }
        if self.reachable.is_none() && !now.is_told && !was_any_kept {
            return Ok(PassEnd::Removes(Vec::new()));
        }
        let islands = now.volume.difference(&connected_to_reached(now, reached));
        if let Some(reachable) = &self.reachable {
            let certain = now.volume.difference(reachable);
            ensure!(certain.is_within(&islands), "what nothing ever held up is let be");
        }
        Ok(PassEnd::Removes(islands.occupied().collect()))
    }

    /// Checks that a running pass has reached only voxels that it may, and all additions; and that every row
    /// that lacks a voxel reachable from a neighbour is queued.
    fn check_reached(&self, now: &IslandTick<'_>) -> Result<(), String> {
        let seen = now.seen;
        let Some(reachable) = &self.reachable else { return Ok(()) };
        let beyond = seen.reached.difference(reachable);
        ensure!(beyond.is_empty(), "reached without a way there: {beyond:?}");
        for &voxel in &self.added {
            ensure!(seen.reached.contains(voxel), "{voxel:?} was added and isn't reached");
        }
        if !seen.is_seeded {
            return Ok(());
        }
        for voxel in now.volume.difference(&seen.reached).occupied() {
            let [_, y, z] = voxel;
            let is_next = face_neighbours(voxel).iter().any(|&at| seen.reached.contains(at));
            ensure!(!is_next || seen.is_queued(y, z), "{voxel:?} is in no queued row");
        }
        Ok(())
    }
}

/// Returns all voxels of the volume that are connected to ground, to mask, or to a reached voxel, which may
/// have been removed since.
fn connected_to_reached(now: &IslandTick<'_>, reached: &DenseVolume) -> DenseVolume {
    let is_seed = |voxel: Voxel| {
        voxel[1] == 0
            || now.mask.contains(voxel)
            || reached.contains(voxel)
            || face_neighbours(voxel).iter().any(|&at| reached.contains(at))
    };
    now.volume.connected_to(now.volume.occupied().filter(|&voxel| is_seed(voxel)).collect())
}
