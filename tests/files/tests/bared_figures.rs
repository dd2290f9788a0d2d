//! The share of the hidden figures that can be bared: the column ends that show once a ball of 15 mm has
//! removed everything that it reaches from above.

use std::sync::{Mutex, PoisonError};

use paros_core::session::SessionMode;
use paros_core::volume::{BitGrid, BitSet, Grid, Size};
use paros_core::{RangeMaps, TickInput};
use paros_models::dense::DenseVolume;
use paros_models::world_harness::WorldHarness;
use paros_shell::figures::Figure;

const SIDE: usize = 128;
/// Points along a side of the lattice of positions for the ball's centre: two a voxel.
const POINTS: usize = 2 * SIDE;
/// The radius of the ball in steps of the lattice: the stone's box is 450 mm wide.
const RADIUS: f64 = 15.0 / 450.0 * POINTS as f64;

static HARNESS: Mutex<WorldHarness<SIDE, 2>> = Mutex::new(WorldHarness::new());

type Row = <Grid<POINTS> as Size>::Row;

/// A set of lattice points: rows along x, by y and z.
type Lattice = Box<BitGrid<POINTS>>;

/// Returns the rows of the lattice, by y and z.
fn all_rows() -> impl Iterator<Item = (usize, usize)> {
    (0..POINTS * POINTS).map(|i| (i / POINTS, i % POINTS))
}

/// Returns the rows adjacent to a row, by y and z.
fn rows_beside(y: usize, z: usize) -> impl Iterator<Item = (usize, usize)> {
    let beside = [(y + 1, z), (y.wrapping_sub(1), z), (y, z + 1), (y, z.wrapping_sub(1))];
    beside.into_iter().filter(|&(y, z)| y < POINTS && z < POINTS)
}

/// Returns the lattice point at a voxel's centre.
fn point_of([x, y, z]: [i32; 3]) -> [usize; 3] {
    [x, y, z].map(|i| 2 * i as usize + 1)
}

/// Returns the points within the ball's radius of a set: a union of balls, which are unions of rows.
fn within_radius(points: &Lattice) -> Lattice {
    // Maps each half length to the offsets (y, z) of the ball's rows with that half length.
    let most = (RADIUS * RADIUS) as usize;
    let reach = most.isqrt();
    let mut offsets = vec![Vec::new(); reach + 1];
    for (y, z) in (0..=2 * reach).flat_map(|y| (0..=2 * reach).map(move |z| (y, z))) {
        let squared = y.abs_diff(reach).pow(2) + z.abs_diff(reach).pow(2);
        if let Some(rest) = most.checked_sub(squared) {
            offsets[rest.isqrt()].push((y, z));
        }
    }
    let mut within: Lattice = Box::new(BitGrid::new());
    for (y, z) in all_rows() {
        let mut row = points.row(y, z);
        if row.is_empty() {
            continue;
        }
        for of_length in &offsets {
            for (down, aside) in of_length {
                let at = [y + down, z + aside].map(|i| i.wrapping_sub(reach));
                if at.iter().all(|&i| i < POINTS) {
                    *within.row_mut(at[0], at[1]) |= row;
                }
            }
            row |= row.shifted_up() | row.shifted_down();
        }
    }
    within
}

/// Returns the free points connected to free points of the top layer by steps between free points.
fn reach_from_above(is_free: impl Fn(usize, usize) -> Row) -> Lattice {
    let mut reached: Lattice = Box::new(BitGrid::new());
    let top = POINTS - 1;
    (0..POINTS).for_each(|z| *reached.row_mut(top, z) = is_free(top, z));
    let mut has_grown = true;
    while has_grown {
        has_grown = false;
        for (y, z) in all_rows().map(|(y, z)| (top - y, z)).chain(all_rows()) {
            let row = reached.row(y, z);
            let seeds = rows_beside(y, z).fold(row, |all, (y, z)| all | reached.row(y, z));
            let grown = is_free(y, z).flood_from(seeds);
            if grown != row {
                *reached.row_mut(y, z) = grown;
                has_grown = true;
            }
        }
    }
    reached
}

/// Returns the points of a set that are adjacent to a point outside it, and those at the ends of rows.
fn boundary_of(points: &Lattice) -> Lattice {
    let mut boundary: Lattice = Box::new(BitGrid::new());
    for (y, z) in all_rows() {
        let row = points.row(y, z);
        let along = row.shifted_up() & row.shifted_down();
        let inner = rows_beside(y, z).fold(along, |all, (y, z)| all & points.row(y, z));
        *boundary.row_mut(y, z) = row & !inner;
    }
    boundary
}

/// Returns the rest of a block after a ball has removed everything that it can reach without touching the
/// figure.
fn carve_with_ball(figure: &DenseVolume) -> DenseVolume {
    let mut points: Lattice = Box::new(BitGrid::new());
    for [x, y, z] in figure.occupied().map(point_of) {
        points.row_mut(y, z).insert(x);
    }
    let taken = within_radius(&points);
    let reached = reach_from_above(|y, z| !taken.row(y, z));
    // The reached point that is nearest to an unreached point lies on the boundary.
    let carved = within_radius(&boundary_of(&reached));
    let is_left = |point| !reached.contains(point) && !carved.contains(point);
    DenseVolume::from_fn(SIDE, |voxel| is_left(point_of(voxel)))
}

/// The least bared share, in percent: the rest lies in hollows too narrow for the ball.
const LEAST_PERCENT: u32 = 97;

#[test]
fn a_ball_bares_most_of_each_figure() {
    let mut harness = HARNESS.lock().unwrap_or_else(PoisonError::into_inner);
    let (mut maps, mut bits) = (Box::new(RangeMaps::<SIDE, 2>::new()), Box::new(BitGrid::new()));
    for figure in Figure::HIDDEN {
        figure.rasterize_into(&mut *maps, &mut *bits);
        let shape = DenseVolume::from_bits(&bits);
        harness.reset_to_voxels(&carve_with_ball(&shape.closure()), &shape);
        let start = SessionMode::Constrained { figure: 0 };
        harness.step(&TickInput { start, ..TickInput::default() });
        (0..3).for_each(|_| harness.step(&TickInput::default()));
        let ends = harness.world.bared_ends();
        assert!(ends.percent() >= LEAST_PERCENT, "{figure:?}: {} %, {ends:?}", ends.percent());
    }
}
