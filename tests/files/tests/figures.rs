//! The start volumes: solid, standing, printable, hidden in the lump, and bit-identical on every platform.

use std::sync::Mutex;

use paros_core::RangeMaps;
use paros_core::volume::{Axis, BitGrid, BitSet, Grid, Size};
use paros_shell::figures::Figure;
use paros_shell::rmap;

static MAPS: Mutex<RangeMaps<128>> = Mutex::new(RangeMaps::new());
static PLANE: Mutex<BitGrid<128>> = Mutex::new(BitGrid::new());

/// Runs `check` on every figure at 128.
fn for_each_figure(
    figures: &[Figure],
    mut check: impl FnMut(Figure, &BitGrid<128>, &RangeMaps<128>),
) {
    let mut maps = MAPS.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    let mut plane = PLANE.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    for &figure in figures {
        figure.rasterize_into(&mut *maps, &mut *plane);
        check(figure, &plane, &maps);
    }
}

fn all_voxels<const N: usize>() -> impl Iterator<Item = [usize; 3]> {
    (0..N * N * N).map(|i| [i % N, i / N % N, i / (N * N)])
}

/// File length and checksum of each figure at 128 and at 256.
type Golden = (usize, u32);
const GOLDENS: [(Figure, Golden, Golden); 6] = [
    (Figure::Lump, (98_320, 0xbe3c_8396), (393_232, 0xea82_a7b9)),
    (Figure::Owl, (98_320, 0xb04f_c573), (393_232, 0xb3bf_2415)),
    (Figure::Cat, (98_320, 0x8820_45de), (393_232, 0x4903_d0ae)),
    (Figure::Amphora, (98_320, 0x32c7_f897), (393_232, 0xafbf_2ef4)),
    (Figure::Dolphin, (98_320, 0x9ffc_1430), (393_232, 0xa514_2495)),
    (Figure::Toy, (98_320, 0xd20e_c882), (393_232, 0x8451_7744)),
];

#[test]
fn every_figure_is_the_same_bits_as_ever() {
    static MAPS: Mutex<RangeMaps<256>> = Mutex::new(RangeMaps::new());
    static PLANE: Mutex<BitGrid<256>> = Mutex::new(BitGrid::new());
    let (mut large, mut plane) = (MAPS.lock().unwrap(), PLANE.lock().unwrap());
    let mut found = Vec::new();
    for_each_figure(&Figure::ALL, |figure, _, maps| {
        figure.rasterize_into(&mut *large, &mut *plane);
        let small = (rmap::encode(maps).len(), rmap::volume_checksum(maps));
        found.push((figure, small, (rmap::encode(&*large).len(), rmap::volume_checksum(&*large))));
    });
    assert_eq!(found, GOLDENS, "found {found:#x?}");
}

/// Computes the closure of a set of voxels by scanning every column.
fn dense_closure<const N: usize>(set: &[bool]) -> Vec<bool> {
    let at = |[x, y, z]: [usize; 3]| set[x + N * (y + N * z)];
    let between = |voxel: [usize; 3], axis: usize| {
        let along = |i| {
            let mut other = voxel;
            other[axis] = i;
            at(other)
        };
        (0..=voxel[axis]).any(along) && (voxel[axis]..N).any(along)
    };
    all_voxels::<N>().map(|voxel| (0..3).all(|axis| between(voxel, axis))).collect()
}

fn matches_dense<const N: usize>(plane: &mut BitGrid<N>, maps: &mut RangeMaps<N>)
where
    Grid<N>: Size,
{
    for figure in Figure::ALL {
        figure.rasterize_into(maps, plane);
        let shape: Vec<bool> =
            all_voxels::<N>().map(|voxel| figure.contains_voxel_centre::<N>(voxel)).collect();
        let closed = dense_closure::<N>(&shape);
        for (voxel, expected) in all_voxels::<N>().zip(closed) {
            assert_eq!(plane.contains(voxel), expected, "{figure:?} at {voxel:?} of {N}");
            assert_eq!(maps.contains(voxel), expected, "{figure:?} at {voxel:?} of {N}");
        }
    }
}

#[test]
fn blocks_settled_whole_are_those_of_voxels_asked_one_by_one() {
    static MAPS_16: Mutex<RangeMaps<16>> = Mutex::new(RangeMaps::new());
    static PLANE_16: Mutex<BitGrid<16>> = Mutex::new(BitGrid::new());
    static MAPS_64: Mutex<RangeMaps<64>> = Mutex::new(RangeMaps::new());
    static PLANE_64: Mutex<BitGrid<64>> = Mutex::new(BitGrid::new());
    matches_dense(&mut *PLANE_16.lock().unwrap(), &mut *MAPS_16.lock().unwrap());
    matches_dense(&mut *PLANE_64.lock().unwrap(), &mut *MAPS_64.lock().unwrap());
}

#[test]
fn full_size_figures_are_their_shapes() {
    for_each_figure(&Figure::ALL, |figure, plane, _| {
        // Closure only adds voxels: every voxel that the shape covers is set, and few others are.
        let (mut covered, mut missing) = (0, 0);
        for voxel in all_voxels::<128>().filter(|&voxel| figure.contains_voxel_centre::<128>(voxel))
        {
            covered += 1;
            missing += u64::from(!plane.contains(voxel));
        }
        assert_eq!(missing, 0, "{figure:?}");
        let added = plane.count_voxels() - covered;
        println!("{figure:?}: closure adds {added} to {covered} voxels");
        assert!(added < covered / 40, "{figure:?}: closure adds {added} to {covered} voxels");
    });
}

/// Returns the number of voxels in the six-connected part that contains `start`.
fn connected_count(plane: &BitGrid<128>, start: [usize; 3]) -> u64 {
    let mut seen = vec![false; 128 * 128 * 128];
    let index = |[x, y, z]: [usize; 3]| x + 128 * (y + 128 * z);
    let (mut stack, mut count) = (vec![start], 0);
    seen[index(start)] = true;
    while let Some(voxel) = stack.pop() {
        count += 1;
        for axis in 0..3 {
            for step in [1, usize::MAX] {
                let mut next = voxel;
                next[axis] = voxel[axis].wrapping_add(step);
                if next[axis] < 128 && plane.contains(next) && !seen[index(next)] {
                    seen[index(next)] = true;
                    stack.push(next);
                }
            }
        }
    }
    count
}

#[test]
fn figures_are_one_piece_on_the_ground() {
    for_each_figure(&Figure::ALL, |figure, plane, _| {
        let ground = plane.layer(0);
        let z = ground.iter().position(|row| !row.is_empty()).expect("stands on the ground");
        let x = ground[z].first().expect("a row that holds a voxel");
        let area: u32 = ground.iter().map(BitSet::count_ones).sum();
        assert!(area > 500, "{figure:?} stands on {area} voxels");
        assert_eq!(
            connected_count(plane, [x, 0, z]),
            plane.count_voxels(),
            "{figure:?} is in pieces"
        );
    });
}

#[test]
fn hidden_figures_lie_within_the_lump() {
    static LUMP: Mutex<BitGrid<128>> = Mutex::new(BitGrid::new());
    let mut lump = LUMP.lock().unwrap();
    for_each_figure(&[Figure::Lump], |_, plane, _| lump.copy_from(plane));
    assert!(lump.count_voxels() > 128 * 128 * 128 / 2, "the lump nearly fills its box");
    for_each_figure(&Figure::HIDDEN, |figure, plane, _| {
        for y in 0..128 {
            for z in 0..128 {
                let bare = plane.row(y, z) & !lump.row(y, z);
                assert!(
                    bare.is_empty(),
                    "{figure:?} sticks out at {:?}",
                    [bare.first(), Some(y), Some(z)]
                );
            }
        }
        assert!(
            plane.count_voxels() * 3 < lump.count_voxels(),
            "{figure:?} leaves little to carve"
        );
    });
}

/// Returns the voxels that lie in no 2 x 2 x 2 block of the figure: crests, and walls and rods one voxel
/// thick.
fn thin_voxels(plane: &BitGrid<128>) -> Vec<[usize; 3]> {
    let row = |y: usize, z: usize| {
        if y < 128 && z < 128 { plane.row(y, z) } else { BitSet::EMPTY }
    };
    let block = |y: usize, z: usize| {
        let pillar = row(y, z) & row(y + 1, z) & row(y, z + 1) & row(y + 1, z + 1);
        pillar & pillar.shifted_down()
    };
    let mut thin = Vec::new();
    for y in 0..128 {
        for z in 0..128 {
            let mut thick = block(y, z);
            for (dy, dz) in [(1, 0), (0, 1), (1, 1)] {
                if y >= dy && z >= dz {
                    thick |= block(y - dy, z - dz);
                }
            }
            let lone = plane.row(y, z) & !(thick | thick.shifted_up());
            thin.extend(lone.iter_ones().map(|x| [x, y, z]));
        }
    }
    thin
}

/// Returns the size of the largest group of voxels connected by faces, edges or corners.
fn largest_group(mut voxels: Vec<[usize; 3]>) -> usize {
    let mut largest = 0;
    while let Some(first) = voxels.pop() {
        let (mut front, mut group) = (vec![first], 0);
        while let Some(voxel) = front.pop() {
            group += 1;
            let touches =
                |other: &[usize; 3]| (0..3).all(|axis| voxel[axis].abs_diff(other[axis]) <= 1);
            let (near, far) = voxels.into_iter().partition(touches);
            voxels = far;
            front.extend::<Vec<_>>(near);
        }
        largest = largest.max(group);
    }
    largest
}

#[test]
fn figures_have_no_thin_walls() {
    let printed = Figure::ALL.into_iter().filter(|&figure| figure != Figure::Lump);
    for_each_figure(&printed.collect::<Vec<_>>(), |figure, plane, _| {
        let thin = thin_voxels(plane);
        let (count, largest) = (thin.len(), largest_group(thin));
        println!("{figure:?}: {count} voxels stand proud, at most {largest} together");
        assert!(largest <= 12, "{figure:?}: {largest} thin voxels together");
    });
}

#[test]
fn maps_are_the_tight_hulls_of_the_plane() {
    for_each_figure(&Figure::ALL, |figure, plane, maps| {
        for axis in Axis::ALL {
            for address in (0..128 * 128).map(|i| (i / 128, i % 128)) {
                let mut along = (0..128).filter(|&i| plane.contains(axis.voxel_at(address, i)));
                let ends = along.next().map(|lo| (lo, along.next_back().unwrap_or(lo)));
                let range = maps.column(axis, address).hull();
                let found = (!range.is_empty()).then(|| (range.first(), range.last()));
                assert_eq!(found, ends, "{figure:?}, {axis:?} {address:?}");
            }
        }
    });
}

#[test]
fn names_find_their_figures() {
    for figure in Figure::ALL {
        assert_eq!(Figure::from_name(figure.name()), Some(figure));
        assert_eq!(Figure::ALL[figure as usize], figure);
    }
    assert_eq!(Figure::from_name("nobody"), None);
}
