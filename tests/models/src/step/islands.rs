//! The promise of island removal, for a volume that is edited meanwhile. The core's search says when a pass
//! runs, in its save; what goes when it ends follows from what it had reached the tick before, and that is held
//! between two bounds: it never reaches what nothing connects to ground, mask or an addition, and it ends in
//! time.

use std::collections::BTreeSet;

use paros_core::edit::IslandReport;

use crate::dense::{DenseVolume, face_neighbours};
use crate::step::ensure;
use crate::step::save::SeenPass;
use crate::step::volume::Voxel;

/// Ticks from an edit to the end of its pass at most, if one tick's visits are enough for it.
pub const LONGEST_WAIT: u64 = 12;

/// The same where there is a mask.
pub const LONGEST_WAIT_BESIDE_MASK: u64 = 24;

/// The passes of a session.
#[derive(Clone, Debug)]
pub struct IslandModel {
    side: usize,
    /// The tick of the oldest change that no running pass is about.
    requested_in: Option<u64>,
    running: Option<RunningPass>,
    /// Voxels that edits added in this tick.
    added: BTreeSet<Voxel>,
    /// The voxels that the last pass reported as kept.
    kept: BTreeSet<Voxel>,
    /// Passes so far.
    passes: u32,
    /// What the core's save said after the last tick.
    seen: SeenPass,
}

/// A pass in flight.
#[derive(Clone, Debug)]
struct RunningPass {
    /// The tick of the oldest change that it is about.
    requested_in: u64,
    /// All that it may have reached: ground and mask, what was added since, and everything that was connected
    /// to these at the end of a tick. `None` in most passes of large grids, to spare time.
    reachable: Option<DenseVolume>,
    added: BTreeSet<Voxel>,
}

/// What the islands' part of a tick starts from.
#[derive(Clone, Copy, Debug)]
pub struct IslandTick<'a> {
    /// The tick's number.
    pub tick: u64,
    /// The volume after the hands' edits.
    pub volume: &'a DenseVolume,
    /// The mask.
    pub mask: &'a DenseVolume,
    /// Whether something can be redone, which holds a requested pass.
    pub is_held: bool,
    /// Whether the world told of the end of a pass in this tick.
    pub is_told: bool,
    /// What the core's save says after the tick.
    pub seen: &'a SeenPass,
}

/// The end of a pass.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum PassEnd {
    /// Nothing stands on ground or mask; nothing is removed.
    Unsupported,
    /// These voxels are removed as far as closure lets them go.
    Removes(Vec<Voxel>),
}

impl IslandModel {
    /// No pass, none requested.
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

    /// An edit, undo or redo changed the volume.
    pub fn request_pass(&mut self, tick: u64) {
        self.requested_in = self.requested_in.or(Some(tick));
    }

    /// Edits added voxels.
    pub fn note_added(&mut self, voxels: &[Voxel]) {
        self.added.extend(voxels);
    }

    /// Ends the running pass and forgets the requested one.
    pub fn cancel_passes(&mut self) {
        (self.requested_in, self.running) = (None, None);
    }

    /// Whether nothing is left to a running pass but to remove what it hasn't reached.
    pub fn is_removal_due(&self) -> bool {
        self.running.is_some() && self.seen.is_done_searching()
    }

    /// Runs the islands' part of a tick. Returns the end of a pass, if one ended.
    ///
    /// # Errors
    /// The core's search isn't where it may be.
    pub fn advance(&mut self, now: IslandTick<'_>) -> Result<Option<PassEnd>, String> {
        let mut added = std::mem::take(&mut self.added);
        let mut reached = DenseVolume::empty(self.side);
        if self.running.is_some() {
            reached = DenseVolume::clone(&self.seen.reached);
        } else if !now.is_held
            && let Some(requested_in) = self.requested_in.take()
        {
            // A pass begins with the volume as both hands left it.
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

    /// The report of a pass that removed `removed` voxels and couldn't remove `kept`, which is told once.
    pub fn report_removal(&mut self, removed: usize, kept: BTreeSet<Voxel>) -> IslandReport {
        let is_known = kept == self.kept;
        let told = if is_known { 0 } else { kept.len() as u32 };
        self.kept = kept;
        IslandReport { removed: removed as u32, kept: told, unsupported: false }
    }

    /// Ticks for which the oldest change has waited for the end of its pass; `None` where nothing waits, or
    /// what waits is held.
    pub fn waited(&self, tick: u64, is_held: bool) -> Option<u64> {
        let requested = if is_held { None } else { self.requested_in };
        let running = self.running.as_ref().map(|pass| pass.requested_in);
        running.or(requested).map(|since| tick - since)
    }

    /// Notes what the core's save says after the tick, and checks that it asks for a pass where one is called
    /// for.
    fn check_flags(&mut self, now: &IslandTick<'_>) -> Result<(), String> {
        let is_requested = self.requested_in.is_some();
        ensure!(
            now.seen.is_requested == is_requested,
            "a pass is requested: {}, should be {is_requested}",
            now.seen.is_requested
        );
        ensure!(now.seen.is_running == self.running.is_some(), "a pass runs that has ended");
        if now.is_held && is_requested {
            // Its time begins when nothing holds it any more.
            self.requested_in = Some(now.tick + 1);
        }
        self.seen = now.seen.clone();
        Ok(())
    }
}

impl RunningPass {
    /// What a pass does at its end, that had reached these voxels before. One that isn't watched and of which nothing is
    /// told has removed nothing, and keeps nothing but what a pass before it may have kept, which isn't told again.
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

    /// Checks what a running pass has reached: no more than it may, and all that was added; and that no row
    /// that isn't queued holds a voxel that it should have reached from a neighbour.
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

/// All voxels of the volume that are connected to ground, to mask, or to a voxel that was reached, which may be
/// gone since.
fn connected_to_reached(now: &IslandTick<'_>, reached: &DenseVolume) -> DenseVolume {
    let is_seed = |voxel: Voxel| {
        voxel[1] == 0
            || now.mask.contains(voxel)
            || reached.contains(voxel)
            || face_neighbours(voxel).iter().any(|&at| reached.contains(at))
    };
    now.volume.connected_to(now.volume.occupied().filter(|&voxel| is_seed(voxel)).collect())
}
