//! Ray casting into the volume, and surface normals.

use glam::Vec3;
use paros_core::RangeMaps;
use paros_shaders::Ray;
use paros_shaders::march::{RaySpan, clip_to_cube};

/// The point at which a ray enters an occupied voxel.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct CursorHit {
    /// Distance from the ray's origin, in voxels.
    pub(super) distance_voxels: f32,
    /// The voxel.
    pub(super) voxel: [usize; 3],
}

/// Finds the first occupied voxel along a ray by voxel traversal (Amanatides and Woo, 1987). The ray's origin
/// is in voxels, its direction a unit vector.
#[must_use]
pub(super) fn cast_ray<const N: usize, const K: usize>(
    maps: &RangeMaps<N, K>,
    grid_ray: &Ray,
) -> Option<CursorHit> {
    let RaySpan { near: enter, far: leave } = clip_to_cube(grid_ray, N as f32)?;
    let start = grid_ray.origin + grid_ray.direction * enter;
    let (from, way) = (start.to_array(), grid_ray.direction.to_array());
    let mut voxel = from.map(|v| (v.floor() as i64).clamp(0, N as i64 - 1));
    let step = way.map(|w| if w < 0.0 { -1 } else { 1 });
    // Distance from one boundary to the next along each axis, and to the next one ahead.
    let stride = way.map(|w| if w == 0.0 { f32::INFINITY } else { 1.0 / w.abs() });
    let mut next: [f32; 3] = core::array::from_fn(|k| {
        let boundary = (voxel[k] + i64::from(step[k] > 0)) as f32;
        if way[k] == 0.0 { f32::INFINITY } else { enter + (boundary - from[k]) / way[k] }
    });
    let mut distance = enter;
    while distance <= leave {
        let at = voxel.map(|v| v as usize);
        if maps.contains(at) {
            return Some(CursorHit { distance_voxels: distance, voxel: at });
        }
        let k = (0..3).fold(0, |least, k| if next[k] < next[least] { k } else { least });
        distance = next[k];
        next[k] += stride[k];
        voxel[k] += step[k];
        if !(0..N as i64).contains(&voxel[k]) {
            break;
        }
    }
    None
}

/// Estimates the surface normal by occupancy: the unit vector away from the occupied voxels within a ball
/// around a point. Returns `None` if they cancel out or there are none.
#[must_use]
pub(super) fn estimate_normal<const N: usize, const K: usize>(
    maps: &RangeMaps<N, K>,
    point_voxels: Vec3,
    radius_voxels: i32,
) -> Option<Vec3> {
    let (middle, reach) = (point_voxels.floor().as_ivec3(), radius_voxels);
    let mut out = Vec3::ZERO;
    for z in -reach..=reach {
        for y in -reach..=reach {
            for x in -reach..=reach {
                let offset = glam::IVec3::new(x, y, z);
                let near = offset.length_squared() <= reach * reach;
                let voxel = (middle + offset).to_array();
                // The ground continues below the grid.
                let inside = voxel.iter().all(|v| (0..N as i32).contains(v));
                if near && (inside && maps.contains(voxel.map(|v| v as usize))) {
                    out -= offset.as_vec3();
                }
            }
        }
    }
    out.try_normalize()
}

#[cfg(test)]
mod tests {
    use super::{Ray, cast_ray, estimate_normal};
    use glam::Vec3;
    use paros_core::RangeMaps;
    use paros_core::volume::{BitGrid, BitSet};

    /// Returns a ball of radius 5 about the middle of a grid of 16, and another voxel in a corner.
    fn ball_and_corner() -> Box<RangeMaps<16>> {
        let inside = |v: [usize; 3]| {
            let far: f32 = v.iter().map(|&c| (c as f32 - 7.5).powi(2)).sum();
            far <= 25.0 || v == [0, 0, 0]
        };
        let mut bit_grid = Box::new(BitGrid::<16>::new());
        for y in 0..16 {
            for z in 0..16 {
                let row = bit_grid.row_mut(y, z);
                (0..16).filter(|x| inside([*x, y, z])).for_each(|x| row.insert(x));
            }
        }
        let mut maps = Box::new(RangeMaps::new());
        bit_grid.write_hulls(&mut maps);
        maps
    }

    #[test]
    fn the_walk_meets_what_small_steps_meet() {
        let maps = ball_and_corner();
        let mut seed = 7u32;
        let mut random = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 8) as f32 / (1 << 24) as f32
        };
        for _ in 0..2000 {
            let mut point = || Vec3::new(random(), random(), random()) * 40.0 - 12.0;
            let (from, to) = (point(), point());
            let direction = (to - from).normalize();
            let stepped = (0..12_000).map(|i| i as f32 * 0.005).find(|t| {
                let at = (from + direction * *t).floor();
                let inside = at.cmpge(Vec3::ZERO).all() && at.cmplt(Vec3::splat(16.0)).all();
                inside && maps.contains(at.to_array().map(|v| v as usize))
            });
            let walked =
                cast_ray(&maps, &Ray { origin: from, direction }).map(|hit| hit.distance_voxels);
            match (stepped, walked) {
                (Some(a), Some(b)) => assert!((a - b).abs() < 0.011, "{a} and {b}"),
                // The stepwise search can miss the smallest corners.
                (None, Some(b)) => {
                    let after = from + direction * (b + 0.01);
                    let voxel = after.floor().to_array().map(|v| v as usize);
                    assert!(!maps.contains(voxel), "missed at {b}");
                }
                (Some(a), None) => panic!("nothing met, steps meet at {a}"),
                (None, None) => {}
            }
        }
    }

    #[test]
    fn the_normal_of_a_ball_points_out_of_it() {
        let maps = ball_and_corner();
        let middle = Vec3::splat(8.0);
        for way in [Vec3::X, Vec3::NEG_Z, Vec3::new(0.6, 0.0, 0.8), Vec3::new(-0.6, 0.8, 0.0)] {
            let point = middle + way * 4.9;
            let normal = estimate_normal(&maps, point, 4).expect("a surface");
            assert!(normal.dot(way) > 0.95, "{normal} at {way}");
        }
        assert_eq!(estimate_normal(&maps, Vec3::splat(-40.0), 4), None);
    }
}
