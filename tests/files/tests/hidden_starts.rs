//! The stones that hide figures: each surrounds its figure, lies within the lump, and is as thick as
//! specified.

use std::sync::Mutex;

use paros_core::RangeMaps;
use paros_core::volume::{BitGrid, BitSet, Grid, Size};
use paros_shell::figures::{Figure, HiddenStart, StoneThickness};

/// Maps and voxels of a figure, of a stone and of the lump.
struct Rasters<const N: usize>
where
    Grid<N>: Size,
{
    maps: RangeMaps<N, 2>,
    lump_maps: RangeMaps<N, 2>,
    figure: BitGrid<N>,
    stone: BitGrid<N>,
    lump: BitGrid<N>,
}

impl<const N: usize> Rasters<N>
where
    Grid<N>: Size,
{
    const fn new() -> Self {
        Rasters {
            maps: RangeMaps::new(),
            lump_maps: RangeMaps::new(),
            figure: BitGrid::new(),
            stone: BitGrid::new(),
            lump: BitGrid::new(),
        }
    }

    /// Rasterizes the lump, and each figure with its stones of several thicknesses. Calls `check` with each
    /// start and its rasters, all starts of a figure in a row.
    fn for_each_start(
        &mut self,
        thicknesses: &[StoneThickness],
        mut check: impl FnMut(HiddenStart, &Self),
    ) {
        Figure::Lump.rasterize_into(&mut self.lump_maps, &mut self.lump);
        for figure in Figure::HIDDEN {
            figure.rasterize_into(&mut self.maps, &mut self.figure);
            for &thickness in thicknesses {
                let start = HiddenStart { figure, thickness };
                self.maps.copy_from(&self.lump_maps);
                start.rasterize_stone_into(&mut self.maps, &mut self.stone);
                check(start, self);
            }
        }
    }
}

/// Returns `true` if one set of voxels lies within another.
fn is_within<const N: usize>(inner: &BitGrid<N>, outer: &BitGrid<N>) -> bool
where
    Grid<N>: Size,
{
    (0..N * N).all(|row| {
        let (y, z) = (row % N, row / N);
        (inner.row(y, z) & !outer.row(y, z)).is_empty()
    })
}

fn stones_lie_between_figure_and_lump<const N: usize>(rasters: &mut Rasters<N>)
where
    Grid<N>: Size,
{
    let mut least = [u64::MAX; 3];
    rasters.for_each_start(&StoneThickness::ALL, |start, Rasters { figure, stone, lump, .. }| {
        assert!(is_within(figure, stone), "{} of {N}", start.name());
        assert!(is_within(stone, lump), "{} of {N}", start.name());
        let counts = [stone, lump].map(BitGrid::count_voxels);
        let whole = start.thickness == StoneThickness::Whole;
        assert_eq!(counts[0] == counts[1], whole, "{} of {N}: {counts:?}", start.name());
        let to_carve = counts[0] - figure.count_voxels();
        println!("{} of {N}: {to_carve} voxels to carve", start.name());
        let least = &mut least[start.thickness as usize];
        *least = (*least).min(to_carve);
    });
    assert!(least[0] > least[1] && least[1] > least[2] && least[2] > 0, "{least:?}");
}

#[test]
fn each_stone_lies_between_its_figure_and_the_lump() {
    static RASTERS: Mutex<Rasters<128>> = Mutex::new(Rasters::new());
    stones_lie_between_figure_and_lump(&mut RASTERS.lock().unwrap());
}

#[test]
#[ignore = "nightly: 20 s"]
fn each_stone_of_fine_voxels_lies_between_its_figure_and_the_lump() {
    static RASTERS: Mutex<Rasters<256>> = Mutex::new(Rasters::new());
    stones_lie_between_figure_and_lump(&mut RASTERS.lock().unwrap());
}

/// Returns the distance in millimetres from each voxel to a set of voxels at 128, by a 3-4-5 chamfer distance
/// (Borgefors 1986), which is within a twelfth of the Euclidean distance.
fn distances_mm(set: &BitGrid<128>) -> Vec<f32> {
    const N: usize = 128;
    // One voxel of margin on all sides, which is far from the set.
    const M: usize = N + 2;
    const FAR: u16 = u16::MAX / 2;
    let mut field = vec![FAR; M * M * M];
    let index = |[x, y, z]: [usize; 3]| x + 1 + M * (y + 1 + M * (z + 1));
    let voxels = || (0..N * N * N).map(|i| [i % N, i / N % N, i / (N * N)]);
    voxels().filter(|&voxel| set.contains(voxel)).for_each(|voxel| field[index(voxel)] = 0);
    // The half of a voxel's neighbours that come before it in scan order: their offsets backwards, and their
    // distances.
    let before: Vec<(usize, u16)> = (0..27)
        .map(|i| [i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1])
        .filter(|&[x, y, z]: &[isize; 3]| (z, y, x) < (0, 0, 0))
        .map(|[x, y, z]| {
            let back = -(x + M as isize * (y + M as isize * z));
            (back as usize, 2 + [x, y, z].map(|k| k.unsigned_abs() as u16).iter().sum::<u16>())
        })
        .collect();
    for is_forwards in [true, false] {
        for step in 0..N * N * N {
            let i = if is_forwards { step } else { N * N * N - 1 - step };
            let at = index([i % N, i / N % N, i / (N * N)]);
            let mut nearest = field[at];
            for (back, length) in &before {
                let other = if is_forwards { at - back } else { at + back };
                nearest = nearest.min(field[other] + length);
            }
            field[at] = nearest;
        }
    }
    voxels().map(|voxel| f32::from(field[index(voxel)]) / 3.0 * 450.0 / 128.0).collect()
}

#[test]
fn each_stone_is_as_thick_as_it_says() {
    static RASTERS: Mutex<Rasters<128>> = Mutex::new(Rasters::new());
    let mut of_figure = (None, Vec::new());
    let thicknesses = [StoneThickness::Half, StoneThickness::Near];
    RASTERS.lock().unwrap().for_each_start(&thicknesses, |start, rasters| {
        if of_figure.0 != Some(start.figure) {
            of_figure = (Some(start.figure), distances_mm(&rasters.figure));
        }
        assert_stone_is_as_thick_as_it_says(start, rasters, &of_figure.1);
    });
}

fn assert_stone_is_as_thick_as_it_says(
    start: HiddenStart,
    Rasters { stone, lump, .. }: &Rasters<128>,
    distances: &[f32],
) {
    let thickness_mm = if start.thickness == StoneThickness::Half { 45.0 } else { 20.0 };
    let (mut near, mut missing, mut far, mut all) = (0, 0, 0, 0);
    for (i, distance) in distances.iter().enumerate() {
        let voxel = [i % 128, i / 128 % 128, i / (128 * 128)];
        if lump.contains(voxel) && *distance < 0.6 * thickness_mm {
            near += 1;
            missing += u32::from(!stone.contains(voxel));
        }
        if stone.contains(voxel) {
            all += 1;
            far += u32::from(*distance > 1.5 * thickness_mm);
        }
    }
    println!("{}: {missing} of {near} are missing, {far} of {all} are far", start.name());
    assert!(missing == 0, "{}: {missing} of {near} voxels are missing", start.name());
    assert!(far * 50 < all, "{}: {far} of {all} voxels are far", start.name());
}
