//! Compares a world with its model after each tick: everything visible of the world must equal the model's.

use paros_core::internals::{DIGEST_PARTS, checksum, combine_digests, maps_digest};
use paros_core::limits::max_save_bytes;
use paros_core::session::{BenchItem, HandState, HandTrail, Tool, ToolBit};
use paros_core::volume::{Axis, BitSet, Column, DirtyRects, Grid, Size};
use paros_core::{RangeMaps, StartVolumes, TickInput, World};

use crate::step::save::SplitSave;
use crate::step::volume::Columns;
use crate::step::{StepModel, ensure};

/// The model of a world, and the data for comparing them.
#[derive(Debug)]
pub struct WorldComparison<const N: usize, const K: usize> {
    /// The model.
    pub model: StepModel<K>,
    /// A copy of the world's columns that is updated only by the dirty rectangles.
    stale: Columns<K>,
    save: Vec<u8>,
}

impl<const N: usize, const K: usize> WorldComparison<N, K>
where
    Grid<N>: Size,
{
    /// Creates the comparison for a cleared world.
    pub fn of_cleared_world() -> Self {
        WorldComparison {
            model: StepModel::new(N),
            stale: Axis::ALL.map(|_| vec![Column::EMPTY; N * N]),
            save: vec![0; max_save_bytes(N, K)],
        }
    }

    /// Returns the world's save after the last tick.
    pub fn last_save(&self) -> &[u8] {
        &self.save
    }

    /// Runs the model's tick after the world's, and compares both.
    ///
    /// # Errors
    /// The difference.
    pub fn follow_tick(
        &mut self,
        world: &World<N, K>,
        input: &TickInput,
        starts: &StartVolumes<'_, N, K>,
    ) -> Result<(), String> {
        self.save.resize(max_save_bytes(N, K), 0);
        let len = world.save(&mut self.save);
        ensure!(len <= self.save.len(), "a save of {len} bytes is longer than it may be");
        self.save.truncate(len);
        let save = SplitSave::of(&self.save, N, K)?;
        self.model.step(input, starts, &save.seen, world.events())?;
        self.compare_what_is_shown(world)?;
        save.compare(&self.model)?;
        self.compare_maps(world)?;
        self.compare_digests(world)
    }

    /// Compares a world into which the last save was loaded.
    ///
    /// # Errors
    /// The difference.
    pub fn follow_load(&mut self, world: &World<N, K>) -> Result<(), String> {
        let mut again = vec![0; self.save.len()];
        ensure!(world.save(&mut again) == again.len(), "another length after a load");
        ensure!(again == self.save, "another save after a load");
        self.model.events.clear();
        self.model.contacts = [None; 2];
        self.compare_what_is_shown(world)?;
        self.compare_maps(world)?;
        self.compare_digests(world)
    }

    fn compare_what_is_shown(&self, world: &World<N, K>) -> Result<(), String> {
        let model = &self.model;
        ensure!(
            world.events() == model.events,
            "events {:?}, should be {:?}",
            world.events(),
            model.events
        );
        for hand in [0, 1] {
            let (is, should) = (world.hand_state(hand), &model.hands[hand]);
            let without_trail = HandState { trail: HandTrail::EMPTY, ..*is };
            ensure!(&without_trail == should, "hand {hand} is {is:?}, should be {should:?}");
            let (is, should) = (is.trail.poses(), &model.trails[hand]);
            ensure!(should == &is, "the trail of hand {hand} is {is:?}, should be {should:?}");
            ensure!(
                world.hand_contact(hand) == model.contacts[hand],
                "contact {hand} is {:?}, should be {:?}",
                world.hand_contact(hand),
                model.contacts[hand]
            );
            let held = model.bench.held(hand);
            ensure!(world.held_tool(hand) == held, "hand {hand} holds another tool than {held:?}");
        }
        for item in Tool::ALL
            .into_iter()
            .map(BenchItem::Tool)
            .chain(ToolBit::ALL.into_iter().map(BenchItem::Bit))
        {
            let bench = world.workbench();
            let is = (bench.place_of(item), bench.pose_of(item));
            let should = (model.bench.place_of(item), model.bench.pose_of(item));
            ensure!(is == should, "{item:?} is at {is:?}, should be at {should:?}");
        }
        let is = (world.session_state(), world.mode(), world.is_mirrored(), world.tick());
        let should = (model.session, model.mode, model.is_mirrored, model.tick);
        ensure!(is == should, "the session is {is:?}, should be {should:?}");
        ensure!(world.stool_frame() == model.stool_frame(), "the stool is turned otherwise");
        let (is, should) = (world.bared_ends(), model.bared_ends());
        ensure!(is == should, "{is:?}, should be {should:?}");
        let (is, should) = (world.undo_counts(), model.history.counts());
        ensure!(is == should, "{is:?}, should be {should:?}");
        Ok(())
    }

    /// Compares the maps, the rows and the copy updated by the dirty rectangles with the model's columns.
    fn compare_maps(&mut self, world: &World<N, K>) -> Result<(), String> {
        update_stale(&mut self.stale, world.dirty_rects(), world.volume().maps());
        let (volume, mask) = (&self.model.volume, &self.model.mask);
        for axis in Axis::ALL {
            for line in 0..N {
                let here = line * N..(line + 1) * N;
                let should = &volume.columns()[axis as usize][here.clone()];
                let is = world.volume().maps().line(axis, line);
                if let Some(place) = (0..N).find(|&place| is[place] != should[place]) {
                    let (is, should) = (is[place], should[place]);
                    return Err(format!(
                        "{axis:?} ({line}, {place}): {is:?}, should be {should:?}"
                    ));
                }
                let stale = &self.stale[axis as usize][here.clone()];
                ensure!(stale == should, "{axis:?} line {line} changed beside all rectangles");
                let masked = &mask.columns()[axis as usize][here];
                ensure!(world.mask().line(axis, line) == masked, "mask, {axis:?} line {line}");
            }
        }
        // On large grids only a part of the rows is compared in each tick.
        let parts = if N > 64 { 8 } else { 1 };
        for y in (0..N).filter(|y| *y as u64 % parts == self.model.tick % parts) {
            for (z, row) in world.volume().rows().layer(y).iter().enumerate() {
                let should = volume.voxels().row(y, z);
                let is = BitSet::iter_ones(*row);
                let occupied = (0..N).filter(|&x| should[x]);
                ensure!(is.eq(occupied), "bit row ({y}, {z}) isn't what the maps hold");
            }
        }
        Ok(())
    }

    fn compare_digests(&self, world: &World<N, K>) -> Result<(), String> {
        let digest = world.digest();
        ensure!(digest == world.recompute_digest(), "the digest isn't that of the state");
        let parts = world.part_digests();
        let state = checksum(&self.model.state_bytes());
        ensure!(parts[0].1 == state, "the digest of {} isn't that of its bytes", parts[0].0);
        let volume = maps_digest(world.volume().maps());
        ensure!(parts[1].1 == volume, "the digest of {} isn't that of its columns", parts[1].0);
        let all: [u64; DIGEST_PARTS.len()] = parts.map(|(_, digest)| digest);
        ensure!(digest == combine_digests(all), "the digest isn't that of its parts");
        Ok(())
    }
}

/// Copies the columns in the dirty rectangles.
fn update_stale<const N: usize, const K: usize>(
    stale: &mut Columns<K>,
    dirty: &DirtyRects,
    maps: &RangeMaps<N, K>,
) {
    for axis in Axis::ALL {
        for rect in dirty.rects(axis) {
            for line in rect.first.0..=rect.last.0 {
                let places = usize::from(rect.first.1)..=usize::from(rect.last.1);
                let line = usize::from(line);
                stale[axis as usize][line * N..][places.clone()]
                    .copy_from_slice(&maps.line(axis, line)[places]);
            }
        }
    }
}
