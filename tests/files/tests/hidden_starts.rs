//! The stones that hide figures: each around its figure, within the lump, and as thick as it says.

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
            figure: BitGrid::new(),
            stone: BitGrid::new(),
            lump: BitGrid::new(),
        }
    }

    /// Rasterizes a start, and calls `check` with its figure, its stone and the lump.
    fn rasterize(&mut self, start: HiddenStart) {
        start.figure.rasterize_into(&mut self.maps, &mut self.figure);
        start.rasterize_stone_into(&mut self.maps, &mut self.stone);
        Figure::Lump.rasterize_into(&mut self.maps, &mut self.lump);
    }
}

/// Whether one set of voxels lies within another.
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
    for start in HiddenStart::ALL {
        rasters.rasterize(start);
        let Rasters { figure, stone, lump, .. } = &*rasters;
        assert!(is_within(figure, stone), "{} of {N}", start.name());
        assert!(is_within(stone, lump), "{} of {N}", start.name());
        let counts = [stone, lump].map(BitGrid::count_voxels);
        let whole = start.thickness == StoneThickness::Whole;
        assert_eq!(counts[0] == counts[1], whole, "{} of {N}: {counts:?}", start.name());
        let to_carve = counts[0] - figure.count_voxels();
        println!("{} of {N}: {to_carve} voxels to carve", start.name());
        let least = &mut least[start.thickness as usize];
        *least = (*least).min(to_carve);
    }
    assert!(least[0] > least[1] && least[1] > least[2] && least[2] > 0, "{least:?}");
}

#[test]
fn each_stone_lies_between_its_figure_and_the_lump() {
    static SMALL: Mutex<Rasters<128>> = Mutex::new(Rasters::new());
    static LARGE: Mutex<Rasters<256>> = Mutex::new(Rasters::new());
    stones_lie_between_figure_and_lump(&mut SMALL.lock().unwrap());
    stones_lie_between_figure_and_lump(&mut LARGE.lock().unwrap());
}

/// Millimetres from each voxel to a set of voxels at 128, by a chamfer distance of 3, 4 and 5 (Borgefors
/// 1986), which is within a twelfth of the Euclidean one.
fn distances_mm(set: &BitGrid<128>) -> Vec<f32> {
    const N: usize = 128;
    const FAR: u16 = u16::MAX / 2;
    let mut field: Vec<u16> = (0..N * N * N)
        .map(|i| if set.contains([i % N, i / N % N, i / (N * N)]) { 0 } else { FAR })
        .collect();
    // Half of a voxel's neighbours: those that come before it in the order of the field.
    let before: Vec<[isize; 3]> = (0..27)
        .map(|i| [i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1])
        .filter(|&[x, y, z]: &[isize; 3]| (z, y, x) < (0, 0, 0))
        .collect();
    let mut sweep = |forwards: bool| {
        for step in 0..field.len() {
            let i = if forwards { step } else { field.len() - 1 - step };
            let sign = if forwards { 1 } else { -1 };
            for offset in &before {
                let place = [i % N, i / N % N, i / (N * N)];
                let other = [0, 1, 2].map(|k| place[k].wrapping_add_signed(sign * offset[k]));
                if other.iter().any(|&k| k >= N) {
                    continue;
                }
                let length = 2 + offset.iter().map(|k| k.unsigned_abs() as u16).sum::<u16>();
                let reached = field[other[0] + N * (other[1] + N * other[2])] + length;
                field[i] = field[i].min(reached);
            }
        }
    };
    sweep(true);
    sweep(false);
    field.into_iter().map(|thirds| f32::from(thirds) / 3.0 * 450.0 / 128.0).collect()
}

#[test]
fn each_stone_is_as_thick_as_it_says() {
    static RASTERS: Mutex<Rasters<128>> = Mutex::new(Rasters::new());
    let mut rasters = RASTERS.lock().unwrap();
    for start in HiddenStart::ALL {
        let thickness_mm = match start.thickness {
            StoneThickness::Whole => continue,
            StoneThickness::Half => 45.0,
            StoneThickness::Near => 20.0,
        };
        rasters.rasterize(start);
        let Rasters { figure, stone, lump, .. } = &*rasters;
        let distances = distances_mm(figure);
        let (mut near, mut missing, mut far, mut all) = (0, 0, 0, 0);
        for (i, distance) in distances.into_iter().enumerate() {
            let voxel = [i % 128, i / 128 % 128, i / (128 * 128)];
            if lump.contains(voxel) && distance < 0.6 * thickness_mm {
                near += 1;
                missing += u32::from(!stone.contains(voxel));
            }
            if stone.contains(voxel) {
                all += 1;
                far += u32::from(distance > 1.5 * thickness_mm);
            }
        }
        println!("{}: {missing} of {near} are missing, {far} of {all} are far", start.name());
        assert!(missing == 0, "{}: {missing} of {near} voxels are missing", start.name());
        assert!(far * 50 < all, "{}: {far} of {all} voxels are far", start.name());
    }
}
