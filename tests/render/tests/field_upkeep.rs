//! The fast path's textures, updated while the volume changes, against a complete rebuild. The copy under
//! test sees only the emitted regions.

use std::sync::{Mutex, PoisonError};

use glam::IVec3;
use paros_core::edit::{EditOperation, EditScratch, SUBUNITS_PER_VOXEL};
use paros_core::volume::{Axis, DirtyRects, Grid, Size};
use paros_core::{Brush, Edit, RangeMaps, Volume, apply_edit};
use paros_models::cases::scaled_cases;
use paros_models::random_visitor::RandomSource;
use paros_shaders::field::{Budget, DensityField, HALF_DENSITY, LEVELS, MAX_CELL_DISTANCE};
use paros_shaders::upload::{Region, Texture};

/// A texture's bytes, and the number of bytes a texel.
#[derive(PartialEq)]
struct TextureCopy {
    side: [usize; 2],
    texel: usize,
    bytes: Vec<u8>,
}

/// Copies of the textures, as on a GPU that receives every region.
struct TextureCopies(Vec<TextureCopy>);

impl TextureCopies {
    fn of<const N: usize, const K: usize>(field: &DensityField<N, K>) -> Self {
        let cube =
            |side: usize| TextureCopy { side: [side; 2], texel: 1, bytes: vec![99; side.pow(3)] };
        let maps = TextureCopy { side: [N; 2], texel: 2 * K, bytes: vec![99; 3 * N * N * 2 * K] };
        let gradient = TextureCopy {
            texel: 4,
            bytes: vec![99; 4 * field.level_side(1).pow(3)],
            ..cube(field.level_side(1))
        };
        let mut copies = vec![maps];
        copies.extend((0..LEVELS).map(|level| cube(field.level_side(level))));
        copies.push(cube(field.cells_per_side()));
        copies.push(gradient);
        let mut copies = TextureCopies(copies);
        field.emit_all_regions(|region, bytes| copies.write(region, bytes));
        copies
    }

    fn write(&mut self, region: Region, bytes: &[u8]) {
        assert!(region.size.iter().all(|&side| side > 0), "{region:?}");
        assert_eq!(bytes.len(), region.byte_count(), "{region:?}");
        let copy = &mut self.0[match region.texture {
            Texture::Maps(_) => 0,
            Texture::Density(level) => 1 + usize::from(level),
            Texture::Cells => 1 + LEVELS,
            Texture::Gradient => 2 + LEVELS,
            Texture::Noise | Texture::Marble => panic!("{region:?} is no function of the maps"),
        }];
        let [x, y, z] = region.min.map(|i| i as usize);
        let [width, height, _] = region.size.map(|i| i as usize);
        assert!(x + width <= copy.side[0] && y + height <= copy.side[1], "{region:?}");
        for (i, row) in bytes.chunks_exact(width * copy.texel).enumerate() {
            let (y, z) = (y + i % height, z + i / height);
            let at = ((z * copy.side[1] + y) * copy.side[0] + x) * copy.texel;
            copy.bytes[at..at + row.len()].copy_from_slice(row);
        }
    }

    /// Checks that no surface passes through cells that are marked as free.
    fn check_cells(&self, settled: bool) {
        let (density, cells) = (&self.0[1], &self.0[1 + LEVELS]);
        let side = cells.side[0];
        let mut within = solid_cells(density, side);
        let mut free = vec![0; side.pow(3)];
        // Grows the range step by step, a cell at a time.
        for _ in 1..MAX_CELL_DISTANCE {
            within = with_cells_beside(&within, side);
            for (row, free) in within.iter().zip(free.chunks_exact_mut(side)) {
                free.iter_mut()
                    .enumerate()
                    .for_each(|(x, free)| *free += u8::from(row >> x & 1 == 0));
            }
        }
        for (right, told) in free.iter().zip(&cells.bytes) {
            assert!(told <= right, "{told} told, it is {right}");
        }
        assert!(!settled || free == cells.bytes, "cells are not right for the density");
    }
}

/// Returns the cells, `side` along an axis, with a stone texel of the density in or beside them: one bit
/// each, with x as the bit's place in a row, and y before z among rows.
fn solid_cells(density: &TextureCopy, side: usize) -> Vec<u128> {
    let texels = density.side[0];
    let size = texels / side;
    let beside = |c: usize| c.saturating_sub(1) / size..=((c + 1) / size).min(side - 1);
    let bits: Vec<u128> = (0..texels).map(|x| beside(x).map(|x| 1 << x).sum()).collect();
    let mut solid = vec![0; side * side];
    for (i, row) in density.bytes.chunks_exact(texels).enumerate() {
        let stone = row.iter().zip(&bits).filter(|(texel, _)| **texel >= HALF_DENSITY);
        let of_row = stone.fold(0, |all, (_, bits)| all | bits);
        for z in beside(i / texels) {
            beside(i % texels).for_each(|y| solid[z * side + y] |= of_row);
        }
    }
    solid
}

/// Returns rows of cells, together with all cells that touch one of theirs.
fn with_cells_beside(rows: &[u128], side: usize) -> Vec<u128> {
    let along_rows: Vec<u128> = rows.iter().map(|row| row | row << 1 | row >> 1).collect();
    let across = |rows: &[u128], stride: usize| -> Vec<u128> {
        let with_beside = |i: usize| {
            let at = i / stride % side;
            let before = if at > 0 { rows[i - stride] } else { 0 };
            let behind = if at + 1 < side { rows[i + stride] } else { 0 };
            before | rows[i] | behind
        };
        (0..rows.len()).map(with_beside).collect()
    };
    across(&across(&along_rows, 1), side)
}

/// A volume changed by random edits, undos and loads.
struct EditedField<const N: usize, const K: usize>
where
    Grid<N>: Size,
{
    volume: Volume<N, K>,
    mask: RangeMaps<N, K>,
    scratch: EditScratch<N>,
    earlier: RangeMaps<N, K>,
    edits: u32,
}

impl<const N: usize, const K: usize> EditedField<N, K>
where
    Grid<N>: Size,
{
    const fn new() -> Self {
        EditedField {
            volume: Volume::new(),
            mask: RangeMaps::new(),
            scratch: EditScratch::new(),
            earlier: RangeMaps::new(),
            edits: 0,
        }
    }

    /// Runs one tick: usually one or two edits, sometimes an undo, seldom a load.
    fn apply_random_tick(&mut self, dice: &mut RandomSource, dirty: &mut DirtyRects) {
        dirty.clear();
        match dice.below(60) {
            0 => self.load_volume(dice, dirty),
            1..4 => self.swap_volume(dirty),
            4..8 => self.earlier.copy_from(self.volume.maps()),
            _ => (0..=dice.below(2)).for_each(|_| self.apply_random_edit(dice, dirty)),
        }
    }

    fn apply_random_edit(&mut self, dice: &mut RandomSource, dirty: &mut DirtyRects) {
        let n = N as u64;
        let at = [0; 3].map(|_| {
            (dice.below(n) as i32) * SUBUNITS_PER_VOXEL
                + dice.below(SUBUNITS_PER_VOXEL as u64) as i32
        });
        let most = if dice.one_in(8) { n / 4 } else { n / 10 };
        let radius = dice.below(most * SUBUNITS_PER_VOXEL as u64) as i32;
        let brush = Brush::sphere(IVec3::from_array(at), radius);
        let operation = [
            EditOperation::Carve { depth: 4 },
            EditOperation::Carve { depth: 2 },
            EditOperation::Fill { depth: 3 },
            EditOperation::Smooth { radius: 3, dither: None },
        ][dice.below(4) as usize];
        let edit = Edit { brush: &brush, operation, mirrored: dice.one_in(4) };
        let log = &mut *dirty;
        // A ball that is too large to smooth is refused and changes nothing.
        let _ = apply_edit(&mut self.volume, &self.mask, &edit, &mut self.scratch, log);
        dirty.end_edit();
        self.edits += 1;
    }

    /// Restores the earlier volume, reported like an undo: column by column.
    fn swap_volume(&mut self, dirty: &mut DirtyRects) {
        let before = Box::new(self.volume.maps().clone());
        self.volume.set_maps(&self.earlier);
        for axis in Axis::ALL {
            for at in (0..N * N).map(|i| (i / N, i % N)) {
                if before.column(axis, at) != self.earlier.column(axis, at) {
                    dirty.mark_column(axis, at);
                }
            }
        }
        dirty.end_edit();
        self.earlier.copy_from(&before);
    }

    fn count_gaps(&self) -> usize {
        let lines =
            Axis::ALL.map(|axis| (0..N).flat_map(move |line| self.volume.maps().line(axis, line)));
        lines.into_iter().flatten().flat_map(|column| column.intervals().skip(1)).count()
    }

    fn load_volume(&mut self, dice: &mut RandomSource, dirty: &mut DirtyRects) {
        let kind = dice.below(4);
        let n = N as i32;
        let balls = [0; 3].map(|_| {
            ([0; 3].map(|_| dice.below(N as u64) as i32), dice.below(N as u64 / 2) as i32)
        });
        self.volume.set_voxels(|plane| {
            for (y, z) in (0..N * N).map(|i| (i / N, i % N)) {
                for x in 0..N {
                    let at = [x, y, z].map(|c| c as i32);
                    let in_ball = |(centre, radius): &([i32; 3], i32)| {
                        (0..3).map(|i| (at[i] - centre[i]).pow(2)).sum::<i32>() <= radius * radius
                    };
                    let full = match kind {
                        0 => at.iter().all(|&c| c > 1 && c < n - 2),
                        1 => at[0] % 8 < 2 || at[1] == 0 || (at[2] % 9 == 4 && at[1] < n / 2),
                        2 => balls.iter().any(in_ball),
                        _ => at[1] < n * 3 / 4 && !balls.iter().any(in_ball),
                    };
                    if full {
                        use paros_core::volume::BitSet;
                        plane.row_mut(y, z).insert(x);
                    }
                }
            }
        });
        dirty.mark_all(N);
    }
}

fn follow_edits<const N: usize, const K: usize>(
    studio: &mut EditedField<N, K>,
    seed: u64,
    ticks: u32,
) where
    Grid<N>: Size,
{
    let mut dice = RandomSource::new(seed);
    let mut dirty = DirtyRects::new();
    let mut field = DensityField::<N, K>::new();
    let mut fresh = DensityField::<N, K>::new();
    let mut copies = TextureCopies::of(&field);
    let (mut settled, mut frames, mut gaps) = (0, 0, 0);
    studio.load_volume(&mut dice, &mut dirty);
    field.note_dirty_columns(studio.volume.maps(), &dirty);
    for tick in 0..ticks {
        studio.apply_random_tick(&mut dice, &mut dirty);
        field.note_dirty_columns(studio.volume.maps(), &dirty);
        if dice.one_in(4) {
            continue;
        }
        // Occasionally there is time to finish.
        for _ in 0..[1, 1, 1, 500][dice.below(4) as usize] {
            let budget =
                Budget { work: dice.below(400_000) as usize, bytes: dice.below(100_000) as usize };
            field.update_textures(budget, &mut |region, bytes| copies.write(region, bytes));
            frames += 1;
            if tick % 8 == 0 {
                // Maps may wait for another frame.
                let told = copies.0[1..] == TextureCopies::of(&field).0[1..];
                assert!(told, "tick {tick}: a change is not told");
                copies.check_cells(!field.has_pending());
            }
            if !field.has_pending() {
                break;
            }
        }
        assert!(field.noted_maps() == studio.volume.maps());
        if !field.has_pending() {
            settled += 1;
            gaps += studio.count_gaps();
            fresh.rebuild_from(studio.volume.maps());
            let fresh = TextureCopies::of(&fresh).0;
            assert!(fresh == copies.0, "tick {tick}: not what a rebuild gives");
        }
    }
    println!("{frames} frames, {settled} times settled, {gaps} gaps, {} edits", studio.edits);
    assert!(settled > ticks / 20 && frames > settled);
    assert!(K == 1 || gaps > settled as usize * N, "{gaps} gaps");
}

#[test]
fn upkeep_is_a_rebuild_on_16() {
    static STUDIO: Mutex<EditedField<16, 1>> = Mutex::new(EditedField::new());
    let mut studio = STUDIO.lock().unwrap_or_else(PoisonError::into_inner);
    (0..6).for_each(|seed| follow_edits(&mut studio, seed, 600));
}

#[test]
fn upkeep_is_a_rebuild_on_64() {
    static STUDIO: Mutex<EditedField<64, 1>> = Mutex::new(EditedField::new());
    let mut studio = STUDIO.lock().unwrap_or_else(PoisonError::into_inner);
    (0..2).for_each(|seed| follow_edits(&mut studio, 40 + seed, scaled_cases(200)));
}

#[test]
fn upkeep_is_a_rebuild_on_128() {
    static STUDIO: Mutex<EditedField<128, 1>> = Mutex::new(EditedField::new());
    let mut studio = STUDIO.lock().unwrap_or_else(PoisonError::into_inner);
    follow_edits(&mut studio, 70, scaled_cases(60));
}

#[test]
fn upkeep_is_a_rebuild_with_two_intervals_on_16() {
    static STUDIO: Mutex<EditedField<16, 2>> = Mutex::new(EditedField::new());
    let mut studio = STUDIO.lock().unwrap_or_else(PoisonError::into_inner);
    (10..16).for_each(|seed| follow_edits(&mut studio, seed, 600));
}

#[test]
fn upkeep_is_a_rebuild_with_four_intervals_on_16() {
    static STUDIO: Mutex<EditedField<16, 4>> = Mutex::new(EditedField::new());
    let mut studio = STUDIO.lock().unwrap_or_else(PoisonError::into_inner);
    (20..24).for_each(|seed| follow_edits(&mut studio, seed, 600));
}

#[test]
fn upkeep_is_a_rebuild_with_two_intervals_on_128() {
    static STUDIO: Mutex<EditedField<128, 2>> = Mutex::new(EditedField::new());
    let mut studio = STUDIO.lock().unwrap_or_else(PoisonError::into_inner);
    follow_edits(&mut studio, 71, scaled_cases(60));
}

/// A frame's cost and output are within its budget, and a load finishes.
#[test]
fn frames_keep_to_their_budget() {
    static STUDIO: Mutex<EditedField<128, 1>> = Mutex::new(EditedField::new());
    check_frame_budgets(&mut STUDIO.lock().unwrap_or_else(PoisonError::into_inner));
}

#[test]
fn frames_keep_to_their_budget_with_two_intervals() {
    static STUDIO: Mutex<EditedField<128, 2>> = Mutex::new(EditedField::new());
    check_frame_budgets(&mut STUDIO.lock().unwrap_or_else(PoisonError::into_inner));
}

fn check_frame_budgets<const K: usize>(studio: &mut EditedField<128, K>) {
    let (mut dice, mut dirty) = (RandomSource::new(5), DirtyRects::new());
    let mut field = DensityField::<128, K>::new();
    let budget = Budget::per_frame(128);
    for tick in 0..400 {
        dirty.clear();
        match tick % 200 {
            0 => studio.load_volume(&mut dice, &mut dirty),
            180 => studio.swap_volume(&mut dirty),
            _ if dice.one_in(2) => studio.apply_random_edit(&mut dice, &mut dirty),
            _ => {}
        }
        field.note_dirty_columns(studio.volume.maps(), &dirty);
        let mut bytes = 0;
        let spent = field.update_textures(budget, &mut |_, region| bytes += region.len());
        assert!(bytes <= budget.bytes, "tick {tick}: {bytes} bytes");
        // A frame does at least one thing: a box full of detail costs up to a fifth more than the budget.
        assert!(spent.work <= budget.work * 6 / 5, "tick {tick}: {spent:?}");
        assert_eq!(spent.bytes, bytes, "tick {tick}");
    }
    let frames = (0..600).take_while(|_| {
        field.update_textures(budget, &mut |_, _| {});
        field.has_pending()
    });
    let frames = frames.count();
    println!("done after {frames} frames");
    assert!(frames < 500, "never done");
}

/// Tests cells of four texels.
#[test]
fn cells_at_256() {
    static STUDIO: Mutex<EditedField<256, 1>> = Mutex::new(EditedField::new());
    let mut studio = STUDIO.lock().unwrap_or_else(PoisonError::into_inner);
    let (mut dice, mut dirty) = (RandomSource::new(6), DirtyRects::new());
    let (mut field, mut fresh) = (DensityField::<256, 1>::new(), DensityField::<256, 1>::new());
    let mut copies = TextureCopies::of(&field);
    for _ in 0..3 {
        dirty.clear();
        studio.load_volume(&mut dice, &mut dirty);
        field.note_dirty_columns(studio.volume.maps(), &dirty);
        field.update_textures(Budget::per_frame(256), &mut |region, bytes| {
            copies.write(region, bytes);
        });
        copies.check_cells(false);
    }
    dirty.clear();
    (0..5).for_each(|_| studio.apply_random_edit(&mut dice, &mut dirty));
    field.note_dirty_columns(studio.volume.maps(), &dirty);
    while field.has_pending() {
        field.update_textures(Budget::UNLIMITED, &mut |region, bytes| copies.write(region, bytes));
    }
    copies.check_cells(true);
    fresh.rebuild_from(studio.volume.maps());
    assert!(TextureCopies::of(&fresh).0 == copies.0);
}
