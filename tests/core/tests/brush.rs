//! Brush rasterisation by rows, against the model's point tests.

use glam::{IVec3, Quat, Vec3};
use paros_core::Brush;
use paros_core::edit::{Pose, SUBUNITS_PER_VOXEL};
use paros_core::internals::{BrushPiece, BrushPieces, GridBit, GridShape, isqrt};
use paros_core::volume::{BitSet, Grid, Size};
use paros_models::brush::{
    box_voxels, capsule_voxels, longest_corner_chord_voxels, swept_box_voxels, swept_disc_voxels,
};
use paros_models::cases::random_cases;
use paros_models::dense::DenseVolume;
use proptest::prelude::*;

/// Returns the brush's voxels by rows. Asserts that pieces and rows agree, and that all voxels lie within the
/// bounds.
fn voxels_by_rows<const N: usize>(brush: &Brush) -> DenseVolume
where
    Grid<N>: Size,
{
    let mut pieces = BrushPieces::new();
    let bounds = pieces.set_brush(brush, N);
    assert_eq!(brush.bounds(N), bounds);
    let mut dense = DenseVolume::empty(N);
    for y in 0..N {
        let mut layer = vec![<Grid<N> as Size>::Row::EMPTY; N];
        pieces.visit_layer_rows(y, N, |row| layer[row.z] |= row.x_range.to_row());
        for (z, row) in layer.into_iter().enumerate() {
            assert_eq!(row, brush.row_bits::<N>(y, z), "row {y}, {z}");
            row.iter_ones().for_each(|x| dense.set([x as i32, y as i32, z as i32], true));
        }
    }
    match bounds {
        None => assert!(dense.is_empty(), "voxels without bounds"),
        Some(bounds) => {
            for voxel in dense.occupied() {
                for i in 0..3 {
                    let at = voxel[i] as usize;
                    assert!(
                        bounds.lo[i] <= at && at <= bounds.hi[i],
                        "{voxel:?} outside {bounds:?}"
                    );
                }
            }
        }
    }
    dense
}

fn symmetric_difference(a: &DenseVolume, b: &DenseVolume) -> DenseVolume {
    a.difference(b).union(&b.difference(a))
}

/// A strategy for radius and half thickness of a disc in fixed point, thinner than it is wide.
fn any_disc(n: i32) -> impl Strategy<Value = [i32; 2]> {
    (1..n * SUBUNITS_PER_VOXEL, 1..3 * SUBUNITS_PER_VOXEL)
        .prop_map(|(radius, half)| [radius, half.min(radius)])
}

fn any_small_way() -> impl Strategy<Value = Vec3> {
    [-5.0f32..5.0, -5.0f32..5.0, -5.0f32..5.0].prop_map(Vec3::from_array)
}

fn near_grid(pose: Pose) -> Pose {
    Pose { position: pose.position.clamp(Vec3::splat(-20.0), Vec3::splat(36.0)), ..pose }
}

fn disc_bit([radius, half_thickness]: [i32; 2]) -> GridBit {
    GridBit { shape: GridShape::Disc { radius, half_thickness }, bite: SUBUNITS_PER_VOXEL }
}

/// A strategy for coordinates in fixed point: near the grid, at voxel centres and borders, or far away.
fn any_coordinate(n: i32) -> impl Strategy<Value = i32> {
    let edge = n * SUBUNITS_PER_VOXEL;
    prop_oneof![
        6 => -edge / 2..edge + edge / 2,
        2 => (-4..n + 4).prop_map(|i| i * SUBUNITS_PER_VOXEL + SUBUNITS_PER_VOXEL / 2),
        1 => (-4..n + 4).prop_map(|i| i * SUBUNITS_PER_VOXEL),
        1 => -8192 * SUBUNITS_PER_VOXEL..=8192 * SUBUNITS_PER_VOXEL,
        1 => prop_oneof![Just(-8192 * SUBUNITS_PER_VOXEL), Just(8192 * SUBUNITS_PER_VOXEL)],
    ]
}

fn any_point(n: i32) -> impl Strategy<Value = IVec3> {
    [any_coordinate(n), any_coordinate(n), any_coordinate(n)].prop_map(IVec3::from_array)
}

fn any_length(n: i32) -> impl Strategy<Value = i32> {
    prop_oneof![
        6 => 0..n * SUBUNITS_PER_VOXEL / 2,
        1 => Just(0),
        2 => (0..2 * n).prop_map(|i| i * SUBUNITS_PER_VOXEL / 2),
        1 => 0..8192 * SUBUNITS_PER_VOXEL,
        1 => Just(8192 * SUBUNITS_PER_VOXEL),
    ]
}

fn any_half_extents(n: i32) -> impl Strategy<Value = IVec3> {
    [any_length(n), any_length(n), any_length(n)].prop_map(IVec3::from_array)
}

fn any_rotation() -> impl Strategy<Value = Quat> {
    let component = || prop_oneof![6 => -1.0f32..1.0, 1 => Just(0.0), 1 => Just(1.0)];
    [component(), component(), component(), component()].prop_map(|[x, y, z, w]| {
        let q = Quat::from_xyzw(x, y, z, w);
        if q.length() < 1e-3 { Quat::IDENTITY } else { q.normalize() }
    })
}

fn any_pose(n: i32) -> impl Strategy<Value = Pose> {
    (any_point(n), any_rotation()).prop_map(|(at, rotation)| Pose {
        position: at.as_vec3() / SUBUNITS_PER_VOXEL as f32,
        rotation,
    })
}

fn assert_sphere_is_its_points<const N: usize>(at: IVec3, radius: i32)
where
    Grid<N>: Size,
{
    let rows = voxels_by_rows::<N>(&Brush::sphere(at, radius));
    let wrong = symmetric_difference(&rows, &capsule_voxels(N, at, at, radius));
    assert!(wrong.is_empty(), "{wrong:?}");
}

fn assert_capsule_is_its_points<const N: usize>(a: IVec3, b: IVec3, radius: i32)
where
    Grid<N>: Size,
{
    let rows = voxels_by_rows::<N>(&Brush::capsule(a, b, radius));
    let wrong = symmetric_difference(&rows, &capsule_voxels(N, a, b, radius));
    assert!(wrong.is_empty(), "{wrong:?}");
}

proptest! {
    #![proptest_config(random_cases(200))]

    #[test]
    fn a_sphere_is_its_points(at in any_point(16), radius in any_length(16)) {
        assert_sphere_is_its_points::<16>(at, radius);
    }

    #[test]
    fn a_capsule_is_its_points(a in any_point(16), b in any_point(16), radius in any_length(16)) {
        assert_capsule_is_its_points::<16>(a, b, radius);
    }

    #[test]
    fn a_short_capsule_is_its_points(a in any_point(16), way in [-300..300, -300..300, -300..300i32], radius in any_length(16)) {
        let b = (a + IVec3::from_array(way)).clamp(IVec3::splat(-8192 * SUBUNITS_PER_VOXEL), IVec3::splat(8192 * SUBUNITS_PER_VOXEL));
        assert_capsule_is_its_points::<16>(a, b, radius);
    }

    #[test]
    fn a_box_is_its_points(half in any_half_extents(16), pose in any_pose(16)) {
        let rows = voxels_by_rows::<16>(&Brush::oriented_box(half, &pose));
        let wrong = symmetric_difference(&rows, &box_voxels(16, half, &pose));
        prop_assert!(wrong.is_empty(), "{:?}", wrong);
    }

    #[test]
    fn a_moved_box_is_its_points(half in any_half_extents(16), start in any_point(16), pose in any_pose(16)) {
        let start = Pose { position: start.as_vec3() / SUBUNITS_PER_VOXEL as f32, rotation: pose.rotation };
        let rows = voxels_by_rows::<16>(&Brush::swept_box(half, &start, &pose));
        let model = swept_box_voxels(16, half, &pose, start.clamped_position_subunits());
        let wrong = symmetric_difference(&rows, &model);
        prop_assert!(wrong.is_empty(), "{:?}", wrong);
        for end in [&start, &pose] {
            prop_assert!(box_voxels(16, half, end).is_within(&rows));
        }
    }

    #[test]
    fn a_turned_sweep_holds_its_ends_and_all_between(
        half in any_half_extents(16), from in any_pose(16), to in any_pose(16), times in proptest::collection::vec(0.0f32..1.0, 3),
    ) {
        let brush = Brush::swept_box(half, &from, &to);
        let rows = voxels_by_rows::<16>(&brush);
        for end in [&from, &to] {
            let wrong = box_voxels(16, half, end).difference(&rows);
            prop_assert!(wrong.is_empty(), "an end's voxels are missing: {:?}", wrong);
        }
        // Between its ends the box's corners move by less than `corner * turn` from some piece's, so a box
        // smaller by that amount on all sides lies inside.
        let corner = half.as_vec3().length() / SUBUNITS_PER_VOXEL as f32;
        let turn = corner * from.angle_radians_to(&to);
        if turn < 90.0 && half.min_element() > 2 * SUBUNITS_PER_VOXEL && from.position.length().max(to.position.length()) < 100.0 {
            for t in times {
                let core = box_voxels(16, half - IVec3::splat(SUBUNITS_PER_VOXEL + 8), &from.interpolate(&to, t));
                let wrong = core.difference(&rows);
                prop_assert!(wrong.is_empty(), "at {}: {:?}", t, wrong);
            }
        }
    }

    #[test]
    fn a_disc_moved_in_its_plane_is_its_points(disc in any_disc(16), way in any_small_way(), pose in any_pose(16)) {
        let pose = near_grid(pose);
        let normal = pose.rotation * Vec3::X;
        let in_plane = way - normal * way.dot(normal);
        let start = Pose { position: pose.position + in_plane, ..pose };
        for start in [&start, &pose] {
            let rows = voxels_by_rows::<16>(&disc_bit(disc).swept_brush(start, &pose));
            let model = swept_disc_voxels(16, disc, &pose, start.clamped_position_subunits());
            let wrong = symmetric_difference(&rows, &model);
            prop_assert!(wrong.is_empty(), "{:?}", wrong);
        }
    }

    /// A swept disc covers both ends and, slightly thinner, all poses between them; and no voxel far from
    /// every disc between.
    #[test]
    fn a_swept_disc_holds_its_ends_and_little_beside(
        disc in any_disc(16), from in any_pose(16), way in any_small_way(), turn in prop_oneof![Just(0.0f32), -1.0f32..1.0],
    ) {
        let from = near_grid(from);
        let to = Pose {
            position: from.position + way,
            rotation: from.rotation * Quat::from_rotation_z(turn),
        };
        let rows = voxels_by_rows::<16>(&disc_bit(disc).swept_brush(&from, &to));
        for end in [&from, &to] {
            let at_end = swept_disc_voxels(16, disc, end, end.clamped_position_subunits());
            prop_assert!(at_end.is_within(&rows), "{:?}", at_end.difference(&rows));
        }
        let [radius, half] = disc;
        let steps = 2 * (way.length() + radius as f32 / SUBUNITS_PER_VOXEL as f32) as u32 + 4;
        let mut most = DenseVolume::empty(16);
        for step in 0..=steps {
            let here = from.interpolate(&to, step as f32 / steps as f32);
            let at = here.clamped_position_subunits();
            let thin = [radius - 8, half - SUBUNITS_PER_VOXEL * 3 / 4];
            if thin.iter().min() > Some(&0) {
                let held = swept_disc_voxels(16, thin, &here, at);
                prop_assert!(held.is_within(&rows), "{}: {:?}", step, held.difference(&rows));
            }
            // A piece turns by half a voxel at its rim, and moves across by one.
            let wide = [radius + SUBUNITS_PER_VOXEL / 2, half + SUBUNITS_PER_VOXEL * 7 / 4];
            most = most.union(&swept_disc_voxels(16, wide, &here, at));
        }
        prop_assert!(rows.is_within(&most), "{:?}", rows.difference(&most));
    }

    #[test]
    fn no_corner_turns_by_more_than_a_voxel(half in [0..16 * SUBUNITS_PER_VOXEL, 0..16 * SUBUNITS_PER_VOXEL, 0..16 * SUBUNITS_PER_VOXEL], from in any_pose(16), to in any_pose(16)) {
        let half = IVec3::from_array(half);
        let steps = Brush::swept_box(half, &from, &to).pieces().len();
        let corner = half.as_vec3().length() / SUBUNITS_PER_VOXEL as f32;
        prop_assume!(corner <= 30.0);
        let last = (steps - 1).max(1) as f32;
        let turned = |i: usize| from.interpolate(&to, i as f32 / last).rotation;
        for i in 1..steps {
            let way = longest_corner_chord_voxels(half, turned(i - 1), turned(i));
            prop_assert!(way <= 1.001, "{} voxels in step {} of {}", way, i, steps);
        }
        if steps == 1 {
            prop_assert!(longest_corner_chord_voxels(half, from.rotation, to.rotation) < 0.01);
        }
    }
}

proptest! {
    #![proptest_config(random_cases(25))]

    #[test]
    fn spheres_and_capsules_of_32(a in any_point(32), b in any_point(32), radius in any_length(32)) {
        assert_sphere_is_its_points::<32>(a, radius);
        assert_capsule_is_its_points::<32>(a, b, radius);
    }

    #[test]
    fn boxes_of_32(half in any_half_extents(32), pose in any_pose(32)) {
        let rows = voxels_by_rows::<32>(&Brush::oriented_box(half, &pose));
        prop_assert!(symmetric_difference(&rows, &box_voxels(32, half, &pose)).is_empty());
    }
}

proptest! {
    #![proptest_config(random_cases(1))]

    #[test]
    fn spheres_and_capsules_of_128(a in any_point(128), b in any_point(128), radius in any_length(128)) {
        assert_sphere_is_its_points::<128>(a, radius);
        assert_capsule_is_its_points::<128>(a, b, radius);
    }
}

#[test]
fn a_sphere_of_no_radius_is_the_voxel_whose_centre_it_is() {
    let centre = IVec3::new(5, 6, 7) * SUBUNITS_PER_VOXEL + IVec3::splat(SUBUNITS_PER_VOXEL / 2);
    let rows = voxels_by_rows::<16>(&Brush::sphere(centre, 0));
    assert_eq!(rows.occupied().collect::<Vec<_>>(), [[5, 6, 7]]);
    assert!(voxels_by_rows::<16>(&Brush::sphere(centre + IVec3::X, 0)).is_empty());
}

#[test]
fn the_boundary_is_inside() {
    let centre = IVec3::splat(8 * SUBUNITS_PER_VOXEL + SUBUNITS_PER_VOXEL / 2);
    let rows = voxels_by_rows::<16>(&Brush::sphere(centre, 5 * SUBUNITS_PER_VOXEL));
    assert!(
        rows.contains([13, 8, 8]) && rows.contains([8 + 3, 8, 8 + 4]) && !rows.contains([14, 8, 8])
    );
    let less = voxels_by_rows::<16>(&Brush::sphere(centre, 5 * SUBUNITS_PER_VOXEL - 1));
    assert!(!less.contains([13, 8, 8]) && !less.contains([8 + 3, 8, 8 + 4]));
    let pose = Pose { position: Vec3::splat(8.5), rotation: Quat::IDENTITY };
    let rows =
        voxels_by_rows::<16>(&Brush::oriented_box(IVec3::new(2, 3, 0) * SUBUNITS_PER_VOXEL, &pose));
    assert_eq!(rows.count(), 5 * 7);
}

/// No argument makes a brush panic, and the rows of every brush lie within its bounds.
#[test]
fn awkward_numbers_do_not_panic() {
    let odd = [
        0.0,
        -0.0,
        1.0,
        -8.5,
        1e-42,
        f32::MIN_POSITIVE,
        1e9,
        -1e30,
        f32::MAX,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::NAN,
    ];
    let lengths =
        [0, 1, -1, SUBUNITS_PER_VOXEL, 8192 * SUBUNITS_PER_VOXEL, i32::MAX, i32::MIN, i32::MIN + 1];
    let mut poses = vec![];
    for a in odd {
        for b in odd {
            poses.push(Pose {
                position: Vec3::new(a, b, 3.0),
                rotation: Quat::from_xyzw(b, 0.3, a, 1.0),
            });
            poses.push(Pose {
                position: Vec3::new(7.0, a, b),
                rotation: Quat::from_xyzw(a, a, a, b),
            });
        }
    }
    let ask = |brush: &Brush| {
        let _ = brush.bounds(16);
        for (y, z) in [(0, 0), (3, 9), (15, 15)] {
            let _ = brush.row_bits::<16>(y, z);
        }
    };
    for (i, from) in poses.iter().enumerate() {
        for to in poses.iter().skip(i % 7).step_by(7) {
            let l = |k: usize| lengths[(i + k) % lengths.len()];
            ask(&Brush::swept_box(IVec3::new(l(0), l(1), l(3)), from, to));
            ask(&Brush::capsule(
                IVec3::new(l(2), l(5), l(1)),
                to.clamped_position_subunits(),
                l(4),
            ));
        }
        ask(&Brush::oriented_box(IVec3::splat(lengths[i % 8]), from));
    }
    for a in lengths {
        for b in lengths {
            for c in lengths {
                voxels_by_rows::<16>(&Brush::sphere(IVec3::new(a, b, c), b));
                ask(&Brush::capsule(IVec3::new(a, b, c), IVec3::new(c, a, b), c));
            }
        }
    }
}

/// In one piece, the ball that bounds a disc would reach from its first position into its last plane.
#[test]
fn a_disc_that_goes_askew_leaves_what_it_passes_by() {
    let disc = disc_bit([4 * SUBUNITS_PER_VOXEL, SUBUNITS_PER_VOXEL / 2]);
    let at = |x: f32, z: f32| Pose { position: Vec3::new(x, 8.5, z), rotation: Quat::IDENTITY };
    let rows = voxels_by_rows::<16>(&disc.swept_brush(&at(4.5, 5.5), &at(8.5, 13.5)));
    assert!(rows.contains([4, 8, 2]) && rows.contains([8, 8, 12]), "its ends");
    assert!(!rows.contains([6, 8, 2]), "it is nowhere near");
}

#[test]
fn a_straight_move_is_one_piece() {
    let at =
        |x: f32| Pose { position: Vec3::new(x, 4.0, 4.0), rotation: Quat::from_rotation_x(0.3) };
    let brush = Brush::swept_box(IVec3::splat(SUBUNITS_PER_VOXEL), &at(1.0), &at(9.0));
    assert!(matches!(brush.pieces().collect::<Vec<_>>()[..], [BrushPiece::Box(_)]));
}

proptest! {
    #![proptest_config(random_cases(2000))]

    #[test]
    fn an_integer_root_is_the_greatest_whose_square_is_not_above(root in 0..1i64 << 31, more in -2..3i64) {
        for v in [root * root + more, (root >> 5).pow(2) + more, (root >> 12).pow(2) + more, root] {
            let r = isqrt(v);
            prop_assert!(r * r <= v.max(0) && v < (r + 1) * (r + 1), "{} of {}", r, v);
        }
    }
}
