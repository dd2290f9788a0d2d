//! What the fast path shows against an exact walk through the voxels, both ways; and that what is
//! thin stays in the picture.
//!
//! Planted faults, and what catches each (tried by hand):
//! - `constants.rs`, `FAST_STEP`: 1.65 made 2.2 -> `exact_hits_and_fast_hits`, plates, rods.
//! - `thin.rs`: `PLATE` made 0 -> plates; `ROD` made 230 -> rods.
//! - `fast.rs`: the surface where the density is 0.35 -> grooves, `exact_hits_and_fast_hits`.
//! - `fast.rs`, `meet`: the first sample inside is the surface -> `exact_hits_and_fast_hits`.
//! - `field/mod.rs`, `free`: a cell more -> all; `texels.rs`, `sample`: places off by 0.3 -> all but
//!   rods.

use std::sync::Mutex;

use glam::Vec3;
use paros_core::bake::{Baker, Up};
use paros_core::maps::Maps;
use paros_core::plane::Plane;
use paros_shaders::fast;
use paros_shaders::field::Field;
use paros_shell::figures::Figure;
use paros_tests::models::dense::{Dense, volumes as small};
use paros_tests::models::exact;
use paros_tests::models::shapes::real_mesh;
use paros_tests::models::view::{Picture, View, textures};
use proptest::prelude::*;
use rayon::prelude::*;

const N: usize = 128;
/// Pixels along a picture's side.
const SIDE: usize = 256;
/// Hits of neighbouring pixels that lie further apart in depth, in voxels, have an outline between.
const JUMP: f64 = 3.0;
/// Of the 125 voxels around one, so many at most are occupied at a convex corner, and empty in a
/// crease: on a flat face it is 75, along a straight edge 45.
const FEW: usize = 60;
/// How far from the fast surface an exact hit may lie, in voxels, and a fast one from the voxels.
const OFF: f32 = 1.0;

proptest! {
    /// The model itself, against small steps.
    #[test]
    fn the_exact_walk_misses_nothing(
        dense in small(16),
        from in proptest::array::uniform3(-30.0..46.0f64),
        to in proptest::array::uniform3(0.0..16.0f64),
    ) {
        let way: [f64; 3] = std::array::from_fn(|i| to[i] - from[i]);
        let length = way.iter().map(|c| c * c).sum::<f64>().sqrt();
        prop_assume!(length > 1.0 && from.iter().any(|c| !(0.0..16.0).contains(c)));
        let way = way.map(|c| c / length);
        let place = |distance: f64| std::array::from_fn(|i| from[i] + way[i] * distance);
        let voxel = |at: [f64; 3]| at.map(|c| c.floor() as i32);
        let entry = exact::first(&dense, from, way);
        let end = entry.as_ref().map_or(100.0, |entry| entry.distance - 1e-6);
        for i in 0..(end.max(0.0) * 100.0) as usize {
            prop_assert!(!dense.contains(voxel(place(i as f64 * 0.01))), "{entry:?}");
        }
        if let Some(entry) = entry {
            prop_assert!(dense.contains(entry.voxel) && !dense.contains(entry.before));
            let off = |at: f64, low: i32| (f64::from(low) - at).max(at - f64::from(low) - 1.0);
            for voxel in [entry.voxel, entry.before] {
                let at: [f64; 3] = place(entry.distance);
                prop_assert!((0..3).all(|i| off(at[i], voxel[i]) < 1e-6), "{entry:?}");
            }
        }
    }
}

/// Away from outlines. The blur cuts convex corners, and two voxels are granted there. It would fill
/// creases as much, but for those that are opened.
#[test]
fn exact_hits_and_fast_hits_lie_together() {
    for (name, dense) in volumes() {
        let (_, field) = textures::<N>(&dense);
        let at = Vec3::new(64.0, 60.0, 64.0);
        for (i, (way, from)) in [
            ([0.4, 0.2, 1.0], [300.0, 150.0]),
            ([-0.7, 0.8, 0.5], [400.0, 150.0]),
            ([0.0, 0.0, -1.0], [400.0, 140.0]),
            ([0.9, 0.1, -0.6], [110.0, 50.0]),
        ]
        .into_iter()
        .enumerate()
        {
            let picture = Picture::new(&dense, &field, View::new(at, way, from, SIDE));
            check(&format!("{name}-{i}"), &dense, &field, &picture);
        }
    }
}

fn volumes() -> Vec<(&'static str, Dense)> {
    static MAPS: Mutex<Maps<N>> = Mutex::new(Maps::new());
    static PLANE: Mutex<Plane<N>> = Mutex::new(Plane::new());
    static BAKER: Mutex<Baker<N>> = Mutex::new(Baker::new());
    let (mut maps, mut plane) = (MAPS.lock().unwrap(), PLANE.lock().unwrap());
    let from = |[x, y, z]: [i32; 3], c: [f32; 3]| {
        Vec3::new(x as f32, y as f32, z as f32).distance(Vec3::from_array(c) - 0.5)
    };
    let pair = Dense::from_fn(N, |at| {
        from(at, [40.0, 36.0, 44.0]) < 34.0 || from(at, [84.0, 72.0, 80.0]) < 40.0 || at[1] < 10
    });
    let steps = Dense::from_fn(N, |[x, y, z]| y < 16 + 12 * (x / 18) && (z + y) % 128 > 18);
    let mut volumes = vec![("pair", pair.closure()), ("steps", steps.closure())];
    for figure in [Figure::Owl, Figure::Cat, Figure::Amphora] {
        figure.carve_into(&mut *plane, &mut *maps);
        volumes.push((figure.name(), Dense::from_maps(&maps)));
    }
    let bunny = real_mesh("stanford-bunny.obj");
    bunny.bake(Up::Y, &mut BAKER.lock().unwrap(), &mut maps, &mut plane).expect("a solid");
    volumes.push(("bunny", Dense::from_maps(&maps)));
    volumes
}

/// What surrounds a hit.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Place {
    Open,
    Convex,
    Crease,
}

impl Place {
    /// How far from the fast surface an exact hit may lie, in voxels.
    const fn most(self) -> f32 {
        match self {
            Place::Open | Place::Crease => OFF,
            Place::Convex => 2.0,
        }
    }
}

fn place(dense: &Dense, entry: &exact::Entry) -> Place {
    let around = |[x, y, z]: [i32; 3], full: bool| {
        let all = (0..125).map(|i| [x + i % 5 - 2, y + i / 5 % 5 - 2, z + i / 25 - 2]);
        // The ground goes on below the grid.
        all.filter(|&[x, y, z]| dense.contains([x, y.max(0), z]) == full).count()
    };
    if around(entry.voxel, true) <= FEW {
        Place::Convex
    } else if around(entry.before, false) <= FEW {
        Place::Crease
    } else {
        Place::Open
    }
}

/// An exact hit.
struct Seen {
    pixel: usize,
    place: Place,
    /// Whether it lies at most [`OFF`] from the fast surface, and at most as far as its place allows.
    near: bool,
    right: bool,
}

fn check(name: &str, dense: &Dense, field: &Field<N>, picture: &Picture) {
    let away = away_from_outlines(picture);
    let tested: Vec<usize> = (0..SIDE * SIDE).filter(|&pixel| away[pixel]).collect();
    let seen = |&pixel: &usize| {
        let place = place(dense, picture.exact[pixel].as_ref()?);
        let near = near_fast(field, picture, pixel, OFF);
        let right = near || place != Place::Open && near_fast(field, picture, pixel, place.most());
        Some(Seen { pixel, place, near, right })
    };
    let seen: Vec<Seen> = tested.par_iter().filter_map(seen).collect();
    let astray = |&pixel: &usize| {
        picture.fast[pixel].is_some_and(|at| !near_occupied(dense, at.position, OFF))
    };
    let stray = tested.iter().copied().filter(astray);
    let wrong = seen.iter().filter(|seen| !seen.right).map(|seen| seen.pixel);
    let red: Vec<usize> = stray.chain(wrong).collect();
    let off = |place| seen.iter().filter(|seen| seen.place == place && !seen.near).count();
    let (convex, creases) = (off(Place::Convex), off(Place::Crease));
    let hits = picture.exact.iter().flatten().count();
    println!(
        "{name}: {} of {hits} hits lie away from outlines; farther than a voxel from the fast \
         surface are {convex} at convex corners, {creases} in creases",
        seen.len()
    );
    let few = |some: usize| some * 200 <= seen.len();
    if !red.is_empty() || !few(convex) || !few(creases) || seen.len() * 2 < hits {
        let path = picture.write(&format!("fidelity-{name}"), &red);
        panic!("{name}: {} pixels are wrong: see {}", red.len(), path.display());
    }
}

/// Which pixels are farther than two voxels' projected width from any outline.
fn away_from_outlines(picture: &Picture) -> Vec<bool> {
    let mut away = vec![true; SIDE * SIDE];
    let distance = |i: usize| picture.exact[i].map(|entry| entry.distance);
    for i in 0..SIDE * SIDE {
        let (x, y) = (i % SIDE, i / SIDE);
        for (right, down) in [(1, 0), (0, 1)] {
            if x + right == SIDE || y + down == SIDE {
                continue;
            }
            let near = match (distance(i), distance(i + right + down * SIDE)) {
                (None, None) => continue,
                (Some(a), Some(b)) if (a - b).abs() <= JUMP => continue,
                (Some(a), Some(b)) => a.min(b),
                (Some(a), None) | (None, Some(a)) => a,
            };
            let between = [x as f32 + 0.5 * right as f32, y as f32 + 0.5 * down as f32];
            let radius = 2.0 * picture.view.focal / near as f32;
            picture.view.near(between, radius).for_each(|i| away[i] = false);
        }
    }
    away
}

/// Whether a pixel's exact hit lies at most so far from a point that the fast path shows.
fn near_fast(field: &Field<N>, picture: &Picture, pixel: usize, most: f32) -> bool {
    let at = picture.place(pixel).expect("a hit");
    let close = |to: Vec3| to.distance(at) <= most;
    if picture.fast[pixel].is_some_and(|fast| close(fast.position)) {
        return true;
    }
    let [right, up, _] = picture.view.axes;
    let steps = || (-20..=20).map(|i| i as f32 * most / 20.0);
    steps().any(|x| {
        steps().any(|y| {
            let ray = picture.view.towards(at + right * x + up * y);
            x * x + y * y <= most * most
                && fast::surface(field, &ray).is_some_and(|fast| close(fast.position))
        })
    })
}

/// Whether an occupied voxel lies at most so far from a point.
fn near_occupied(dense: &Dense, point: Vec3, most: f32) -> bool {
    let [x, y, z] = point.to_array().map(|c| c.floor() as i32);
    (0..125).any(|i| {
        let voxel = [x + i % 5 - 2, y + i / 5 % 5 - 2, z + i / 25 - 2];
        let low = Vec3::from_array(voxel.map(|c| c as f32));
        dense.contains(voxel) && point.distance(point.clamp(low, low + 1.0)) <= most
    })
}

/// Along the axes or nearly, along the faces' and the cube's diagonals, and between.
const WAYS: [[f32; 3]; 14] = [
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.02, 0.03, 1.0],
    [1.0, 0.02, 0.03],
    [0.03, 1.0, 0.02],
    [1.0, 1.0, 0.0],
    [0.0, 1.0, 1.0],
    [1.0, 0.0, 1.0],
    [1.0, 1.0, 1.0],
    [0.7, 0.4, -0.6],
    [0.2, 0.9, 0.3],
    [-0.9, 0.15, 0.3],
    [0.3, 0.1, -0.9],
];

/// Pictures of a volume of 64 voxels a side from everywhere, a voxel about four pixels wide.
fn pictures(dense: &Dense) -> impl Iterator<Item = (usize, Picture)> + use<> {
    let (_, field) = textures::<64>(dense);
    let dense = dense.clone();
    WAYS.into_iter().enumerate().map(move |(i, way)| {
        let view = View::new(Vec3::splat(32.0), way, [150.0, 56.0], 200);
        (i, Picture::new(&dense, &field, view))
    })
}

/// Of the pixels that show a thin shape exactly, so many at least show it on the fast path from
/// anywhere; and none is two voxels' width from one that does, as at a plate's corners: nothing breaks.
fn stays_whole(name: &str, dense: &Dense, least: f32) {
    for (i, picture) in pictures(dense) {
        let shown: Vec<usize> =
            (0..picture.exact.len()).filter(|&pixel| picture.exact[pixel].is_some()).collect();
        let kept = shown.iter().filter(|&&pixel| picture.fast[pixel].is_some()).count();
        let voxel = picture.view.focal / picture.view.eye.distance(Vec3::splat(32.0));
        let lost = |&pixel: &usize| {
            let side = picture.view.side;
            let at = [(pixel % side) as f32, (pixel / side) as f32];
            !picture.view.near(at, 2.0 * voxel).any(|near| picture.fast[near].is_some())
        };
        let part = kept as f32 / shown.len() as f32;
        let lost: Vec<usize> = shown.into_iter().filter(lost).collect();
        if part < least || !lost.is_empty() {
            let path = picture.write(&format!("{name}-{i}"), &lost);
            panic!("{name}, view {i}: {part} stays, {} gaps; see {}", lost.len(), path.display());
        }
    }
}

#[test]
fn plates_of_one_voxel_stay_visible() {
    for axis in 0..3 {
        let across = |v: [i32; 3]| (0..3).filter(|&i| i != axis).all(|i| (10..54).contains(&v[i]));
        let plate = Dense::from_fn(64, |v| v[axis] == 31 && across(v));
        stays_whole(&format!("plate-{axis}"), &plate, 0.88);
    }
}

/// Their edges are rounded off, so that they look thinner along a diagonal.
#[test]
fn rods_of_one_voxel_stay_visible() {
    for axis in 0..3 {
        let across = |v: [i32; 3]| (0..3).filter(|&i| i != axis).all(|i| v[i] == 31);
        let rod = Dense::from_fn(64, |v| (10..54).contains(&v[axis]) && across(v));
        stays_whole(&format!("rod-{axis}"), &rod, 0.45);
    }
}

/// Grooves across each face of a block, along both axes. Of the pixels that show what lies in them,
/// a voxel deep or more, 85 % show what lies half a voxel deep on the fast path, from anywhere;
/// 97 % of all; and they look at least 0.7 times as deep as they are.
#[test]
fn grooves_of_two_voxels_stay_visible() {
    let (mut all, mut all_kept) = (0, 0);
    for (face, across) in [(0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1)] {
        let groove = |v: [i32; 3]| v[face] >= 44 && [20, 21, 28, 29, 36, 37].contains(&v[across]);
        let block = Dense::from_fn(64, |v| v.iter().all(|c| (10..50).contains(c)) && !groove(v));
        let depth = |at: Vec3| 50.0 - at[face];
        for (i, picture) in pictures(&block) {
            let shown: Vec<usize> = (0..picture.exact.len())
                .filter(|&pixel| {
                    let before = picture.exact[pixel].is_some_and(|entry| groove(entry.before));
                    before && picture.place(pixel).is_some_and(|at| depth(at) >= 1.0)
                })
                .collect();
            let deep = |pixel: usize| picture.fast[pixel].map_or(0.0, |at| depth(at.position));
            let lost: Vec<usize> = shown.iter().copied().filter(|&i| deep(i) < 0.5).collect();
            let kept = shown.len() - lost.len();
            (all, all_kept) = (all + shown.len(), all_kept + kept);
            if shown.len() < 200 {
                continue;
            }
            let exact: f32 = shown.iter().filter_map(|&i| picture.place(i)).map(depth).sum();
            let look: f32 = shown.iter().map(|&i| deep(i)).sum();
            let (part, look) = (kept as f32 / shown.len() as f32, look / exact);
            if part < 0.85 || look < 0.7 {
                let path = picture.write(&format!("groove-{face}-{across}-{i}"), &lost);
                panic!("face {face}: {part} stay, {look} as deep; see {}", path.display());
            }
        }
    }
    println!("{all_kept} of {all} pixels show a groove");
    assert!(all_kept as f32 >= 0.97 * all as f32);
}
