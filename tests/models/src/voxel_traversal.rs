//! Model of ray casting in its naive form: voxel traversal from one voxel to the next, where every plane's
//! distance is computed independently, so that no sum drifts.
//!
//! Source: Amanatides and Woo, "A Fast Voxel Traversal Algorithm for Ray Tracing" (1987).

use crate::dense::DenseVolume;

/// The entry of a ray into a voxel.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct VoxelEntry {
    /// The voxel, which is occupied.
    pub voxel: [i32; 3],
    /// The voxel that the ray leaves, empty or outside the grid.
    pub before: [i32; 3],
    /// Distance from the ray's origin, in voxels.
    pub distance: f64,
}

/// Returns the first occupied voxel on a ray. Origin and direction are in voxels; the origin lies outside the
/// grid.
pub fn find_first_occupied(
    dense: &DenseVolume,
    origin: [f64; 3],
    unit_direction: [f64; 3],
) -> Option<VoxelEntry> {
    let n = dense.side() as f64;
    let (mut distance, mut side, mut far) = (0.0f64, 0, f64::INFINITY);
    for axis in 0..3 {
        let (a, b) =
            (-origin[axis] / unit_direction[axis], (n - origin[axis]) / unit_direction[axis]);
        // Parallel to the planes: infinities of equal sign outside them, of both signs between them.
        if a.min(b) > distance {
            (distance, side) = (a.min(b), axis);
        }
        far = far.min(a.max(b));
    }
    if distance >= far {
        return None;
    }
    let mut voxel = [0, 1, 2].map(|axis| {
        let place = origin[axis] + unit_direction[axis] * distance;
        (place.floor() as i32).clamp(0, dense.side() as i32 - 1)
    });
    let mut before = voxel;
    before[side] -= step_along(unit_direction[side]);
    loop {
        if dense.contains(voxel) {
            return Some(VoxelEntry { voxel, before, distance });
        }
        // The nearest plane ahead.
        let leaves = [0, 1, 2].map(|axis| {
            let plane = voxel[axis] + i32::from(unit_direction[axis] > 0.0);
            match unit_direction[axis] {
                0.0 => f64::INFINITY,
                along => (f64::from(plane) - origin[axis]) / along,
            }
        });
        let mut axis = 0;
        for other in 1..3 {
            if leaves[other] < leaves[axis] {
                axis = other;
            }
        }
        distance = leaves[axis];
        before = voxel;
        voxel[axis] += step_along(unit_direction[axis]);
        if !(0..dense.side() as i32).contains(&voxel[axis]) {
            return None;
        }
    }
}

fn step_along(direction: f64) -> i32 {
    if direction > 0.0 { 1 } else { -1 }
}
