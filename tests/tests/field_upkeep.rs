//! The fast path's textures, kept up to date while the volume changes, against a rebuild from
//! nothing, with a copy that only sees what is handed out.

use std::sync::{Mutex, PoisonError};

use glam::IVec3;
use paros_core::brush::Brush;
use paros_core::dirty::Dirty;
use paros_core::edit::{Edit, EditScratch, Operation, apply};
use paros_core::maps::{Axis, Maps};
use paros_core::pose::SUB;
use paros_core::size::{Grid, Size};
use paros_core::volume::Volume;
use paros_shaders::field::{Budget, FAR, Field, HALF, LEVELS};
use paros_shaders::upload::{Region, Texture};
use paros_tests::models::visitor::Dice;

/// A texture's bytes, and how many make a texel.
#[derive(PartialEq)]
struct Copy {
    side: [usize; 2],
    texel: usize,
    bytes: Vec<u8>,
}

/// The textures as a GPU has them that is told of every region.
struct Copies(Vec<Copy>);

impl Copies {
    fn of<const N: usize>(field: &Field<N>) -> Self {
        let cube = |side: usize| Copy { side: [side; 2], texel: 1, bytes: vec![99; side.pow(3)] };
        let mut copies = vec![Copy { side: [N; 2], texel: 2, bytes: vec![99; 3 * N * N * 2] }];
        copies.extend((0..LEVELS).map(|level| cube(field.side(level))));
        copies.push(cube(field.cells_side()));
        let mut copies = Copies(copies);
        field.whole(|region, bytes| copies.write(region, bytes));
        copies
    }

    fn write(&mut self, region: Region, bytes: &[u8]) {
        assert!(region.size.iter().all(|&side| side > 0), "{region:?}");
        assert_eq!(bytes.len(), region.bytes(), "{region:?}");
        let copy = &mut self.0[match region.texture {
            Texture::Maps => 0,
            Texture::Density(level) => 1 + usize::from(level),
            Texture::Cells => 1 + LEVELS,
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

    /// No surface passes through the cells that one tells are free.
    fn check_cells(&self, settled: bool) {
        let (density, cells) = (&self.0[1], &self.0[1 + LEVELS]);
        let (texels, side) = (density.side[0], cells.side[0]);
        let size = texels / side;
        let mut solid = vec![FAR; side.pow(3)];
        for (i, _) in density.bytes.iter().enumerate().filter(|(_, texel)| **texel >= HALF) {
            let at = [i % texels, i / texels % texels, i / (texels * texels)];
            let beside = |c: usize| c.saturating_sub(1) / size..=((c + 1) / size).min(side - 1);
            for z in beside(at[2]) {
                for y in beside(at[1]) {
                    beside(at[0]).for_each(|x| solid[(z * side + y) * side + x] = 0);
                }
            }
        }
        // Step by step, a cell at a time.
        for distance in 0..FAR {
            let last = solid.clone();
            for (i, _) in last.iter().enumerate().filter(|(_, d)| **d == distance) {
                let at = [i % side, i / side % side, i / (side * side)];
                let beside = |c: usize| c.saturating_sub(1)..=(c + 1).min(side - 1);
                for z in beside(at[2]) {
                    for y in beside(at[1]) {
                        for x in beside(at[0]) {
                            let near = &mut solid[(z * side + y) * side + x];
                            *near = (*near).min(distance + 1);
                        }
                    }
                }
            }
        }
        let free: Vec<u8> = solid.iter().map(|distance| distance.saturating_sub(1)).collect();
        for (right, told) in free.iter().zip(&cells.bytes) {
            assert!(told <= right, "{told} told, it is {right}");
        }
        assert!(!settled || free == cells.bytes, "cells are not right for the density");
    }
}

/// A volume that random edits, undos and loads change.
struct Studio<const N: usize>
where
    Grid<N>: Size,
{
    volume: Volume<N>,
    mask: Maps<N>,
    scratch: EditScratch<N>,
    earlier: Maps<N>,
    edits: u32,
}

impl<const N: usize> Studio<N>
where
    Grid<N>: Size,
{
    const fn new() -> Self {
        Studio {
            volume: Volume::new(),
            mask: Maps::new(),
            scratch: EditScratch::new(),
            earlier: Maps::new(),
            edits: 0,
        }
    }

    /// One tick: mostly an edit or two, now and then an undo, seldom a load.
    fn tick(&mut self, dice: &mut Dice, dirty: &mut Dirty) {
        dirty.clear();
        match dice.roll(60) {
            0 => self.load(dice, dirty),
            1..4 => self.swap(dirty),
            4..8 => self.earlier.copy_from(self.volume.maps()),
            _ => (0..=dice.roll(2)).for_each(|_| self.edit(dice, dirty)),
        }
    }

    fn edit(&mut self, dice: &mut Dice, dirty: &mut Dirty) {
        let n = N as u64;
        let at = [0; 3].map(|_| (dice.roll(n) as i32) * SUB + dice.roll(SUB as u64) as i32);
        let most = if dice.one_in(8) { n / 4 } else { n / 10 };
        let radius = dice.roll(most * SUB as u64) as i32;
        let brush = Brush::sphere(IVec3::from_array(at), radius);
        let operation = [
            Operation::Carve { depth: 4 },
            Operation::Carve { depth: 2 },
            Operation::Fill { depth: 3 },
            Operation::Smooth,
        ][dice.roll(4) as usize];
        let edit = Edit { brush: &brush, operation, mirrored: dice.one_in(4) };
        let log = &mut *dirty;
        // A ball that is too large to smooth changes nothing.
        let _ = apply(&mut self.volume, &self.mask, &edit, &mut self.scratch, log);
        dirty.close();
        self.edits += 1;
    }

    /// The volume as it was, noted as an undo is: column by column.
    fn swap(&mut self, dirty: &mut Dirty) {
        let before = Box::new(self.volume.maps().clone());
        self.volume.set_maps(&self.earlier);
        for axis in Axis::ALL {
            for at in (0..N * N).map(|i| (i / N, i % N)) {
                if before.column(axis, at) != self.earlier.column(axis, at) {
                    dirty.note(axis, at);
                }
            }
        }
        dirty.close();
        self.earlier.copy_from(&before);
    }

    fn load(&mut self, dice: &mut Dice, dirty: &mut Dirty) {
        let kind = dice.roll(4);
        let n = N as i32;
        let balls = [0; 3]
            .map(|_| ([0; 3].map(|_| dice.roll(N as u64) as i32), dice.roll(N as u64 / 2) as i32));
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
                        _ => balls.iter().any(in_ball),
                    };
                    if full {
                        use paros_core::row::Bits;
                        plane.row_mut(y, z).insert(x);
                    }
                }
            }
        });
        dirty.note_all(N);
    }
}

fn follow<const N: usize>(studio: &mut Studio<N>, seed: u64, ticks: u32)
where
    Grid<N>: Size,
{
    let mut dice = Dice::new(seed);
    let mut dirty = Dirty::new();
    let mut field = Field::<N>::new();
    let mut fresh = Field::<N>::new();
    let mut copies = Copies::of(&field);
    let (mut settled, mut frames) = (0, 0);
    studio.load(&mut dice, &mut dirty);
    field.note(studio.volume.maps(), &dirty);
    for tick in 0..ticks {
        studio.tick(&mut dice, &mut dirty);
        field.note(studio.volume.maps(), &dirty);
        if dice.one_in(4) {
            continue;
        }
        // Now and then there is time to get done.
        for _ in 0..[1, 1, 1, 500][dice.roll(4) as usize] {
            let budget =
                Budget { work: dice.roll(400_000) as usize, bytes: dice.roll(100_000) as usize };
            field.advance(budget, &mut |region, bytes| copies.write(region, bytes));
            frames += 1;
            if tick % 8 == 0 {
                // Maps may wait for another frame.
                let told = copies.0[1..] == Copies::of(&field).0[1..];
                assert!(told, "tick {tick}: a change is not told");
                copies.check_cells(!field.pending());
            }
            if !field.pending() {
                break;
            }
        }
        assert!(field.latest() == studio.volume.maps());
        if !field.pending() {
            settled += 1;
            fresh.rebuild(studio.volume.maps());
            let fresh = Copies::of(&fresh).0;
            assert!(fresh == copies.0, "tick {tick}: not what a rebuild gives");
        }
    }
    println!("{frames} frames, {settled} times settled, {} edits", studio.edits);
    assert!(settled > ticks / 20 && frames > settled);
}

#[test]
fn upkeep_is_a_rebuild_on_16() {
    static STUDIO: Mutex<Studio<16>> = Mutex::new(Studio::new());
    let mut studio = STUDIO.lock().unwrap_or_else(PoisonError::into_inner);
    (0..6).for_each(|seed| follow(&mut studio, seed, 600));
}

#[test]
fn upkeep_is_a_rebuild_on_64() {
    static STUDIO: Mutex<Studio<64>> = Mutex::new(Studio::new());
    let mut studio = STUDIO.lock().unwrap_or_else(PoisonError::into_inner);
    (0..2).for_each(|seed| follow(&mut studio, 40 + seed, 400));
}

#[test]
fn upkeep_is_a_rebuild_on_128() {
    static STUDIO: Mutex<Studio<128>> = Mutex::new(Studio::new());
    let mut studio = STUDIO.lock().unwrap_or_else(PoisonError::into_inner);
    follow(&mut studio, 70, 60);
}

/// What a frame costs and hands out is within its budget, and a load comes to its end.
#[test]
fn frames_keep_to_their_budget() {
    static STUDIO: Mutex<Studio<128>> = Mutex::new(Studio::new());
    let mut studio = STUDIO.lock().unwrap_or_else(PoisonError::into_inner);
    let (mut dice, mut dirty) = (Dice::new(5), Dirty::new());
    let mut field = Field::<128>::new();
    let budget = Budget::frame(128);
    for tick in 0..400 {
        dirty.clear();
        match tick % 200 {
            0 => studio.load(&mut dice, &mut dirty),
            180 => studio.swap(&mut dirty),
            _ if dice.one_in(2) => studio.edit(&mut dice, &mut dirty),
            _ => {}
        }
        field.note(studio.volume.maps(), &dirty);
        let mut bytes = 0;
        let spent = field.advance(budget, &mut |_, region| bytes += region.len());
        assert!(bytes <= budget.bytes, "tick {tick}: {bytes} bytes");
        // A frame does one thing at least: a box of nothing but detail is reckoned at a fifth more.
        assert!(spent.work <= budget.work * 6 / 5, "tick {tick}: {spent:?}");
        assert_eq!(spent.bytes, bytes, "tick {tick}");
    }
    let frames = (0..600).take_while(|_| {
        field.advance(budget, &mut |_, _| {});
        field.pending()
    });
    assert!(frames.count() < 400, "never done");
}

/// Cells of four texels.
#[test]
fn cells_at_256() {
    static STUDIO: Mutex<Studio<256>> = Mutex::new(Studio::new());
    let mut studio = STUDIO.lock().unwrap_or_else(PoisonError::into_inner);
    let (mut dice, mut dirty) = (Dice::new(6), Dirty::new());
    let (mut field, mut fresh) = (Field::<256>::new(), Field::<256>::new());
    let mut copies = Copies::of(&field);
    for _ in 0..3 {
        dirty.clear();
        studio.load(&mut dice, &mut dirty);
        field.note(studio.volume.maps(), &dirty);
        field.advance(Budget::frame(256), &mut |region, bytes| copies.write(region, bytes));
        copies.check_cells(false);
    }
    dirty.clear();
    (0..5).for_each(|_| studio.edit(&mut dice, &mut dirty));
    field.note(studio.volume.maps(), &dirty);
    while field.pending() {
        field.advance(Budget::UNLIMITED, &mut |region, bytes| copies.write(region, bytes));
    }
    copies.check_cells(true);
    fresh.rebuild(studio.volume.maps());
    assert!(Copies::of(&fresh).0 == copies.0);
}
