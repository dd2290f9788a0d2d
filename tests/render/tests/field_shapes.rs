//! Properties of the surface of half density: thin features are kept, and so are the position and slope of a
//! sphere's surface.

use glam::Vec3;
use paros_core::RangeMaps;
use paros_models::dense::DenseVolume;
use paros_shaders::field::DensityField;

fn build_field<const N: usize>(dense: &DenseVolume) -> DensityField<N> {
    let mut maps = Box::new(RangeMaps::<N>::new());
    dense.write_maps(&mut maps);
    assert!(DenseVolume::from_maps(&maps) == *dense, "not a closed shape");
    let mut field = DensityField::new();
    field.rebuild_from(&maps);
    field
}

/// Returns the distance along the line from `from` to `to` at which the density falls below a half, or `None`
/// if it is below a half at the start.
fn surface_distance<const N: usize>(field: &DensityField<N>, from: Vec3, to: Vec3) -> Option<f32> {
    (field.sample_density(0, from) >= 0.5).then_some(())?;
    (1..3000).map(|i| i as f32 * 0.01).find(|&t| field.sample_density(0, from + to * t) < 0.5)
}

fn voxel_centre([x, y, z]: [i32; 3]) -> Vec3 {
    Vec3::new(x as f32, y as f32, z as f32) + 0.5
}

/// Asserts that every occupied voxel's centre is within a distance of the inside.
fn check_kept(name: &str, dense: &DenseVolume, most: f32) {
    let field = build_field::<32>(dense);
    // The grid's border cuts shapes off and so makes convex corners, which may lie further out.
    for voxel in dense.occupied().filter(|v| v.iter().all(|c| (2..30).contains(c))) {
        let steps =
            (-4..=4).flat_map(|x| (-4..=4).flat_map(move |y| (-4..=4).map(move |z| [x, y, z])));
        let near = steps
            .map(|by| Vec3::from_array(by.map(|c| c as f32 * 0.4)))
            .filter(|by| by.length() <= most)
            .any(|by| field.sample_density(0, voxel_centre(voxel) + by) >= 0.5);
        assert!(near, "{name}: nothing near {voxel:?}");
    }
}

#[test]
fn plates_keep_their_width() {
    for axis in 0..3 {
        for thick in 1..=3 {
            let plate = DenseVolume::from_fn(32, |v| (12..12 + thick).contains(&v[axis]));
            let field = build_field::<32>(&plate);
            for at in [[16; 3], [9, 20, 13], [3, 8, 28]] {
                let mut from = voxel_centre(at);
                from[axis] = 12.0 + thick as f32 / 2.0;
                let mut to = Vec3::ZERO;
                to[axis] = 1.0;
                let half = surface_distance(&field, from, to).expect("inside the plate");
                let back = surface_distance(&field, from, -to).expect("inside the plate");
                let width = half + back;
                assert!((width - thick as f32).abs() < 0.35, "{thick} along {axis}: {width}");
            }
        }
    }
}

#[test]
fn rods_keep_their_width() {
    for axis in 0..3 {
        let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
        for (wide, high) in [(1, 1), (1, 2), (2, 1), (2, 2)] {
            let rod = DenseVolume::from_fn(32, |v| {
                (12..12 + wide).contains(&v[a]) && (15..15 + high).contains(&v[b])
            });
            let field = build_field::<32>(&rod);
            for along in 4..28 {
                let mut from = Vec3::splat(along as f32 + 0.5);
                from[a] = 12.0 + wide as f32 / 2.0;
                from[b] = 15.0 + high as f32 / 2.0;
                for (side, size) in [(a, wide), (b, high)] {
                    let mut to = Vec3::ZERO;
                    to[side] = 1.0;
                    let [half, back] = [to, -to]
                        .map(|to| surface_distance(&field, from, to).expect("inside the rod"));
                    let width = half + back;
                    assert!((width - size as f32).abs() < 0.35, "{wide} x {high}: {width}");
                }
            }
        }
    }
}

/// Plates and rods that stand on a block, lean on it and cross each other.
#[test]
fn joints_have_no_holes() {
    let block = |v: [i32; 3]| v[0] < 8;
    let plate = |v: [i32; 3]| v[1] == 14;
    let upright = |v: [i32; 3]| v[2] == 20 && v[0] < 26;
    let rod = |v: [i32; 3]| v[1] == 22 && v[2] == 9;
    check_kept("a plate on a wall", &DenseVolume::from_fn(32, |v| block(v) || plate(v)), 0.7);
    check_kept("a rod on a wall", &DenseVolume::from_fn(32, |v| block(v) || rod(v)), 0.7);
    check_kept("crossed plates", &DenseVolume::from_fn(32, |v| plate(v) || upright(v)), 0.7);
    // Seen from the front, no ray along the plate's normal passes through, up to the wall.
    for shape in [
        DenseVolume::from_fn(32, |v| block(v) || plate(v)),
        DenseVolume::from_fn(32, |v| block(v) || plate(v) || upright(v)),
    ] {
        let field = build_field::<32>(&shape);
        for (x, z) in
            (0..56 * 56).map(|i| (2.0 + (i % 56) as f32 * 0.5, 2.0 + (i / 56) as f32 * 0.5))
        {
            let met = (0..=40)
                .any(|i| field.sample_density(0, Vec3::new(x, 12.5 + i as f32 * 0.1, z)) >= 0.5);
            assert!(met, "a hole at x = {x}, z = {z}");
        }
    }
    let field = build_field::<32>(&DenseVolume::from_fn(32, |v| block(v) || rod(v)));
    for i in 0..300 {
        let at = Vec3::new(1.0 + i as f32 * 0.1, 22.5, 9.5);
        assert!(field.sample_density(0, at) >= 0.5, "the rod is cut at {at}");
    }
}

#[test]
fn thin_shapes_are_kept() {
    let ball = |v: [i32; 3]| v.iter().map(|c| (2 * c - 31).pow(2)).sum::<i32>();
    check_kept("one voxel", &DenseVolume::from_fn(32, |v| v == [9, 20, 13]), 0.1);
    check_kept("a sheet on edge", &DenseVolume::from_fn(32, |v| v[0] == v[1]), 0.9);
    check_kept("a slanted sheet", &DenseVolume::from_fn(32, |v| v[0] == v[1] / 3 + 5), 0.9);
    check_kept(
        "a sheet across all axes",
        &DenseVolume::from_fn(32, |v| v.iter().sum::<i32>() == 40),
        0.9,
    );
    check_kept("a rod on edge", &DenseVolume::from_fn(32, |v| v[0] == v[1] && v[2] == 7), 0.9);
    let bowl = DenseVolume::from_fn(32, |v| (576..784).contains(&ball(v)) && v[1] < 16);
    check_kept("a bowl", &bowl, 1.0);
    let tray = DenseVolume::from_fn(32, |v| {
        v.iter().all(|&c| (4..28).contains(&c))
            && (v[1] == 4 || [v[0], v[2]].iter().any(|c| [4, 27].contains(c)))
    });
    // The tray's four lower corners are convex.
    check_kept("a tray", &tray, 2.0);
}

/// A voxel that protrudes from a wall moves its surface by less than half a voxel.
#[test]
fn no_bump_where_a_voxel_stands_proud() {
    let wall = DenseVolume::from_fn(32, |v| v[0] < 16 || v == [16, 15, 15]);
    let field = build_field::<32>(&wall);
    let at = surface_distance(&field, voxel_centre([10, 15, 15]), Vec3::X)
        .expect("inside the wall")
        + 10.5;
    assert!((16.0..16.6).contains(&at), "{at}");
}

#[test]
fn grooves_of_two_voxels_stay() {
    for axis in [0, 2] {
        let cut =
            DenseVolume::from_fn(32, |v| v[1] < 20 && !(v[1] >= 14 && (15..17).contains(&v[axis])));
        let field = build_field::<32>(&cut);
        let mut at = voxel_centre([10, 18, 10]);
        at[axis] = 16.0;
        let floor = (0..80)
            .map(|i| i as f32 * 0.1)
            .find(|&t| field.sample_density(0, at - Vec3::Y * t) >= 0.5);
        let floor = floor.expect("a floor");
        assert!((3.5..5.0).contains(&floor), "the groove is {floor} deep from 18.5");
    }
}

const RADIUS: f32 = 50.0;
const MIDDLE: f32 = 64.0;

fn sphere_field() -> DensityField<128> {
    build_field(&DenseVolume::from_fn(128, |v| {
        voxel_centre(v).distance_squared(Vec3::splat(MIDDLE)) <= RADIUS * RADIUS
    }))
}

/// Returns evenly distributed directions (a spiral).
fn sphere_directions(count: u32) -> impl Iterator<Item = Vec3> {
    (0..count).map(move |i| {
        let y = 1.0 - 2.0 * (i as f32 + 0.5) / count as f32;
        let (sin, cos) = (i as f32 * 2.399_963_2).sin_cos();
        let radius = (1.0 - y * y).sqrt();
        Vec3::new(radius * cos, y, radius * sin)
    })
}

fn gradient_of_six(field: &DensityField<128>, level: usize, at: Vec3, by: f32) -> Vec3 {
    let slope = |axis: Vec3| {
        field.sample_density(level, at - axis * by) - field.sample_density(level, at + axis * by)
    };
    Vec3::new(slope(Vec3::X), slope(Vec3::Y), slope(Vec3::Z))
}

fn gradient_of_four(field: &DensityField<128>, level: usize, at: Vec3, by: f32) -> Vec3 {
    let corners = [[1.0, -1.0, -1.0], [-1.0, -1.0, 1.0], [-1.0, 1.0, -1.0], [1.0, 1.0, 1.0]];
    corners
        .map(Vec3::from_array)
        .map(|corner| -corner * field.sample_density(level, at + corner * by))
        .into_iter()
        .sum()
}

/// A function that takes the gradient of a field at a level and a place, with a distance between samples.
type Slope = fn(&DensityField<128>, usize, Vec3, f32) -> Vec3;

#[test]
fn a_sphere_is_smooth() {
    let field = sphere_field();
    let points: Vec<(Vec3, Vec3)> = sphere_directions(4000)
        .map(|way| {
            let from = Vec3::splat(MIDDLE) + way * (RADIUS - 5.0);
            (way, from + way * surface_distance(&field, from, way).expect("inside the sphere"))
        })
        .collect();
    let off = |(_, at): &(Vec3, Vec3)| (at.distance(Vec3::splat(MIDDLE)) - RADIUS).abs();
    let mean = points.iter().map(off).sum::<f32>() / points.len() as f32;
    println!("the surface is off by {mean:.3} voxels");
    assert!(mean <= 0.25, "{mean}");
    let mean_angle = |slope: Slope, level: usize, by: f32| {
        let angle = |(way, at): &(Vec3, Vec3)| {
            slope(&field, level, *at, by).normalize().dot(*way).clamp(-1.0, 1.0).acos().to_degrees()
        };
        points.iter().map(angle).sum::<f32>() / points.len() as f32
    };
    for (name, slope) in [("six", gradient_of_six as Slope), ("four", gradient_of_four)] {
        for level in 0..2 {
            for by in [0.5, 0.75, 1.0, 1.25, 1.5, 2.0, 2.5] {
                println!(
                    "{name} taps, level {level}, {by}: {:.2} degrees",
                    mean_angle(slope, level, by)
                );
            }
        }
    }
    // The stored gradients are better than these.
    assert!(mean_angle(gradient_of_four, 0, 0.5) < 2.7);
    assert!(mean_angle(gradient_of_four, 1, 1.0) < 2.5);
    assert!(mean_angle(gradient_of_six, 0, 0.75) < 2.8);
}
