//! Bake, bit for bit against the dense model. Whole meshes are baked in `tests/files`, real ones in
//! `tests/real-meshes`.

use glam::IVec3;
use paros_core::Baker;
use paros_core::convert::OutsideBox;
use paros_core::internals::BAKE_UNITS_PER_VOXEL;
use paros_models::bake::{TouchedVoxels, Triangle};
use paros_models::bake_harness::{
    BakeHarness, N, SIDE_UNITS, check_bake, check_bake_moved_into_two_word_rows,
};
use paros_models::cases::random_cases;
use proptest::prelude::*;
use std::sync::Mutex;

/// A strategy for coordinates: anywhere, on a voxel's face, at its centre, or a unit beside one of these.
fn any_coordinate() -> impl Strategy<Value = i32> {
    let near = |step: i32| {
        (0..=SIDE_UNITS / step, -1..=1i32)
            .prop_map(move |(i, d)| (i * step + d).clamp(0, SIDE_UNITS))
    };
    prop_oneof![2 => 0..=SIDE_UNITS, 1 => (0..=SIDE_UNITS / 128).prop_map(|i| i * 128), 1 => near(128)]
}

fn any_point() -> impl Strategy<Value = [i32; 3]> {
    [any_coordinate(), any_coordinate(), any_coordinate()]
}

/// A strategy for triangles of any size, or about as large as a voxel.
fn any_triangle() -> impl Strategy<Value = Triangle> {
    let step = prop_oneof![-300..=300i32, (-2..=2i32).prop_map(|i| i * 128)];
    let offset = proptest::array::uniform3(step);
    let small = (any_point(), offset.clone(), offset).prop_map(|(a, d, e)| {
        let moved = |d: [i32; 3]| [0, 1, 2].map(|k| (a[k] + d[k]).clamp(0, SIDE_UNITS));
        [a, moved(d), moved(e)]
    });
    prop_oneof![1 => [any_point(), any_point(), any_point()], 2 => small]
}

/// A strategy for degenerate triangles, which are segments or points: a corner twice, or three corners on a
/// line.
fn degenerate_triangle() -> impl Strategy<Value = Triangle> {
    let line = (any_point(), proptest::array::uniform3(-200..=200i32), -9..=9i32, -9..=9i32);
    let line = line.prop_map(|(a, d, s, t)| {
        // Clamping would bend the line, so it is shortened instead.
        let fits = |f: i32| (0..3).all(|k| (0..=SIDE_UNITS).contains(&(a[k] + f * d[k])));
        let at = |f: i32| {
            if fits(f) { [0, 1, 2].map(|k| a[k] + f * d[k]) } else { a }
        };
        [a, at(s), at(t)]
    });
    prop_oneof![
        (any_point(), any_point()).prop_map(|(a, b)| [a, b, b]),
        any_point().prop_map(|a| [a; 3]),
        line
    ]
}

/// A strategy for octahedron-like shapes: six corners around a point, with whole planes where they align.
fn any_octahedron() -> impl Strategy<Value = Vec<Triangle>> {
    let reach =
        prop_oneof![1..2000i32, (1..8i32).prop_map(|i| i * 256), (1..16i32).prop_map(|i| i * 128)];
    (any_point(), proptest::array::uniform6(reach)).prop_map(|(c, reach)| {
        let corner = |k: usize, high: usize| {
            let mut p = c;
            let sign = if high == 1 { 1 } else { -1 };
            p[k] = (p[k] + sign * reach[2 * k + high]).clamp(0, SIDE_UNITS);
            p
        };
        (0..8)
            .map(|octant: usize| {
                let high = [0, 1, 2].map(|k| octant >> k & 1);
                let [a, b, d] = [0, 1, 2].map(|k| corner(k, high[k]));
                if high.iter().sum::<usize>() % 2 == 1 { [a, b, d] } else { [a, d, b] }
            })
            .collect()
    })
}

/// A strategy for boxes with arbitrary corners, whose faces are split along either diagonal.
fn any_cuboid() -> impl Strategy<Value = Vec<Triangle>> {
    (any_point(), any_point(), any::<u8>()).prop_map(|(p, q, diagonals)| {
        let low = [0, 1, 2].map(|k| p[k].min(q[k]));
        let high = [0, 1, 2].map(|k| p[k].max(q[k]));
        let mut triangles = Vec::new();
        for w in 0..3 {
            let (u, v) = ((w + 1) % 3, (w + 2) % 3);
            for (top, end) in [(false, low), (true, high)] {
                let corner = |i: bool, j: bool| {
                    let mut c = end;
                    c[u] = if i { high[u] } else { low[u] };
                    c[v] = if j { high[v] } else { low[v] };
                    c
                };
                let mut ring = [
                    corner(false, false),
                    corner(true, false),
                    corner(true, true),
                    corner(false, true),
                ];
                ring.rotate_left(usize::from(diagonals >> (2 * w + usize::from(top)) & 1));
                let [a, b, c, d] = ring;
                triangles.extend(if top { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] });
            }
        }
        triangles
    })
}

/// A strategy for triangles that all share an edge or a corner under a column's centre: crossings at equal
/// height, ordered by slope alone.
fn folded_sheets() -> impl Strategy<Value = Vec<Triangle>> {
    let centre = proptest::array::uniform3(
        (2..N as i32 - 2).prop_map(|i| i * BAKE_UNITS_PER_VOXEL + BAKE_UNITS_PER_VOXEL / 2),
    );
    let step = || prop_oneof![-500..=500i32, (-2..=2i32).prop_map(|i| i * 128), Just(0)];
    let leaf = (proptest::array::uniform3(step()), any::<bool>());
    let hinge = (centre, 0..3usize, 1..500i32, step(), any::<bool>());
    (hinge, prop::collection::vec(leaf, 2..5)).prop_map(
        |((c, along, reach, rise, corner), leaves)| {
            let turned = |d: [i32; 3]| [0, 1, 2].map(|k| c[k] + d[(k + 3 - along) % 3]);
            let start = if corner { c } else { turned([-reach, 0, -rise]) };
            let end = turned([reach, 0, rise]);
            let leaf = |(d, flip): ([i32; 3], bool)| {
                if flip { [start, turned(d), end] } else { [start, end, turned(d)] }
            };
            leaves.into_iter().map(leaf).collect()
        },
    )
}

fn nested_shells() -> impl Strategy<Value = Vec<Triangle>> {
    let shell = (prop_oneof![any_octahedron(), any_cuboid()], prop::bool::weighted(0.2));
    prop::collection::vec(shell, 1..4).prop_map(|shells| {
        let flip = |t: Triangle, flip: bool| if flip { [t[0], t[2], t[1]] } else { t };
        shells
            .into_iter()
            .flat_map(|(shell, inward)| shell.into_iter().map(move |t| flip(t, inward)))
            .collect()
    })
}

proptest! {
    #![proptest_config(random_cases(100))]

    #[test]
    fn soups(triangles in prop::collection::vec(any_triangle(), 1..8)) {
        check_bake(&triangles)?;
    }

    #[test]
    fn folds_under_a_centre(triangles in folded_sheets()) {
        check_bake(&triangles)?;
    }

    #[test]
    fn segments_and_points(triangles in prop::collection::vec(degenerate_triangle(), 1..6)) {
        check_bake(&triangles)?;
    }

    #[test]
    fn closed_shapes(triangles in nested_shells()) {
        check_bake(&triangles)?;
    }

    #[test]
    fn holed_shapes(triangles in nested_shells(), missing in prop::collection::vec(any::<prop::sample::Index>(), 1..5)) {
        let mut triangles = triangles;
        for index in missing {
            triangles.swap_remove(index.index(triangles.len()));
            if triangles.is_empty() {
                return Ok(());
            }
        }
        check_bake(&triangles)?;
    }

    #[test]
    fn order_and_first_corner_do_not_matter(triangles in nested_shells(), seed in any::<prop::sample::Index>()) {
        static BENCHES: Mutex<[BakeHarness<2>; 2]> = Mutex::new([BakeHarness::new(), BakeHarness::new()]);
        let mut benches = BENCHES.lock().unwrap_or_else(|held| held.into_inner());
        let turned = triangles.iter().rev().map(|t| [t[1], t[2], t[0]]);
        let mut other: Vec<Triangle> = turned.collect();
        other.rotate_left(seed.index(triangles.len()));
        let mut reports = Vec::new();
        for (harness, list) in benches.iter_mut().zip([&triangles, &other]) {
            harness.baker.clear();
            for t in list {
                prop_assert_eq!(harness.baker.add_triangle(t.map(IVec3::from_array)), Ok(()));
            }
            reports.push(harness.baker.write_maps(&mut harness.maps, &mut harness.bits));
        }
        prop_assert_eq!(reports[0], reports[1]);
        prop_assert!(benches[0].maps == benches[1].maps);
    }
}

proptest! {
    #![proptest_config(random_cases(6))]

    #[test]
    fn rows_of_two_words(triangles in nested_shells()) {
        // Keeps clear of the small grid's faces, beyond which the large grid has more voxels to touch.
        let inside = |c: i32| 2 * BAKE_UNITS_PER_VOXEL + c * 3 / 4;
        let triangles: Vec<Triangle> = triangles.iter().map(|t| t.map(|p| p.map(inside))).collect();
        let touched = TouchedVoxels::new(N, &triangles);
        let [one, two] = [1, 2].map(|layers| touched.bake(layers));
        // An open ray that runs to the end of the box would run further in a larger box.
        prop_assume!(one.opened == 0);
        check_bake_moved_into_two_word_rows::<1>(&triangles, &one)?;
        check_bake_moved_into_two_word_rows::<2>(&triangles, &two)?;
    }

    #[test]
    fn the_largest_triangles_do_not_overflow(corners in proptest::array::uniform9(prop_oneof![
        Just(0), Just(1), Just(256 * BAKE_UNITS_PER_VOXEL), Just(256 * BAKE_UNITS_PER_VOXEL - 1), 0..=256 * BAKE_UNITS_PER_VOXEL
    ])) {
        static BAKER: Mutex<Baker<256>> = Mutex::new(Baker::new());
        let [a, b, c] = [0, 3, 6].map(|i| IVec3::new(corners[i], corners[i + 1], corners[i + 2]));
        let mut baker = BAKER.lock().unwrap_or_else(|held| held.into_inner());
        for t in [[a, b, c], [b, a, c]] {
            prop_assert_eq!(baker.add_triangle(t), Ok(()));
        }
    }
}

#[test]
fn a_corner_outside_the_box_is_refused_and_changes_nothing() {
    static HARNESS: Mutex<BakeHarness<2>> = Mutex::new(BakeHarness::new());
    let mut harness = HARNESS.lock().unwrap();
    let BakeHarness { baker, maps, bits, .. } = &mut *harness;
    for bad in [[-1, 0, 0], [0, SIDE_UNITS + 1, 0], [0, 0, i32::MAX], [i32::MIN, 0, 0]] {
        let t = [IVec3::ZERO, IVec3::splat(SIDE_UNITS), IVec3::from_array(bad)];
        assert_eq!(baker.add_triangle(t), Err(OutsideBox));
    }
    assert_eq!(baker.write_maps(maps, bits).triangles, 0);
    assert!(maps.is_empty());
}
