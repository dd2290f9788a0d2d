//! The CPU twin against naive transcriptions, analytic shapes and itself.

use glam::Vec3;
use paros_core::RangeMaps;
use paros_models::cases::scaled_cases;
use paros_models::dense::{DenseVolume, any_voxels, closed_volumes};
use paros_models::layers::LayeredVolume;
use paros_models::twin::{
    self as model, BALL_CENTRE, BALL_RADIUS, sample_directions, voxel_centre, with_maps_of_16,
    with_maps_of_ball,
};
use paros_shaders::fast::SunLight;
use paros_shaders::field::DensityField;
use paros_shaders::march::{RaySpan, clip_to_cube, is_point_occupied, march_all_maps, march_maps};
use paros_shaders::surface::{self, Neighbours, SurfacePoint};
use paros_shaders::{Ray, TwinScene, TwinSettings, fast, light, shade_ray};
use proptest::prelude::*;

fn sun_visibility(maps: &RangeMaps<16>, point: Vec3, towards: Vec3, dither: f32) -> f32 {
    light::cone_visibility(16, point, towards, dither, |at| is_point_occupied(maps, at))
}

fn build_field<const N: usize>(maps: &RangeMaps<N>) -> Box<DensityField<N>> {
    let mut field = Box::new(DensityField::new());
    field.rebuild_from(maps);
    field
}

/// A strategy for rays that cross the grid's surroundings in every way: oblique, along axes, from inside.
fn any_ray(n: f32) -> impl Strategy<Value = Ray> {
    let place = move |low: f32, high: f32| {
        [low * n..high * n, low * n..high * n, low * n..high * n].prop_map(Vec3::from_array)
    };
    let oblique = (place(-1.5, 2.5), place(0.0, 1.0)).prop_map(|(from, to)| (from, to - from));
    let inside = (place(0.0, 1.0), place(-1.0, 1.0));
    let axial = (place(0.0, 1.0), 0..3usize, any::<bool>()).prop_map(move |(at, axis, up)| {
        let mut direction = Vec3::ZERO;
        direction[axis] = if up { 1.0 } else { -1.0 };
        (at - direction * 2.0 * n, direction)
    });
    prop_oneof![3 => oblique, 1 => inside, 1 => axial]
        .prop_filter_map("no direction", |(origin, to)| {
            Some(Ray { origin, direction: to.try_normalize()? })
        })
}

fn check_march<const K: usize>(
    dense: &DenseVolume,
    maps: &RangeMaps<16, K>,
    rays: &[Ray],
) -> Result<(), TestCaseError> {
    for ray in rays {
        let quick = march_maps(maps, ray);
        prop_assert_eq!(quick, march_all_maps(maps, ray));
        let found = model::possible_hits_at_layer_middles(
            dense,
            ray.origin.to_array().map(f64::from),
            ray.direction.to_array().map(f64::from),
        );
        let Some(sample) = quick else {
            prop_assert!(found.sure.is_none(), "{:?} misses {:?}", ray, found);
            continue;
        };
        let voxel = sample.voxel.map(|c| c as i32);
        prop_assert!(dense.contains(voxel));
        let same = |t: &f64| (t - f64::from(sample.distance)).abs() < 1e-3;
        let possible = found.sure.iter().chain(&found.doubtful).any(same);
        prop_assert!(possible, "{:?} {:?}", sample, found);
        let away = (ray.at(sample.distance) - voxel_centre(voxel)).abs();
        prop_assert!(away.max_element() < 0.501, "{away} from the voxel's centre");
        let beside = [[-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1]];
        let occupied = beside.map(|by| dense.contains([0, 1, 2].map(|i| voxel[i] + by[i])));
        prop_assert_eq!(Neighbours::around_voxel(maps, sample.voxel), Neighbours(occupied));
    }
    Ok(())
}

fn check_layered_march<const K: usize>(
    voxels: &DenseVolume,
    rays: &[Ray],
) -> Result<(), TestCaseError> {
    let volume = LayeredVolume::new(voxels, K);
    let mut maps = Box::new(RangeMaps::new());
    volume.write_maps::<16, K>(&mut maps);
    check_march(volume.voxels(), &maps, rays)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(scaled_cases(500)))]

    #[test]
    fn march_finds_the_first_occupied_sample(
        dense in closed_volumes(16),
        rays in proptest::collection::vec(any_ray(16.0), 24),
    ) {
        with_maps_of_16(&dense, |maps| check_march(&dense, maps, &rays))?;
    }

    /// Tests columns of two and of four intervals, mostly with gaps.
    #[test]
    fn march_finds_what_any_interval_holds(
        voxels in any_voxels(16),
        rays in proptest::collection::vec(any_ray(16.0), 24),
    ) {
        check_layered_march::<2>(&voxels, &rays)?;
        check_layered_march::<4>(&voxels, &rays)?;
    }

    #[test]
    fn normals_are_equation_1(dense in closed_volumes(16), rays in proptest::collection::vec(any_ray(16.0), 24)) {
        with_maps_of_16(&dense, |maps| {
            for ray in &rays {
                let Some(sample) = march_maps(maps, ray) else { continue };
                let at = surface::trace_blobs_or_closest_approach(maps, ray, &sample);
                prop_assert!((at.normal.length() - 1.0).abs() < 1e-4);
                prop_assert!((ray.at(at.distance) - at.position).length() < 1e-3);
                let place = at.position.to_array().map(f64::from);
                let sum = model::unnormalised_normal(&dense, sample.voxel.map(|c| c as i32), place);
                let size = sum.iter().map(|c| c * c).sum::<f64>().sqrt();
                if size > 0.02 {
                    let normal = Vec3::from_array(sum.map(|c| (c / size) as f32));
                    prop_assert!((normal - at.normal).length() < 2e-3, "{normal} is not {}", at.normal);
                }
            }
            Ok(())
        })?;
    }

    #[test]
    fn each_occupied_sample_damps_the_sun(
        dense in closed_volumes(16),
        ray in any_ray(16.0),
        part in 0.0..1.0f32,
        dither in 0.0..1.0f32,
    ) {
        let Some(RaySpan { near, far }) = clip_to_cube(&ray, 16.0) else { return Ok(()) };
        let way = Ray { origin: ray.at(near + (far - near) * part * 0.99), ..ray };
        let Some(RaySpan { far: length, .. }) = clip_to_cube(&way, 16.0) else { return Ok(()) };
        let samples: Vec<Vec3> = light::cone_sample_points(&way, length, dither).collect();
        prop_assert_eq!(samples.len(), 10);
        let mut blocked = 0;
        for (i, sample) in samples.into_iter().enumerate() {
            let along = (sample - way.origin).dot(way.direction);
            prop_assert!((along - (i as f32 + 0.5) / 10.0 * length).abs() < 1e-3);
            let off = (sample - way.at(along)).length();
            prop_assert!(off <= 2.0 - 1.75 * along / length + 1e-3, "{off} voxels off at {along} of {length}");
            blocked += i32::from(dense.contains(sample.to_array().map(|c| c.floor() as i32)));
        }
        let part = with_maps_of_16(&dense, |maps| sun_visibility(maps, way.origin, way.direction, dither));
        prop_assert!((part - 0.7f32.powi(blocked)).abs() < 1e-5);
    }

    #[test]
    fn odd_rays_do_no_harm(bits in proptest::array::uniform6(any::<u32>()), dither in any::<f32>()) {
        let [a, b, c, d, e, f] = bits.map(f32::from_bits);
        let ray = Ray { origin: Vec3::new(a, b, c), direction: Vec3::new(d, e, f) };
        let dense = DenseVolume::from_fn(16, |[x, y, z]| x + y + z < 20);
        with_maps_of_16(&dense, |maps| {
            let _ = march_maps(maps, &ray);
            let _ = sun_visibility(maps, ray.origin, ray.direction, dither);
            let field = build_field(maps);
            let scene = TwinScene { field: Some(&field), ..TwinScene::new(maps, 0.3, TwinSettings::default()) };
            let _ = shade_ray(&scene, &ray, dither);
            for sdf in [false, true] {
                let _ = shade_ray(&TwinScene::new(maps, 0.3, TwinSettings { sdf, ..TwinSettings::default() }), &ray, dither);
            }
        });
    }
}

#[test]
fn visibility_is_seven_tenths_to_the_number_of_blocked_samples() {
    let way = Vec3::Y;
    let at = |y: f32| Vec3::new(8.0, y, 8.0);
    let full = DenseVolume::from_fn(16, |_| true);
    let part = with_maps_of_16(&full, |maps| sun_visibility(maps, at(0.1), way, 0.0));
    assert!((part - 0.7f32.powi(10)).abs() < 1e-6);
    let empty = DenseVolume::empty(16);
    assert_eq!(with_maps_of_16(&empty, |maps| sun_visibility(maps, at(0.1), way, 0.0)), 1.0);
    // A path of 16 voxels has samples at 0.8, 2.4, ... 15.2: three of them lie between 5 and 9.
    let slab = DenseVolume::from_fn(16, |[_, y, _]| (5..9).contains(&y));
    let part = with_maps_of_16(&slab, |maps| sun_visibility(maps, at(0.0), way, 0.3));
    assert!((part - 0.7f32.powi(3)).abs() < 1e-6, "{part}");
}

/// Calls `f` with rays that meet the ball inside its outline, from every side.
fn for_ball_rays(mut f: impl FnMut(&Ray)) {
    for direction in sample_directions() {
        let (u, v) = light::tangent_basis(direction);
        for i in 0..40 {
            let (angle, off) = (i as f32 * 2.4, BALL_RADIUS * 0.9 * (i as f32 / 40.0).sqrt());
            let beside = BALL_CENTRE + (u * angle.cos() + v * angle.sin()) * off;
            f(&Ray { origin: beside - direction * 100.0, direction });
        }
    }
}

#[test]
fn hits_are_within_a_voxel_of_a_ball_from_every_side() {
    with_maps_of_ball(|maps| {
        let (mut rays, mut blob_off, mut face_off) = (0, 0.0f32, 0.0f32);
        for_ball_rays(|ray| {
            let sample = march_maps(maps, ray).expect("the ray meets the ball");
            let off = |at: surface::SurfacePoint| {
                ((at.position - BALL_CENTRE).length() - BALL_RADIUS).abs()
            };
            blob_off =
                blob_off.max(off(surface::trace_blobs_or_closest_approach(maps, ray, &sample)));
            face_off = face_off.max(off(surface::entry_face_point(ray, &sample)));
            rays += 1;
        });
        assert!(rays > 4000, "{rays}");
        assert!(blob_off <= 1.0, "{blob_off} voxels");
        // Along a diagonal the steps are 1.73 voxels apart, so the march may step over a first voxel.
        assert!(face_off <= 1.75, "{face_off} voxels");
    });
}

/// Equation 1 uses seven voxels, so single normals err by up to a third of a right angle. Over several voxels
/// the errors cancel, which is what the eye sees as the surface's shading.
#[test]
fn normals_of_a_ball_point_outwards() {
    with_maps_of_ball(|maps| {
        let (mut blob, mut face) = (Vec::new(), Vec::new());
        for_ball_rays(|ray| {
            let sample = march_maps(maps, ray).expect("the ray meets the ball");
            let error =
                |at: surface::SurfacePoint| degrees_between(at.normal, at.position - BALL_CENTRE);
            blob.push(error(surface::trace_blobs_or_closest_approach(maps, ray, &sample)));
            face.push(error(surface::entry_face_point(ray, &sample)));
        });
        let mean = |errors: &[f32]| errors.iter().sum::<f32>() / errors.len() as f32;
        assert!(mean(&blob) < 27.0, "{}", mean(&blob));
        assert!(mean(&blob) < 0.6 * mean(&face), "{} of {}", mean(&blob), mean(&face));
        for direction in sample_directions() {
            let (u, v) = light::tangent_basis(direction);
            let (mut normal, mut outwards) = (Vec3::ZERO, Vec3::ZERO);
            for i in 0..1000 {
                let (angle, off) = (i as f32 * 2.4, 5.0 * (i as f32 / 1000.0).sqrt());
                let beside = BALL_CENTRE + (u * angle.cos() + v * angle.sin()) * off;
                let ray = Ray { origin: beside - direction * 100.0, direction };
                let sample = march_maps(maps, &ray).expect("the ray meets the ball");
                let at = surface::trace_blobs_or_closest_approach(maps, &ray, &sample);
                normal += at.normal;
                outwards += (at.position - BALL_CENTRE).normalize();
            }
            let error = degrees_between(normal, outwards);
            assert!(error < 6.0, "{error} degrees seen along {direction}");
        }
    });
}

fn degrees_between(a: Vec3, b: Vec3) -> f32 {
    a.normalize().dot(b.normalize()).clamp(-1.0, 1.0).acos().to_degrees()
}

#[test]
fn blobs_join_smoothly() {
    let lone = Neighbours([false; 6]);
    assert!((lone.blob_distance(Vec3::new(0.0, 2.0, 0.0)) - 1.5).abs() < 1e-5);
    assert!(
        (lone.shepard_normal(Vec3::new(0.0, 0.4, 0.3)) - Vec3::new(0.0, 0.8, 0.6)).length() < 1e-5
    );
    let pair = Neighbours([false, true, false, false, false, false]);
    let between = Vec3::new(0.5, 0.0, 0.0);
    assert!(pair.blob_distance(between) < -0.1, "the union fills the groove between two blobs");
    for i in 0..60 {
        let at = Vec3::new(0.05 * i as f32 - 1.0, 0.7, 0.3);
        let mirrored = Vec3::new(1.0 - at.x, at.y, at.z);
        assert!((pair.blob_distance(at) - pair.blob_distance(mirrored)).abs() < 1e-5);
        let hard = (at.length() - 0.5).min((at - Vec3::X).length() - 0.5);
        assert!(pair.blob_distance(at) <= hard + 1e-6);
    }
}

#[test]
fn the_smooth_surface_of_a_ball_is_close_and_smooth() {
    with_maps_of_ball(|maps| {
        let field = build_field(maps);
        let (mut off, mut worst, mut sum, mut rays) = (0.0f32, 0.0f32, 0.0, 0);
        for_ball_rays(|ray| {
            let at = fast::find_surface(&field, ray).expect("well inside the outline");
            off = off.max(((at.position - BALL_CENTRE).length() - BALL_RADIUS).abs());
            let error = degrees_between(at.normal, at.position - BALL_CENTRE);
            worst = worst.max(error);
            sum += error;
            rays += 1;
        });
        assert!(off < 0.7, "{off} voxels");
        assert!(
            worst < 15.0 && sum / (rays as f32) < 4.0,
            "{worst}, {} degrees",
            sum / rays as f32
        );
    });
}

#[test]
fn the_smooth_surface_keeps_sheets_and_rods() {
    let sheet = DenseVolume::from_fn(16, |[x, y, z]| {
        z == 7 && (3..13).contains(&x) && (3..13).contains(&y)
    });
    let rod = DenseVolume::from_fn(16, |[x, y, z]| y == 8 && z == 7 && (2..14).contains(&x));
    for dense in [sheet, rod] {
        with_maps_of_16(&dense, |maps| {
            let field = build_field(maps);
            for direction in sample_directions().into_iter().filter(|d| d.z.abs() > 0.5) {
                let ray = Ray { origin: Vec3::new(8.5, 8.5, 7.5) - direction * 40.0, direction };
                let at = fast::find_surface(&field, &ray).expect("as thick as a voxel");
                assert!((at.distance - 40.0).abs() < 1.5, "{} along {direction}", at.distance);
            }
        });
    }
}

/// Returns the shading of points of the fast surface by the sun alone, at 128.
fn shade_sunlit(dense: &DenseVolume, normal: Vec3, sun: Vec3, points: &[Vec3]) -> Vec<Vec3> {
    let mut maps = Box::new(RangeMaps::<128>::new());
    dense.write_maps(&mut maps);
    let field = build_field(&maps);
    let lit = |position: &Vec3| {
        let at = SurfacePoint { position: *position, normal, distance: 0.0 };
        let sun = SunLight { direction: sun, color: Vec3::ONE, halfway: sun };
        fast::shade_surface(&field, &at, &sun, Vec3::ZERO)
    };
    points.iter().map(lit).collect()
}

#[test]
fn thin_stone_lets_warm_light_through() {
    let behind = |thick: i32| {
        let plate = DenseVolume::from_fn(128, |[x, ..]| (64..64 + thick).contains(&x));
        shade_sunlit(&plate, Vec3::NEG_X, Vec3::X, &[Vec3::splat(64.0)])[0]
    };
    let [leaf, block] = [behind(2), behind(30)];
    assert!(leaf.x > leaf.y && leaf.y > leaf.z && leaf.z > 0.02, "{leaf}");
    assert!(block.max_element() < 0.001, "{block}");
}

/// A ledge over a floor with the sun overhead: its shadow is dark where it nearly touches the floor, and
/// softer from farther up.
#[test]
fn shadows_are_dark_at_a_contact_and_softer_from_afar() {
    // Excludes the box's edge, where the ledge ends too.
    let points: Vec<Vec3> = (20..128).map(|x| Vec3::new(x as f32 + 0.5, 20.0, 64.0)).collect();
    let floor = DenseVolume::from_fn(128, |[_, y, _]| y < 20);
    let open = shade_sunlit(&floor, Vec3::Y, Vec3::Y, &points);
    let shadow = |height: i32| -> Vec<f32> {
        let ledge = |[x, y, _]: [i32; 3]| x < 64 && (20 + height..40 + height).contains(&y);
        let dense = DenseVolume::from_fn(128, |[x, y, z]| y < 20 || ledge([x, y, z]));
        let lit = shade_sunlit(&dense, Vec3::Y, Vec3::Y, &points);
        lit.iter().zip(&open).map(|(lit, open)| lit.x / open.x).collect()
    };
    let [near, far] = [shadow(2), shadow(12)];
    let between = |lit: &[f32]| lit.iter().filter(|lit| (0.3..0.9).contains(*lit)).count();
    for lit in [&near, &far] {
        assert!(lit.is_sorted_by(|a, b| a <= &(b + 0.01)), "{lit:?}");
        assert!(lit[107] > 0.95 && lit[0] < 0.3, "{lit:?}");
    }
    assert!(near[0] < 0.02 && 2 * between(&near) < between(&far), "{near:?}, {far:?}");
}

#[test]
fn points_outside_the_cube_are_empty() {
    let full = DenseVolume::from_fn(16, |_| true);
    with_maps_of_16(&full, |maps| {
        assert!(is_point_occupied(maps, Vec3::splat(15.99)) && is_point_occupied(maps, Vec3::ZERO));
        for outside in [-0.01, 16.0, 1e30, f32::NAN, f32::INFINITY] {
            assert!(!is_point_occupied(maps, Vec3::new(3.0, outside, 3.0)));
        }
    });
}
