//! Octree rasterization of a signed distance function into bit rows: a block whose centre is farther
//! from the surface than its corners is filled or left empty as a whole.

use glam::Vec3;
use paros_core::{BitGrid, BitSet, Grid, Size};

/// Lipschitz bound of the fields: the most that one may change over a unit. More than 1 allows for
/// reliefs.
const STEEPEST: f32 = 2.0;

/// Units along an edge of the box.
const EDGE: f32 = 128.0;

/// The centre of a cube of `size` voxels whose lowest is `corner`, in units: x and z from the
/// middle of the box, y from the ground.
pub(super) fn cube_centre<const N: usize>([x, y, z]: [usize; 3], size: usize) -> Vec3 {
    let unit = EDGE / N as f32;
    let middle = |i: usize| (i as f32 + size as f32 * 0.5) * unit;
    Vec3::new(middle(x) - EDGE * 0.5, middle(y), middle(z) - EDGE * 0.5)
}

/// Sets `plane` to the voxels at whose centres `field` is at most zero.
pub(super) fn rasterize<const N: usize>(plane: &mut BitGrid<N>, field: &impl Fn(Vec3) -> f32)
where
    Grid<N>: Size,
{
    plane.clear();
    fill_block(plane, field, [0; 3], N);
}

fn fill_block<const N: usize>(
    plane: &mut BitGrid<N>,
    field: &impl Fn(Vec3) -> f32,
    corner: [usize; 3],
    size: usize,
) where
    Grid<N>: Size,
{
    let distance = field(cube_centre::<N>(corner, size));
    // From the centre to the farthest voxel centre in the block: half its diagonal.
    let reach = STEEPEST * 0.866_026 * (size - 1) as f32 * (EDGE / N as f32);
    if distance > reach {
        return;
    }
    let [x, y, z] = corner;
    if distance <= -reach {
        let run = <Grid<N> as Size>::Row::span(x, x + size - 1);
        for y in y..y + size {
            for row in &mut plane.layer_mut(y)[z..z + size] {
                *row |= run;
            }
        }
        return;
    }
    let half = size / 2;
    for child in 0..8 {
        let step = |bit: usize| (child >> bit & 1) * half;
        fill_block(plane, field, [x + step(0), y + step(1), z + step(2)], half);
    }
}
