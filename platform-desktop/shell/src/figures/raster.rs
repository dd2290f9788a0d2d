//! Fills bit rows from a signed-distance field, eight blocks at a time: a block farther from the
//! surface than its corners is settled whole by its centre.

use glam::Vec3;
use paros_core::plane::Plane;
use paros_core::row::Bits;
use paros_core::size::{Grid, Size};

/// The most by which a field may change over a unit. The slack over 1 is for reliefs.
const STEEPEST: f32 = 2.0;

/// Units along an edge of the box.
const EDGE: f32 = 128.0;

/// The centre of a cube of `size` voxels whose lowest is `corner`, in units: x and z from the
/// middle of the box, y from the ground.
pub(super) fn centre<const N: usize>([x, y, z]: [usize; 3], size: usize) -> Vec3 {
    let unit = EDGE / N as f32;
    let middle = |i: usize| (i as f32 + size as f32 * 0.5) * unit;
    Vec3::new(middle(x) - EDGE * 0.5, middle(y), middle(z) - EDGE * 0.5)
}

/// Becomes the voxels whose centres are where `field` is at most zero.
pub(super) fn fill<const N: usize>(plane: &mut Plane<N>, field: &impl Fn(Vec3) -> f32)
where
    Grid<N>: Size,
{
    plane.clear();
    settle(plane, field, [0; 3], N);
}

fn settle<const N: usize>(
    plane: &mut Plane<N>,
    field: &impl Fn(Vec3) -> f32,
    corner: [usize; 3],
    size: usize,
) where
    Grid<N>: Size,
{
    let distance = field(centre::<N>(corner, size));
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
        settle(plane, field, [x + step(0), y + step(1), z + step(2)], half);
    }
}
