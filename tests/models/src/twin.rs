//! Model of the CPU twin's renderer by naive definitions in f64: ray march by layers, normal, and integral
//! over the sphere.

use std::sync::Mutex;

use glam::Vec3;
use paros_core::RangeMaps;

use crate::dense::{DenseVolume, NEIGHBOUR_STEPS};

static MAPS_16: Mutex<RangeMaps<16>> = Mutex::new(RangeMaps::new());
static MAPS_64: Mutex<RangeMaps<64>> = Mutex::new(RangeMaps::new());

/// The centre of the ball of [`with_maps_of_ball`], in voxels.
pub const BALL_CENTRE: Vec3 = Vec3::new(32.0, 31.5, 32.25);
/// The radius of that ball, in voxels.
pub const BALL_RADIUS: f32 = 24.0;

/// Calls `f` with the maps of a volume of 16^3 voxels.
pub fn with_maps_of_16<T>(dense: &DenseVolume, f: impl FnOnce(&RangeMaps<16>) -> T) -> T {
    let mut maps = MAPS_16.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    dense.write_maps(&mut maps);
    f(&maps)
}

/// Calls `f` with the maps of a ball in a grid of 64^3 voxels.
pub fn with_maps_of_ball<T>(f: impl FnOnce(&RangeMaps<64>) -> T) -> T {
    let mut maps = MAPS_64.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    DenseVolume::from_fn(64, |voxel| (voxel_centre(voxel) - BALL_CENTRE).length() <= BALL_RADIUS)
        .write_maps(&mut maps);
    f(&maps)
}

/// Returns a voxel's centre, in voxels.
pub fn voxel_centre(voxel: [i32; 3]) -> Vec3 {
    Vec3::from_array(voxel.map(|c| c as f32 + 0.5))
}

/// Returns directions along the six axes, the edges and the corners of a cube, and between.
pub fn sample_directions() -> Vec<Vec3> {
    let ends = [-1.0, -0.35, 0.0, 0.35, 1.0];
    let all =
        ends.iter().flat_map(|&x| ends.iter().flat_map(move |&y| ends.map(|z| Vec3::new(x, y, z))));
    all.filter_map(Vec3::try_normalize).collect()
}

/// The samples of a ray that a march may return: the first sample that is certainly in an occupied voxel, and
/// earlier samples that rounding may put into an occupied voxel.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct PossibleHits {
    /// The distance of the first sample whose voxel is occupied however its position is rounded.
    pub sure: Option<f64>,
    /// The distances of samples before it whose voxel is occupied under some roundings only.
    pub doubtful: Vec<f64>,
}

/// Samples a ray at the middle of every layer of the direction's longest axis.
#[must_use]
pub fn possible_hits_at_layer_middles(
    dense: &DenseVolume,
    origin: [f64; 3],
    direction: [f64; 3],
) -> PossibleHits {
    const DOUBT: f64 = 1e-3;
    let n = dense.side();
    let mut axis = 0;
    for i in 1..3 {
        if direction[i].abs() > direction[axis].abs() {
            axis = i;
        }
    }
    let mut samples: Vec<f64> =
        (0..n).map(|layer| (layer as f64 + 0.5 - origin[axis]) / direction[axis]).collect();
    samples.sort_by(f64::total_cmp);
    let mut found = PossibleHits::default();
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

/// Returns the normal by equation 1 of the paper at a point near the hit voxel, before normalisation.
#[must_use]
pub fn unnormalised_normal(dense: &DenseVolume, hit_voxel: [i32; 3], point: [f64; 3]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for step in NEIGHBOUR_STEPS {
        let neighbour: [i32; 3] = std::array::from_fn(|i| hit_voxel[i] + step[i]);
        if dense.contains(neighbour) {
            let from: [f64; 3] =
                std::array::from_fn(|i| point[i] - (f64::from(neighbour[i]) + 0.5));
            let square: f64 = from.iter().map(|c| c * c).sum();
            (0..3).for_each(|i| sum[i] += from[i] / square);
        }
    }
    sum
}

/// Returns the integral of a function over the unit sphere, by the midpoint rule.
#[must_use]
pub fn integrate_over_sphere(mut f: impl FnMut([f64; 3]) -> f64) -> f64 {
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
