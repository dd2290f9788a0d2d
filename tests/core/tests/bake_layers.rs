//! Bake into columns with gaps, bit for bit against the dense model: shapes that columns of one interval
//! can't represent. `bake.rs` bakes random triangles and shapes with one to three intervals.

use glam::{IVec3, Mat3, Vec3};
use paros_core::limits::BAKED_CROSSINGS;
use paros_models::bake::{BakedVoxels, TouchedVoxels, Triangle};
use paros_models::bake_harness::{BakeHarness, N, SIDE_UNITS, check_bake};
use paros_models::cases::random_cases;
use proptest::prelude::*;
use std::sync::Mutex;

/// Returns a box between two corners, in units of 1/256 voxel.
fn cuboid(low: [i32; 3], high: [i32; 3]) -> Vec<Triangle> {
    let mut triangles = Vec::new();
    for w in 0..3 {
        let (u, v) = ((w + 1) % 3, (w + 2) % 3);
        for (end, outwards) in [(low, false), (high, true)] {
            let corner = |i: [i32; 3], j: [i32; 3]| {
                let mut c = end;
                (c[u], c[v]) = (i[u], j[v]);
                c
            };
            let [a, b, c, d] =
                [corner(low, low), corner(high, low), corner(high, high), corner(low, high)];
            triangles.extend(if outwards {
                [[a, b, c], [a, c, d]]
            } else {
                [[a, c, b], [a, d, c]]
            });
        }
    }
    triangles
}

/// Returns a box given by its outermost voxels, whose centres lie inside.
fn box_of_voxels(low: [i32; 3], high: [i32; 3]) -> Vec<Triangle> {
    cuboid(low.map(|i| 256 * i + 100), high.map(|i| 256 * i + 156))
}

fn inside_out(mut triangles: Vec<Triangle>) -> Vec<Triangle> {
    triangles.iter_mut().for_each(|t| t.swap(1, 2));
    triangles
}

/// Returns the surface of the cells of -1..1 on each axis whose centres satisfy `is_inside`, rotated and
/// fitted to the grid.
fn surface_of(is_inside: impl Fn(Vec3) -> bool, pose: Mat3) -> Vec<Triangle> {
    const CELLS: i32 = 14;
    let filled = |cell: IVec3| {
        let centre = (cell.as_vec3() + 0.5) * (2.0 / CELLS as f32) - 1.0;
        centre.abs().max_element() < 1.0 && is_inside(centre)
    };
    let mut triangles = Vec::new();
    for i in 0..CELLS.pow(3) {
        let cell = IVec3::new(i % CELLS, i / CELLS % CELLS, i / CELLS / CELLS);
        for w in 0..3 {
            let [along, u, v] = [w, (w + 1) % 3, (w + 2) % 3].map(|k| IVec3::AXES[k]);
            for (side, corner) in [(-along, cell), (along, cell + along)] {
                if !filled(cell) || filled(cell + side) {
                    continue;
                }
                let (u, v) = if side == along { (u, v) } else { (v, u) };
                let [a, b, c, d] = [corner, corner + u, corner + u + v, corner + v];
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    let turned = |p: IVec3| pose * (p.as_vec3() - CELLS as f32 / 2.0);
    let reach = triangles.iter().flatten().map(|&p| turned(p).abs().max_element());
    let scale = 0.49 * SIDE_UNITS as f32 / reach.fold(0.0, f32::max);
    let place = |p| (turned(p) * scale + SIDE_UNITS as f32 / 2.0).as_ivec3().to_array();
    triangles.into_iter().map(|t: [IVec3; 3]| t.map(place)).collect()
}

fn torus(p: Vec3) -> bool {
    let ring = p.x.hypot(p.z) - 0.62;
    ring.hypot(p.y) < 0.3
}

/// Returns `true` inside a cup with a bow-shaped handle at its side.
fn cup_with_handle(p: Vec3) -> bool {
    let radius = (p.x + 0.3).hypot(p.z);
    let wall = radius < 0.65 && p.y.abs() < 0.8 && (radius > 0.4 || p.y < -0.5);
    let bow = (p.x - 0.35).hypot(p.y);
    wall || (p.x > 0.3 && p.z.abs() < 0.2 && bow > 0.3 && bow < 0.6)
}

/// Returns a box of 14 voxels with a cavity of 6.
fn hollow_box() -> Vec<Triangle> {
    [box_of_voxels([1; 3], [14; 3]), inside_out(box_of_voxels([4; 3], [11; 3]))].concat()
}

fn poses() -> impl Iterator<Item = Mat3> {
    let turn = |x: f32, y: f32| Mat3::from_rotation_x(x) * Mat3::from_rotation_y(y);
    [turn(0.0, 0.0), turn(0.4, 0.7), turn(1.1, 0.3), turn(0.8, 0.0)].into_iter()
}

fn baked<const LAYERS: usize>(triangles: &[Triangle]) -> [BakedVoxels; LAYERS] {
    check_bake(triangles).unwrap();
    let touched = TouchedVoxels::new(N, triangles);
    std::array::from_fn(|i| touched.bake(i + 1))
}

fn count(baked: &BakedVoxels) -> usize {
    baked.occupied.iter().filter(|&&set| set).count()
}

fn holds(baked: &BakedVoxels, [x, y, z]: [usize; 3]) -> bool {
    baked.occupied[x + N * (y + N * z)]
}

#[test]
fn tori_in_any_pose_keep_their_holes() {
    for pose in poses() {
        let [_, two, _, many] = baked(&surface_of(torus, pose));
        assert!(two.occupied == many.occupied, "{pose}");
        assert!(!holds(&two, [8; 3]), "{pose}");
    }
}

#[test]
fn cups_with_a_handle_keep_what_is_open() {
    let mut lost = 0;
    for pose in poses() {
        let [one, two, three, many] = baked(&surface_of(cup_with_handle, pose));
        assert!(three.occupied == many.occupied, "{pose}");
        lost += count(&one) - count(&two);
    }
    assert!(lost > 0);
}

#[test]
fn a_hollow_shell_is_hollow() {
    for pose in poses() {
        let shell = |p: Vec3| p.length() < 0.95 && p.length() > 0.5;
        let [one, two, _, many] = baked(&surface_of(shell, pose));
        assert!(holds(&one, [8; 3]) && !holds(&two, [8; 3]), "{pose}");
        assert!(two.occupied == many.occupied, "{pose}");
    }
}

#[test]
fn nested_boxes_are_hollow_where_the_inner_one_is_wound_inward() {
    let outer = box_of_voxels([1; 3], [14; 3]);
    let inner = box_of_voxels([4; 3], [11; 3]);
    let solid = [outer.clone(), inner.clone()].concat();
    let hollow = [outer, inside_out(inner)].concat();
    let [one, two, three] = baked(&solid);
    assert!([one, two, three].iter().all(|baked| count(baked) == 14 * 14 * 14));
    let [one, two, three] = baked(&hollow);
    assert_eq!(
        [&one, &two, &three].map(count),
        [14 * 14 * 14, 14 * 14 * 14 - 6 * 6 * 6, 14 * 14 * 14 - 6 * 6 * 6]
    );
    // Turned inside out as a whole, the mesh gives the same result.
    let [_, turned, _] = baked(&inside_out(hollow));
    assert!(turned.flipped && turned.occupied == two.occupied && turned.columns == two.columns);
}

#[test]
fn what_overlaps_stays_solid() {
    // Where the two boxes overlap, the winding number is 2. A third box stands beyond the gap.
    let a = box_of_voxels([1, 1, 1], [7, 12, 12]);
    let b = box_of_voxels([3, 2, 2], [9, 13, 13]);
    let c = box_of_voxels([12, 1, 1], [14, 13, 13]);
    let [one, two, _] = baked(&[a, b, c].concat());
    let column = &two.columns[0][6 * N + 6];
    assert_eq!(column, &[(1, 9), (12, 14)]);
    assert_eq!(one.columns[0][6 * N + 6], [(1, 14)]);
}

/// Each face occurs twice, with both windings, so the winding number between the walls is 0.
#[test]
fn a_double_sided_box_is_a_shell() {
    let faces = box_of_voxels([1; 3], [14; 3]);
    let [one, two, _, many] = baked(&[faces.clone(), inside_out(faces)].concat());
    assert_eq!(count(&one), 14 * 14 * 14);
    assert_eq!(count(&two), 14 * 14 * 14 - 12 * 12 * 12);
    assert!(two.occupied == many.occupied);
}

#[test]
fn the_longest_gaps_stay_and_of_equal_ones_the_lowest() {
    // Gaps of 1, 3 and 3 voxels.
    let bars = [(1, 2), (4, 5), (9, 10), (14, 14)];
    let bars = bars.map(|(lo, hi)| cuboid([256 * lo + 30, 600, 600], [256 * hi + 200, 3000, 3000]));
    let [one, two, three, four] = baked(&bars.concat());
    let columns = [one, two, three, four].map(|baked| baked.columns[0][6 * N + 6].clone());
    let expected = [
        vec![(1, 14)],
        vec![(1, 5), (9, 14)],
        vec![(1, 5), (9, 10), (14, 14)],
        vec![(1, 2), (4, 5), (9, 10), (14, 14)],
    ];
    assert_eq!(columns, expected);
}

#[test]
fn walls_behind_a_hole_stay() {
    let shell = hollow_box();
    let [_, whole] = baked(&shell);
    // The outer box comes first. Behind its missing face the winding number of the walls is 0.
    for missing in 0..shell.len() / 2 {
        let mut open = shell.clone();
        open.remove(missing);
        let [_, two] = baked(&open);
        let filled = |(i, &held): (usize, &bool)| two.occupied[i] || !held;
        assert!(whole.occupied.iter().enumerate().all(filled), "triangle {missing}");
        assert!(!holds(&two, [8; 3]), "triangle {missing}");
    }
}

#[test]
fn a_baked_gap_is_held_before_a_longer_run() {
    let mut tube = box_of_voxels([1, 2, 2], [8, 12, 12]);
    // Lacks the faces across y: columns along x see walls around a solid, columns along y see nothing.
    tube.drain(4..8);
    let shape = [tube, box_of_voxels([11, 2, 2], [13, 12, 12])].concat();
    for axis in 0..3 {
        let turn = |mut at: [i32; 3]| {
            at.rotate_right(axis);
            at
        };
        let turned: Vec<Triangle> = shape.iter().map(|triangle| triangle.map(turn)).collect();
        let [_, two] = baked(&turned);
        assert!((2..8).all(|x| !holds(&two, turn([x, 6, 6]).map(|i| i as usize))), "{axis}");
        assert_eq!(two.columns[axis][6 * N + 6], [(1, 8), (11, 13)], "{axis}");
    }
}

#[test]
fn columns_of_too_many_crossings_are_one_interval() {
    let shell = hollow_box();
    // Each copy adds four crossings to a column through the cavity.
    let copies = BAKED_CROSSINGS / 4;
    let [_, two] = baked(&shell.repeat(copies));
    assert!(!holds(&two, [8; 3]));
    let [_, two] = baked(&shell.repeat(copies + 1));
    assert!(holds(&two, [8; 3]));
    // The winding number doesn't wrap at a byte.
    let [_, two] = baked(&shell.repeat(64));
    assert!(holds(&two, [8; 3]));
}

/// A strategy for three to seven small boxes, some of them wound inward.
fn crowd() -> impl Strategy<Value = Vec<Triangle>> {
    let low = proptest::array::uniform3(0..SIDE_UNITS - 900);
    let size = proptest::array::uniform3(40..900i32);
    let cuboid = (low, size, prop::bool::weighted(0.25)).prop_map(|(low, size, inward)| {
        let shape = cuboid(low, [0, 1, 2].map(|k| low[k] + size[k]));
        if inward { inside_out(shape) } else { shape }
    });
    prop::collection::vec(cuboid, 3..8).prop_map(|shapes| shapes.concat())
}

/// A strategy for such boxes in two different orders.
fn shuffled_crowd() -> impl Strategy<Value = [Vec<Triangle>; 2]> {
    crowd().prop_flat_map(|crowd| {
        let shuffled = Just(crowd.clone()).prop_shuffle();
        shuffled.prop_map(move |shuffled| [crowd.clone(), shuffled])
    })
}

proptest! {
    #![proptest_config(random_cases(40))]

    #[test]
    fn crowds(triangles in crowd()) {
        check_bake(&triangles)?;
    }

    #[test]
    fn any_order(orders in shuffled_crowd()) {
        static BENCHES: Mutex<[BakeHarness<3>; 2]> = Mutex::new([BakeHarness::new(), BakeHarness::new()]);
        let mut benches = BENCHES.lock().unwrap_or_else(|held| held.into_inner());
        for (harness, triangles) in benches.iter_mut().zip(&orders) {
            harness.baker.clear();
            for t in triangles {
                prop_assert_eq!(harness.baker.add_triangle(t.map(IVec3::from_array)), Ok(()));
            }
            harness.baker.write_maps(&mut harness.maps, &mut harness.bits);
        }
        prop_assert!(benches[0].maps == benches[1].maps);
        prop_assert!(benches[0].bits == benches[1].bits);
    }
}
