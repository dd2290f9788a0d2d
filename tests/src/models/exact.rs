//! The voxel that a ray meets first, walked from one voxel to the next.
//!
//! Source: Amanatides and Woo, "A Fast Voxel Traversal Algorithm for Ray Tracing" (1987), without
//! the sums that drift: each plane's distance is computed by itself.

use super::dense::Dense;

/// A voxel that a ray enters.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Entry {
    /// It is occupied.
    pub voxel: [i32; 3],
    /// The one that the ray leaves, empty or outside of the grid.
    pub before: [i32; 3],
    /// Distance from the ray's origin, in voxels.
    pub distance: f64,
}

/// The first occupied voxel on a ray in voxels, its direction of unit length; its origin lies
/// outside of the grid.
pub fn first(dense: &Dense, origin: [f64; 3], direction: [f64; 3]) -> Option<Entry> {
    let n = dense.n() as f64;
    let (mut distance, mut side, mut far) = (0.0f64, 0, f64::INFINITY);
    for axis in 0..3 {
        let (a, b) = (-origin[axis] / direction[axis], (n - origin[axis]) / direction[axis]);
        // Parallel to the planes: infinities of one sign outside of them, of both between them.
        if a.min(b) > distance {
            (distance, side) = (a.min(b), axis);
        }
        far = far.min(a.max(b));
    }
    if distance >= far {
        return None;
    }
    let mut voxel = [0, 1, 2].map(|axis| {
        let place = origin[axis] + direction[axis] * distance;
        (place.floor() as i32).clamp(0, dense.n() as i32 - 1)
    });
    let mut before = voxel;
    before[side] -= towards(direction[side]);
    loop {
        if dense.contains(voxel) {
            return Some(Entry { voxel, before, distance });
        }
        // The nearest plane ahead.
        let leaves = [0, 1, 2].map(|axis| {
            let plane = voxel[axis] + i32::from(direction[axis] > 0.0);
            match direction[axis] {
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
        voxel[axis] += towards(direction[axis]);
        if !(0..dense.n() as i32).contains(&voxel[axis]) {
            return None;
        }
    }
}

fn towards(direction: f64) -> i32 {
    if direction > 0.0 { 1 } else { -1 }
}
