//! Octree rasterization of a signed distance function into bit rows: a block whose centre is farther from the
//! surface than its corners are from its centre is filled or left empty as a whole.

use glam::Vec3;
use paros_core::volume::{BitGrid, BitSet, Grid, Size};

/// Lipschitz bound of the distance functions: their greatest change over a unit. It is above 1 to allow for
/// reliefs.
const STEEPEST: f32 = 2.0;

/// The edge of the box in units.
const EDGE: f32 = 128.0;

/// Returns the centre of a cube of `edge_voxels` voxels a side from `lowest_voxel` on, in units: x and z from
/// the middle of the box, y from the ground.
pub(super) fn block_centre<const N: usize>(lowest_voxel: [usize; 3], edge_voxels: usize) -> Vec3 {
    let [x, y, z] = lowest_voxel;
    let unit = EDGE / N as f32;
    let middle = |i: usize| (i as f32 + edge_voxels as f32 * 0.5) * unit;
    Vec3::new(middle(x) - EDGE * 0.5, middle(y), middle(z) - EDGE * 0.5)
}

/// Sets `bit_grid` to the voxels at whose centres `signed_distance` is at most zero.
pub(super) fn rasterize<const N: usize>(
    bit_grid: &mut BitGrid<N>,
    signed_distance: &impl Fn(Vec3) -> f32,
) where
    Grid<N>: Size,
{
    for y in 0..N {
        bit_grid.layer_mut(y).fill(<Grid<N> as Size>::Row::span(0, N - 1));
    }
    keep_within(bit_grid, signed_distance);
}

/// Clears the voxels of `bit_grid` at whose centres `signed_distance` is above zero.
pub(super) fn keep_within<const N: usize>(
    bit_grid: &mut BitGrid<N>,
    signed_distance: &impl Fn(Vec3) -> f32,
) where
    Grid<N>: Size,
{
    clear_outside(bit_grid, signed_distance, [0; 3], N);
}

fn clear_outside<const N: usize>(
    bit_grid: &mut BitGrid<N>,
    signed_distance: &impl Fn(Vec3) -> f32,
    lowest_voxel: [usize; 3],
    edge_voxels: usize,
) where
    Grid<N>: Size,
{
    let [x, y, z] = lowest_voxel;
    let run = <Grid<N> as Size>::Row::span(x, x + edge_voxels - 1);
    let mut layers = y..y + edge_voxels;
    if layers
        .all(|y| bit_grid.layer(y)[z..z + edge_voxels].iter().all(|&row| (row & run).is_empty()))
    {
        return;
    }
    let distance = signed_distance(block_centre::<N>(lowest_voxel, edge_voxels));
    // From the centre to the farthest voxel centre in the block: half its diagonal.
    let reach = STEEPEST * 0.866_026 * (edge_voxels - 1) as f32 * (EDGE / N as f32);
    if distance > reach {
        for y in y..y + edge_voxels {
            for row in &mut bit_grid.layer_mut(y)[z..z + edge_voxels] {
                *row &= !run;
            }
        }
        return;
    }
    if distance <= -reach {
        return;
    }
    let half = edge_voxels / 2;
    for child in 0..8 {
        let step = |bit: usize| (child >> bit & 1) * half;
        clear_outside(bit_grid, signed_distance, [x + step(0), y + step(1), z + step(2)], half);
    }
}
