//! Closed shells wound inwards, cavities, stray facets and far coordinates.

use paros_core::convert::UpAxis;
use paros_core::volume::{Grid, Size};
use paros_shell::mesh::{Mesh, MeshFormat};
use paros_shell::statics::Resident;
use paros_tests_files::baked::{bake_voxels, share_in_common};
use paros_tests_files::shapes::{vase_of_quads, with_holes_closed};
use std::fmt::Write;
use std::path::Path;

/// A box by its lowest corner and its extents, wound outwards or inwards.
#[derive(Clone, Copy)]
struct Block([f64; 3], [f64; 3], Winding);

#[derive(Clone, Copy, PartialEq)]
enum Winding {
    Out,
    In,
}
use Winding::{In, Out};

/// Facets as corners of a box: bit k of a corner is its side along axis k.
const FACETS: [[usize; 3]; 12] = [
    [0, 2, 1],
    [1, 2, 3],
    [4, 5, 6],
    [6, 5, 7],
    [0, 1, 4],
    [4, 1, 5],
    [2, 6, 3],
    [3, 6, 7],
    [0, 4, 2],
    [2, 4, 6],
    [1, 3, 5],
    [5, 3, 7],
];

fn obj_of(blocks: &[Block]) -> String {
    let mut text = String::new();
    for Block(low, size, winding) in blocks {
        for corner in 0..8 {
            let [x, y, z] =
                [0, 1, 2].map(|k| low[k] + if corner >> k & 1 == 1 { size[k] } else { 0.0 });
            writeln!(text, "v {x} {y} {z}").unwrap();
        }
        for [a, b, c] in FACETS {
            let [a, b, c] = if *winding == Out { [a, b, c] } else { [a, c, b] };
            writeln!(text, "f {} {} {}", a as i32 - 8, b as i32 - 8, c as i32 - 8).unwrap();
        }
    }
    text
}

fn read(text: &str) -> Mesh {
    Mesh::from_bytes(MeshFormat::Obj, text.as_bytes(), Path::new("")).unwrap()
}

fn assert_bakes_alike<const N: usize>(mesh: &Mesh, expected: &Mesh)
where
    Grid<N>: Size + Resident<N, 2>,
{
    let [found, expected] = [mesh, expected].map(|mesh| bake_voxels::<N>(mesh, UpAxis::Y));
    let common = share_in_common(&found, &expected);
    assert!(common >= 0.99, "{common:.4} in common at {N}");
}

/// A body, an arm through its side, and a head on top that overlaps it.
const BODY: [Block; 3] = [
    Block([0.0; 3], [3.0, 4.0, 2.0], Out),
    Block([2.5, 2.0, 0.5], [3.0, 0.7, 0.7], Out),
    Block([1.0, 3.8, 0.5], [1.0, 1.5, 1.0], Out),
];

#[test]
fn overlapping_shells_wound_inwards_are_turned() {
    let right = read(&obj_of(&BODY));
    assert_eq!((right.findings.closed_shells, right.findings.turned_shells), (3, 0));
    for turned in 1..7 {
        let mut blocks = BODY;
        (0..3).filter(|i| turned >> i & 1 == 1).for_each(|i| blocks[i].2 = In);
        let mesh = read(&obj_of(&blocks));
        assert_eq!(mesh.triangles, right.triangles, "{turned}");
        let found = &mesh.findings;
        assert_eq!(found.turned_shells, u32::count_ones(turned) as usize);
        assert_eq!((found.cavities, found.open_edges, found.is_inside_out), (0, 0, false));
        let said = found.describe().join("\n");
        assert!(said.contains("wound inwards turned outwards") && !said.contains("hole"), "{said}");
    }
    let inside_out = read(&obj_of(&BODY.map(|Block(low, size, _)| Block(low, size, In))));
    assert!(inside_out.findings.is_inside_out);
    assert_eq!(inside_out.triangles, right.triangles);
    assert_bakes_alike::<128>(&inside_out, &right);
}

#[test]
fn a_shell_wound_inwards_inside_an_outward_one_is_a_cavity() {
    let outer = Block([0.0; 3], [4.0; 3], Out);
    let inner = |low: [f64; 3], winding| Block(low, [1.0, 1.2, 0.8], winding);
    let hollow = read(&obj_of(&[outer, inner([1.0; 3], In)]));
    assert_eq!((hollow.findings.cavities, hollow.findings.turned_shells), (1, 0));
    assert!(hollow.findings.describe().join("\n").contains("1 cavity inside another part"));
    // The same shape inside out is read as before.
    let Block(low, size, _) = outer;
    let turned = read(&obj_of(&[Block(low, size, In), inner([1.0; 3], Out)]));
    assert!(turned.findings.is_inside_out && turned.findings.cavities == 1);
    assert_eq!(turned.triangles, hollow.triangles);
    let [solid, hollow] = [&[outer][..], &[outer, inner([1.0; 3], In)]]
        .map(|blocks| bake_voxels::<128>(&read(&obj_of(blocks)), UpAxis::Y).count_voxels());
    assert!(hollow < solid * 99 / 100, "{hollow} of {solid}");
    // Beside the outer box, or through its side, the inner box is a part with reversed winding.
    for low in [[5.0, 0.0, 0.0], [3.5, 1.0, 1.0]] {
        let mesh = read(&obj_of(&[outer, inner(low, In)]));
        assert_eq!((mesh.findings.cavities, mesh.findings.turned_shells), (0, 1), "{low:?}");
        assert_eq!(mesh.triangles, read(&obj_of(&[outer, inner(low, Out)])).triangles);
    }
}

/// Holes, reversed facets and reversed parts each have their own message.
#[test]
fn facets_wound_against_the_rest_are_turned_over() {
    let vase = with_holes_closed(&vase_of_quads(24, 18));
    let obj = |mesh: &Mesh, skip: usize| {
        let mut text = String::new();
        for [x, y, z] in &mesh.positions {
            writeln!(text, "v {x} {y} {z}").unwrap();
        }
        for [a, b, c] in &mesh.triangles[skip..] {
            writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1).unwrap();
        }
        text
    };
    let right = read(&obj(&vase, 0));
    assert_eq!((right.findings.winding_faults, right.findings.open_edges), (0, 0));
    let mut faulty = vase.clone();
    faulty.triangles.iter_mut().step_by(7).for_each(|t| t.swap(1, 2));
    let mesh = read(&obj(&faulty, 0));
    assert_eq!(mesh.findings.turned_facets, faulty.triangles.len().div_ceil(7));
    assert!(mesh.findings.winding_faults > 100 && mesh.findings.open_edges == 0);
    let rotate = |t: &[u32; 3]| (0..3).map(|i| [t[i], t[(i + 1) % 3], t[(i + 2) % 3]]).min();
    assert!(mesh.triangles.iter().map(rotate).eq(right.triangles.iter().map(rotate)));
    let holed = read(&obj(&vase, 1));
    assert_eq!((holed.findings.open_edges, holed.findings.closed_shells), (3, 0));
    assert_eq!(holed.findings.describe(), ["the mesh has holes: 3 open edges"]);
}

#[test]
fn facets_without_area_and_unused_vertices_do_not_count_for_the_fit() {
    let plain = obj_of(&BODY);
    let right = read(&plain);
    for stray in [
        "v 900 0 0\nf -1 -1 -1\n",
        "v 900 0 0\nv 901 0 0\nv 903 0 0\nf -1 -2 -3\n",
        "v 100.1 200.2 300.3\nv 100.2 200.4 300.6\nv 100.3 200.6 300.9\nf -1 -2 -3\n",
        "v 900 0 0\nf 1 2 -1\nf 1 -1 1\nv 1e9 1e9 1e9\n",
        "v -900 -900 -900\n",
    ] {
        let mesh = read(&format!("{plain}{stray}"));
        let facets = stray.matches('f').count();
        if stray.contains("f 1 2") {
            continue;
        }
        assert_eq!(mesh.bounding_box(), right.bounding_box(), "{stray}");
        assert_eq!(mesh.findings.dropped_facets, facets, "{stray}");
        assert_eq!(mesh.triangles, right.triangles, "{stray}");
    }
}

#[test]
fn a_facet_without_area_stays_where_it_closes_a_gap() {
    // The middle of an edge of the first block is a corner of only one of the edge's two facets.
    let text = "v 0 0 0\nv 2 0 0\nv 1 2 0\nv 1 1 2\nv 1 0 0\nf 1 3 2\nf 1 5 4\nf 5 2 4\nf 2 3 4\nf 3 1 4\nf 1 2 5\n";
    let mesh = read(text);
    assert_eq!((mesh.triangles.len(), mesh.findings.dropped_facets), (6, 0));
    assert_eq!((mesh.findings.open_edges, mesh.findings.closed_shells), (0, 1));
}

#[test]
fn a_small_part_far_away_is_named_with_its_size() {
    let mut blocks = BODY.to_vec();
    assert_eq!(read(&obj_of(&blocks)).findings.outlier, None);
    blocks.push(Block([100.0, 0.0, 0.0], [0.25, 0.5, 0.125], Out));
    let mesh = read(&obj_of(&blocks));
    let said = mesh.findings.describe().join("\n");
    let expected = "a part of 12 facets, 0.250 x 0.500 x 0.125, lies 94.500 away from the rest, which would be";
    assert!(said.contains(expected), "{said}");
}

/// The same figure at the origin, at UTM coordinates, and there in millimetres.
#[test]
fn far_coordinates_keep_their_details() {
    let place = |far: [f64; 3], scale: f64| {
        let at = |Block(low, size, winding): Block| {
            let low = [0, 1, 2].map(|k| (far[k] + low[k]) * scale);
            Block(low, size.map(|c| c * scale), winding)
        };
        read(&obj_of(&BODY.map(at)))
    };
    let near = place([0.0; 3], 1.0);
    assert_eq!(near.origin, [0.0; 3]);
    for (far, scale) in [
        ([448_261.25, 5_411_933.5, 113.5], 1.0),
        ([-448_261.25, -5_411_933.5, 1e6], 1e3),
        ([4e6, 5e5, 4.9e6], 1.0),
    ] {
        let mesh = place(far, scale);
        assert!(mesh.origin[0].abs() > 1e5);
        assert_bakes_alike::<128>(&mesh, &near);
        assert_bakes_alike::<256>(&mesh, &near);
    }
}
