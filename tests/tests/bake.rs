//! Bake, bit for bit against the dense model, and on real meshes.
//!
//! Planted faults, and what catches each (tried by hand):
//! - `shape.rs`, `measure`: `low - 1` made `low`, so that a face belongs to one voxel only ->
//!   `soups`, `segments_and_points`, `closed_shapes`.
//! - `crossing.rs`, `cmp`: the last `then_with` dropped -> `folds_under_a_centre`.
//! - `crossing.rs`, `holds`: a tie always inside -> `soups`, `closed_shapes`.
//! - `mod.rs`, `finish`: `lo` always `hull.lo()` -> `holed_shapes`, `bunny_with_its_base_closed_bakes_alike`.

use glam::IVec3;
use paros_core::bake::{BakeReport, Baker, OutsideBox, Placement, UNITS, Up};
use paros_core::maps::Maps;
use paros_core::plane::Plane;
use paros_core::row::Bits;
use paros_core::size::{Grid, Size};
use paros_desktop::mesh::Mesh;
use paros_tests::models::bake::{self as model, Triangle};
use paros_tests::models::shapes::{closed, real_mesh, vase};
use proptest::prelude::*;
use std::sync::Mutex;

const N: usize = 16;
const SIDE: i32 = N as i32 * UNITS;

struct Bench {
    baker: Baker<N>,
    maps: Maps<N>,
    plane: Plane<N>,
    expected: Maps<N>,
}

impl Bench {
    const fn new() -> Self {
        Bench { baker: Baker::new(), maps: Maps::new(), plane: Plane::new(), expected: Maps::new() }
    }

    fn check(&mut self, triangles: &[Triangle]) -> Result<(), TestCaseError> {
        self.baker.begin();
        for t in triangles {
            prop_assert_eq!(self.baker.triangle(t.map(IVec3::from_array)), Ok(()));
        }
        let report = self.baker.finish(&mut self.maps, &mut self.plane);
        let baked = model::bake(N, triangles);
        for z in 0..N {
            for y in 0..N {
                for x in 0..N {
                    let expected = baked.occupied[x + N * (y + N * z)];
                    prop_assert_eq!(self.maps.contains([x, y, z]), expected, "{:?}", [x, y, z]);
                    prop_assert_eq!(self.plane.contains([x, y, z]), expected, "{:?}", [x, y, z]);
                }
            }
        }
        model::write_hulls(&baked.occupied, &mut self.expected);
        prop_assert!(self.maps == self.expected, "the maps are not tight");
        prop_assert_eq!(report.flipped, baked.flipped);
        prop_assert_eq!(report.degenerate, baked.degenerate);
        prop_assert_eq!(report.opened, baked.opened);
        prop_assert_eq!(report.triangles, triangles.len() as u64);
        Ok(())
    }
}

fn check(triangles: &[Triangle]) -> Result<(), TestCaseError> {
    static BENCH: Mutex<Bench> = Mutex::new(Bench::new());
    BENCH.lock().unwrap_or_else(|held| held.into_inner()).check(triangles)
}

/// A coordinate: anywhere, on a voxel's face, at its centre, or a unit beside one of these.
fn coordinate() -> impl Strategy<Value = i32> {
    let near = |step: i32| {
        (0..=SIDE / step, -1..=1i32).prop_map(move |(i, d)| (i * step + d).clamp(0, SIDE))
    };
    prop_oneof![2 => 0..=SIDE, 1 => (0..=SIDE / 128).prop_map(|i| i * 128), 1 => near(128)]
}

fn point() -> impl Strategy<Value = [i32; 3]> {
    [coordinate(), coordinate(), coordinate()]
}

/// A triangle of any size, or one about as large as a voxel.
fn triangle() -> impl Strategy<Value = Triangle> {
    let step = prop_oneof![-300..=300i32, (-2..=2i32).prop_map(|i| i * 128)];
    let offset = proptest::array::uniform3(step);
    let small = (point(), offset.clone(), offset).prop_map(|(a, d, e)| {
        let moved = |d: [i32; 3]| [0, 1, 2].map(|k| (a[k] + d[k]).clamp(0, SIDE));
        [a, moved(d), moved(e)]
    });
    prop_oneof![1 => [point(), point(), point()], 2 => small]
}

/// Segments and points: a corner twice, or three corners on a line.
fn degenerate() -> impl Strategy<Value = Triangle> {
    let line = (point(), proptest::array::uniform3(-200..=200i32), -9..=9i32, -9..=9i32);
    let line = line.prop_map(|(a, d, s, t)| {
        // Clamping would bend the line: shorten it instead.
        let fits = |f: i32| (0..3).all(|k| (0..=SIDE).contains(&(a[k] + f * d[k])));
        let at = |f: i32| {
            if fits(f) { [0, 1, 2].map(|k| a[k] + f * d[k]) } else { a }
        };
        [a, at(s), at(t)]
    });
    prop_oneof![(point(), point()).prop_map(|(a, b)| [a, b, b]), point().prop_map(|a| [a; 3]), line]
}

/// An octahedron-like shape: six corners around a point, with whole planes where they align.
fn octahedron() -> impl Strategy<Value = Vec<Triangle>> {
    let reach =
        prop_oneof![1..2000i32, (1..8i32).prop_map(|i| i * 256), (1..16i32).prop_map(|i| i * 128)];
    (point(), proptest::array::uniform6(reach)).prop_map(|(c, reach)| {
        let corner = |k: usize, high: usize| {
            let mut p = c;
            let sign = if high == 1 { 1 } else { -1 };
            p[k] = (p[k] + sign * reach[2 * k + high]).clamp(0, SIDE);
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

/// A box with corners anywhere: its sides are split along either diagonal.
fn cuboid() -> impl Strategy<Value = Vec<Triangle>> {
    (point(), point(), any::<u8>()).prop_map(|(p, q, diagonals)| {
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

/// Triangles that all share an edge or a corner under a column's centre: crossings at one height,
/// told apart by slope alone.
fn folds() -> impl Strategy<Value = Vec<Triangle>> {
    let centre = proptest::array::uniform3((2..N as i32 - 2).prop_map(|i| i * UNITS + UNITS / 2));
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

fn shells() -> impl Strategy<Value = Vec<Triangle>> {
    let shell = (prop_oneof![octahedron(), cuboid()], prop::bool::weighted(0.2));
    prop::collection::vec(shell, 1..4).prop_map(|shells| {
        let flip = |t: Triangle, flip: bool| if flip { [t[0], t[2], t[1]] } else { t };
        shells
            .into_iter()
            .flat_map(|(shell, inward)| shell.into_iter().map(move |t| flip(t, inward)))
            .collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(1000) })]

    #[test]
    fn soups(triangles in prop::collection::vec(triangle(), 1..8)) {
        check(&triangles)?;
    }

    #[test]
    fn folds_under_a_centre(triangles in folds()) {
        check(&triangles)?;
    }

    #[test]
    fn segments_and_points(triangles in prop::collection::vec(degenerate(), 1..6)) {
        check(&triangles)?;
    }

    #[test]
    fn closed_shapes(triangles in shells()) {
        check(&triangles)?;
    }

    #[test]
    fn holed_shapes(triangles in shells(), missing in prop::collection::vec(any::<prop::sample::Index>(), 1..5)) {
        let mut triangles = triangles;
        for index in missing {
            triangles.swap_remove(index.index(triangles.len()));
            if triangles.is_empty() {
                return Ok(());
            }
        }
        check(&triangles)?;
    }

    #[test]
    fn order_and_first_corner_do_not_matter(triangles in shells(), seed in any::<prop::sample::Index>()) {
        static BENCHES: Mutex<[Bench; 2]> = Mutex::new([Bench::new(), Bench::new()]);
        let mut benches = BENCHES.lock().unwrap_or_else(|held| held.into_inner());
        let turned = triangles.iter().rev().map(|t| [t[1], t[2], t[0]]);
        let mut other: Vec<Triangle> = turned.collect();
        other.rotate_left(seed.index(triangles.len()));
        let mut reports = Vec::new();
        for (bench, list) in benches.iter_mut().zip([&triangles, &other]) {
            bench.baker.begin();
            for t in list {
                prop_assert_eq!(bench.baker.triangle(t.map(IVec3::from_array)), Ok(()));
            }
            reports.push(bench.baker.finish(&mut bench.maps, &mut bench.plane));
        }
        prop_assert_eq!(reports[0], reports[1]);
        prop_assert!(benches[0].maps == benches[1].maps);
    }
}

/// Closed shapes of the small grid, in the middle of a large one, whose rows are two words long.
fn check_across_words(triangles: &[Triangle], baked: &model::Baked) -> Result<(), TestCaseError> {
    static BAKER: Mutex<Baker<128>> = Mutex::new(Baker::new());
    static MAPS: Mutex<Maps<128>> = Mutex::new(Maps::new());
    static PLANE: Mutex<Plane<128>> = Mutex::new(Plane::new());
    let mut baker = BAKER.lock().unwrap_or_else(|held| held.into_inner());
    let mut plane = PLANE.lock().unwrap_or_else(|held| held.into_inner());
    baker.begin();
    for t in triangles {
        let moved = t.map(|p| IVec3::from_array(p) + IVec3::splat(56 * UNITS));
        prop_assert_eq!(baker.triangle(moved), Ok(()));
    }
    baker.finish(&mut MAPS.lock().unwrap_or_else(|held| held.into_inner()), &mut plane);
    for (i, &expected) in baked.occupied.iter().enumerate() {
        let voxel = [i % N, i / N % N, i / N / N].map(|c| c + 56);
        prop_assert_eq!(plane.contains(voxel), expected, "{:?}", voxel);
    }
    prop_assert_eq!(plane.count(), baked.occupied.iter().filter(|&&set| set).count() as u64);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(60) })]

    #[test]
    fn rows_of_two_words(triangles in shells()) {
        // Away from the small grid's faces, beyond which the large one has voxels to touch.
        let inside = |c: i32| 2 * UNITS + c * 3 / 4;
        let triangles: Vec<Triangle> = triangles.iter().map(|t| t.map(|p| p.map(inside))).collect();
        let baked = model::bake(N, &triangles);
        // What runs to an end of the box runs further in a larger one.
        prop_assume!(baked.opened == 0);
        check_across_words(&triangles, &baked)?;
    }

    #[test]
    fn the_largest_triangles_do_not_overflow(corners in proptest::array::uniform9(prop_oneof![
        Just(0), Just(1), Just(256 * UNITS), Just(256 * UNITS - 1), 0..=256 * UNITS
    ])) {
        static BAKER: Mutex<Baker<256>> = Mutex::new(Baker::new());
        let [a, b, c] = [0, 3, 6].map(|i| IVec3::new(corners[i], corners[i + 1], corners[i + 2]));
        let mut baker = BAKER.lock().unwrap_or_else(|held| held.into_inner());
        for t in [[a, b, c], [b, a, c]] {
            prop_assert_eq!(baker.triangle(t), Ok(()));
        }
    }
}

#[test]
fn a_finely_divided_shape_in_rows_of_two_words() {
    let vase = closed(&vase());
    let (min, max) = vase.bounds().unwrap();
    let placement = Placement::fit(min, max, Up::Y, N).unwrap();
    let place = |i: u32| (placement.snap(vase.positions[i as usize]) + IVec3::Y * 5).to_array();
    let triangles: Vec<Triangle> = vase.triangles.iter().map(|t| t.map(place)).collect();
    let baked = model::bake(N, &triangles);
    assert_eq!(baked.opened, 0);
    check_across_words(&triangles, &baked).unwrap();
}

#[test]
fn a_corner_outside_the_box_is_refused_and_changes_nothing() {
    static BENCH: Mutex<Bench> = Mutex::new(Bench::new());
    let mut bench = BENCH.lock().unwrap();
    let Bench { baker, maps, plane, .. } = &mut *bench;
    for bad in [[-1, 0, 0], [0, SIDE + 1, 0], [0, 0, i32::MAX], [i32::MIN, 0, 0]] {
        let t = [IVec3::ZERO, IVec3::splat(SIDE), IVec3::from_array(bad)];
        assert_eq!(baker.triangle(t), Err(OutsideBox));
    }
    assert_eq!(baker.finish(maps, plane).triangles, 0);
    assert!(maps.is_empty());
}

fn bake<const M: usize>(
    mesh: &Mesh,
    baker: &Mutex<Baker<M>>,
    maps: &Mutex<Maps<M>>,
    plane: &Mutex<Plane<M>>,
) -> BakeReport
where
    Grid<M>: Size,
{
    let (mut baker, mut maps) = (baker.lock().unwrap(), maps.lock().unwrap());
    mesh.bake(Up::Y, &mut baker, &mut maps, &mut plane.lock().unwrap()).unwrap()
}

#[test]
fn bunny_with_its_base_closed_bakes_alike() {
    static BAKER: Mutex<Baker<128>> = Mutex::new(Baker::new());
    static MAPS: Mutex<Maps<128>> = Mutex::new(Maps::new());
    static PLANES: [Mutex<Plane<128>>; 2] = [const { Mutex::new(Plane::new()) }; 2];
    let open = real_mesh("stanford-bunny.obj");
    let whole = closed(&open);
    assert!(whole.triangles.len() > open.triangles.len(), "the mesh has no hole to close");
    let whole_report = bake(&whole, &BAKER, &MAPS, &PLANES[1]);
    let report = bake(&open, &BAKER, &MAPS, &PLANES[0]);
    assert!(!report.flipped, "{report:?}");
    // A fan may cut through the surface beside its hole, hence not zero.
    assert!(whole_report.opened * 20 < report.opened, "{report:?} {whole_report:?}");
    let [a, b] = [PLANES[0].lock().unwrap(), PLANES[1].lock().unwrap()];
    let rows = (0..128 * 128).map(|i| (i / 128, i % 128));
    let apart: u64 = rows.map(|(y, z)| u64::from((a.row(y, z) ^ b.row(y, z)).count())).sum();
    println!("{apart} of {} voxels differ", b.count());
    assert!(apart * 200 < b.count(), "{apart} of {} voxels differ", b.count());
}

#[test]
fn real_meshes_inside_out_and_not_agree_with_the_model() {
    for name in ["suzanne.obj", "spot.obj"] {
        let mesh = real_mesh(name);
        let (min, max) = mesh.bounds().unwrap();
        let placement = Placement::fit(min, max, Up::Y, N).unwrap();
        let place = |i: u32| placement.snap(mesh.positions[i as usize]).to_array();
        let triangles: Vec<Triangle> = mesh.triangles.iter().map(|t| t.map(place)).collect();
        check(&triangles).unwrap();
        let inside_out: Vec<Triangle> = triangles.iter().map(|t| [t[0], t[2], t[1]]).collect();
        check(&inside_out).unwrap();
    }
}

#[test]
fn an_inside_out_mesh_bakes_as_if_it_were_not() {
    static BAKER: Mutex<Baker<64>> = Mutex::new(Baker::new());
    static MAPS: [Mutex<Maps<64>>; 2] = [const { Mutex::new(Maps::new()) }; 2];
    static PLANE: Mutex<Plane<64>> = Mutex::new(Plane::new());
    let mesh = vase();
    let mut turned = mesh.clone();
    for t in &mut turned.triangles {
        t.swap(1, 2);
    }
    let right = bake(&mesh, &BAKER, &MAPS[0], &PLANE);
    let wrong = bake(&turned, &BAKER, &MAPS[1], &PLANE);
    assert!(!right.flipped && wrong.flipped);
    assert_eq!(right.opened, wrong.opened);
    assert!(*MAPS[0].lock().unwrap() == *MAPS[1].lock().unwrap());
}
