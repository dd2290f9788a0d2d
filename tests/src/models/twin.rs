//! The twin's march, normal and projection in f64, voxel by voxel.

use std::sync::Mutex;

use glam::Vec3;
use paros_core::maps::Maps;

use crate::models::dense::{Dense, SIX};

static MAPS_16: Mutex<Maps<16>> = Mutex::new(Maps::new());
static MAPS_64: Mutex<Maps<64>> = Mutex::new(Maps::new());

/// The middle of the ball of [`with_ball`], in voxels.
pub const BALL: Vec3 = Vec3::new(32.0, 31.5, 32.25);
/// Its radius, in voxels.
pub const BALL_RADIUS: f32 = 24.0;

/// Calls with the maps of a volume.
pub fn with_16<T>(dense: &Dense, f: impl FnOnce(&Maps<16>) -> T) -> T {
    let mut maps = MAPS_16.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    dense.write_maps(&mut maps);
    f(&maps)
}

/// Calls with the maps of a ball.
pub fn with_ball<T>(f: impl FnOnce(&Maps<64>) -> T) -> T {
    let mut maps = MAPS_64.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    Dense::from_fn(64, |voxel| (centre(voxel) - BALL).length() <= BALL_RADIUS)
        .write_maps(&mut maps);
    f(&maps)
}

/// A voxel's centre.
pub fn centre(voxel: [i32; 3]) -> Vec3 {
    Vec3::from_array(voxel.map(|c| c as f32 + 0.5))
}

/// Directions along the six axes, the edges and the corners of a cube, and between.
pub fn directions() -> Vec<Vec3> {
    let ends = [-1.0, -0.35, 0.0, 0.35, 1.0];
    let all =
        ends.iter().flat_map(|&x| ends.iter().flat_map(move |&y| ends.map(|z| Vec3::new(x, y, z))));
    all.filter_map(Vec3::try_normalize).collect()
}

/// What the samples of a ray must find: the first that is surely in an occupied voxel, and those
/// before it that rounding may put into one.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Found {
    /// Distance of the first sample whose place is occupied whichever way it is rounded.
    pub sure: Option<f64>,
    /// Distances of samples before it that are occupied in one rounding and not in another.
    pub doubtful: Vec<f64>,
}

/// Looks up the sample in the middle of every layer of the direction's longest axis.
#[must_use]
pub fn march(dense: &Dense, origin: [f64; 3], direction: [f64; 3]) -> Found {
    const DOUBT: f64 = 1e-3;
    let n = dense.n();
    let mut axis = 0;
    for i in 1..3 {
        if direction[i].abs() > direction[axis].abs() {
            axis = i;
        }
    }
    let mut samples: Vec<f64> =
        (0..n).map(|layer| (layer as f64 + 0.5 - origin[axis]) / direction[axis]).collect();
    samples.sort_by(f64::total_cmp);
    let mut found = Found::default();
    for t in samples.into_iter().filter(|&t| t > -DOUBT) {
        let place: [f64; 3] = std::array::from_fn(|i| origin[i] + t * direction[i]);
        let all = (0..8).map(|corner| {
            let shift = |i: usize| if corner >> i & 1 == 0 { -DOUBT } else { DOUBT };
            dense.contains(std::array::from_fn(|i| (place[i] + shift(i)).floor() as i32))
        });
        let occupied = all.filter(|&occupied| occupied).count();
        if occupied == 8 && t > DOUBT {
            found.sure = Some(t);
            break;
        }
        if occupied > 0 {
            found.doubtful.push(t);
        }
    }
    found
}

/// Equation 1 of the paper at a place near the voxel that was hit, before it is made a unit vector.
#[must_use]
pub fn normal_sum(dense: &Dense, voxel: [i32; 3], place: [f64; 3]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for step in SIX {
        let neighbour: [i32; 3] = std::array::from_fn(|i| voxel[i] + step[i]);
        if dense.contains(neighbour) {
            let from: [f64; 3] =
                std::array::from_fn(|i| place[i] - (f64::from(neighbour[i]) + 0.5));
            let square: f64 = from.iter().map(|c| c * c).sum();
            (0..3).for_each(|i| sum[i] += from[i] / square);
        }
    }
    sum
}

/// The integral over all directions of a function, by the midpoint rule.
#[must_use]
pub fn over_sphere(mut f: impl FnMut([f64; 3]) -> f64) -> f64 {
    const RINGS: u32 = 200;
    let step = std::f64::consts::PI / f64::from(RINGS);
    let mut sum = 0.0;
    for ring in 0..RINGS {
        let (sin, cos) = ((f64::from(ring) + 0.5) * step).sin_cos();
        for part in 0..2 * RINGS {
            let (s, c) = ((f64::from(part) + 0.5) * step).sin_cos();
            sum += f([sin * c, sin * s, cos]) * sin * step * step;
        }
    }
    sum
}
