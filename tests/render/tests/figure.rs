//! The hidden figure's share of the stone, and its glow where it is bared.

use glam::Vec3;
use paros_core::RangeMaps;
use paros_models::dense::DenseVolume;
use paros_shaders::field::FigureShares;
use paros_shaders::{Ray, TwinScene, TwinSettings, shade_ray};
use paros_tests_render::view::build_maps_and_field;

fn shares_of<const N: usize>(figure: &RangeMaps<N>) -> FigureShares {
    let mut shares = FigureShares::new();
    shares.rebuild_from(figure);
    shares
}

/// Checks shares along a line through a block's flat face, by the distance in texels, at a grid size.
fn check_face<const N: usize>() {
    let inside = |c: i32| (N as i32 / 4..N as i32 * 3 / 4).contains(&c);
    let block = DenseVolume::from_fn(N, |at| at.into_iter().all(inside));
    let shares = shares_of(&build_maps_and_field::<N>(&block).0);
    let above = |texels: f32| shares.sample_clamped(Vec3::new(0.5, 0.75 + texels / 128.0, 0.5));
    for (texels, share) in [(-3.0, 1.0), (-0.5, 0.75), (0.0, 0.5), (1.0, 0.125), (2.5, 0.0)] {
        // A voxel two texels wide has softer faces, by as much as the blur adds.
        let found = above(texels);
        assert!((found - share).abs() < 0.01, "{N}: {found} of {share} at {texels}");
    }
}

#[test]
fn half_of_a_flat_face_is_the_figure_and_little_above_it() {
    check_face::<64>();
    check_face::<128>();
    check_face::<256>();
}

#[test]
fn another_figure_replaces_the_last_one() {
    let block = |end: i32| {
        let voxels = DenseVolume::from_fn(64, |at| at.into_iter().all(|c| (10..end).contains(&c)));
        build_maps_and_field::<64>(&voxels).0
    };
    let mut shares = shares_of(&block(50));
    let at = Vec3::splat(40.0 / 64.0);
    assert!(!shares.is_empty() && shares.sample_clamped(at) == 1.0);
    shares.rebuild_from(&block(30));
    assert_eq!(shares.bytes(), shares_of(&block(30)).bytes());
    shares.rebuild_from(&RangeMaps::<64>::new());
    assert!(shares.is_empty() && shares.sample_clamped(at) == 0.0);
}

/// A block's upper half is stone over the figure, with a thickness in voxels; the figure looks warm where no
/// stone covers it.
#[test]
fn the_figure_is_warm_where_it_is_bared_alone() {
    let block = |top: i32| {
        DenseVolume::from_fn(128, |[x, y, z]| {
            y < top && (20..108).contains(&x) && (20..108).contains(&z)
        })
    };
    let shares = shares_of(&build_maps_and_field::<128>(&block(60)).0);
    let color = |thickness: i32, figure| {
        let (maps, field) = build_maps_and_field::<128>(&block(60 + thickness));
        let plain = TwinScene::new(&*maps, 0.0, TwinSettings::default());
        let scene = TwinScene { field: Some(&*field), figure, ..plain };
        let down = Ray { origin: Vec3::new(0.0, 2.0, 0.0), direction: Vec3::NEG_Y };
        shade_ray(&scene, &down, 0.0).expect("stone").color
    };
    // Warmth is the missing share of blue.
    let warmth = |thickness| {
        let [with, without] = [Some(&shares), None].map(|figure| color(thickness, figure));
        (with.x / with.z) / (without.x / without.z)
    };
    let [bared, thin, thick] = [0, 1, 3].map(warmth);
    println!("bared {bared}, under a voxel {thin}, under three {thick}");
    assert!(bared > 1.5 && thin < 1.05 && thick == 1.0, "{bared}, {thin}, {thick}");
}
