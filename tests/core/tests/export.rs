//! Export against the model's surface, and the invariants of a printable mesh: closed, oriented, no triangle
//! without area.

use std::collections::{HashMap, HashSet};
use std::sync::Mutex;

use paros_core::convert::{ExportPhase, ExportProgress, HeightOutOfRange};
use paros_core::volume::{BitGrid, Grid, Size};
use paros_core::{Exporter, RangeMaps};
use paros_models::cases::random_cases;
use paros_models::dense::{self, DenseVolume};
use paros_models::export::{SurfaceModel, exported_voxels};
use proptest::prelude::*;

const HEIGHT_MM: f32 = 120.0;

struct ExportHarness<const N: usize>
where
    Grid<N>: Size,
{
    exporter: Exporter<N>,
    rows: BitGrid<N>,
    mask: RangeMaps<N>,
}

impl<const N: usize> ExportHarness<N>
where
    Grid<N>: Size,
{
    const fn new() -> Self {
        ExportHarness { exporter: Exporter::new(), rows: BitGrid::new(), mask: RangeMaps::new() }
    }

    fn set(&mut self, volume: &DenseVolume, mask: &DenseVolume) {
        self.rows.clear();
        volume.insert_into_empty_bits(&mut self.rows);
        mask.write_maps(&mut self.mask);
    }

    /// Exports the whole file in one call with an ample but finite budget, so that an endless export fails.
    fn export_at_once(&mut self) -> Vec<u8> {
        // Each voxel is a corner of eight cells, and a cell has five triangles at most.
        let cells = (8 * self.rows.count_voxels() as usize).min((N + 1).pow(3));
        let mut file = vec![0; 84 + 50 * 5 * cells];
        let budget = 100 * (N as u32).pow(3);
        self.exporter.start_export(HEIGHT_MM).unwrap();
        let progress = self.exporter.advance_export(&self.rows, &self.mask, budget, &mut file);
        assert_eq!(progress.phase, ExportPhase::Done);
        file.truncate(progress.written);
        assert_eq!(self.exporter.file_len(), Some(file.len() as u64));
        file
    }

    fn check_export(&mut self, volume: &DenseVolume, mask: &DenseVolume) {
        self.set(volume, mask);
        let file = self.export_at_once();
        check_model(&exported_voxels(volume, mask), &file);
    }
}

/// One static harness for all tests of a grid size: exporters are too large for the stack.
macro_rules! harness {
    ($n:literal, $use:expr) => {{
        static HARNESS: Mutex<ExportHarness<$n>> = Mutex::new(ExportHarness::new());
        let mut harness = HARNESS.lock().unwrap_or_else(|held| held.into_inner());
        #[allow(clippy::redundant_closure_call)]
        ($use)(&mut *harness)
    }};
}

/// Parses a binary STL file: the normal and three corners of each triangle.
fn parse_triangles(file: &[u8]) -> Vec<[[f32; 3]; 4]> {
    let count = u32::from_le_bytes(file[80..84].try_into().unwrap());
    assert_eq!(file.len(), 84 + 50 * count as usize);
    assert!(!file.starts_with(b"solid"));
    let float = |bytes: &[u8]| f32::from_le_bytes(bytes.try_into().unwrap());
    let record = |bytes: &[u8]| {
        assert_eq!(bytes[48..], [0, 0]);
        [0, 1, 2, 3].map(|p| [0, 1, 2].map(|c| float(&bytes[12 * p + 4 * c..][..4])))
    };
    file[84..].chunks_exact(50).map(record).collect()
}

/// Returns the expected position of each vertex of a surface, in millimetres.
fn expected_positions(surface: &SurfaceModel) -> Vec<[f32; 3]> {
    let bounds = |axis: usize| {
        let along = || surface.smooth.iter().map(|v| v[axis]);
        (along().min().unwrap_or(0), along().max().unwrap_or(0))
    };
    let [x, y, z] = [0, 1, 2].map(bounds);
    let scale = HEIGHT_MM / (y.1 - y.0) as f32;
    let [x_middle, z_middle] = [x, z].map(|(lo, hi)| (lo + hi) as f32 / 2.0);
    let place = |&[x, height, z]: &[i32; 3]| {
        [x as f32 - x_middle, z_middle - z as f32, (height - y.0) as f32].map(|c| c * scale)
    };
    surface.smooth.iter().map(place).collect()
}

fn float_bits(point: [f32; 3]) -> [u32; 3] {
    point.map(f32::to_bits)
}

fn check_model(solid: &DenseVolume, file: &[u8]) {
    let surface = SurfaceModel::from_voxels(solid);
    let mut ids = HashMap::new();
    for (id, point) in expected_positions(&surface).into_iter().enumerate() {
        assert_eq!(ids.insert(float_bits(point), id), None, "two vertices in one place");
    }
    let records = parse_triangles(file);
    assert_eq!(records.len(), surface.triangles);
    let mut sides = HashSet::new();
    let mut six_volumes = 0;
    for [normal, corners @ ..] in records {
        let corners = corners.map(|corner| ids[&float_bits(corner)]);
        for (from, to) in [(0, 1), (1, 2), (2, 0)] {
            let new = sides.insert([corners[from], corners[to]]);
            assert!(new, "a side with two triangles on it");
        }
        // In STL axes.
        let [a, b, c] =
            corners.map(|id| surface.smooth[id]).map(|[x, y, z]| [x, -z, y].map(i64::from));
        let cross = cross(subtract(b, a), subtract(c, a));
        assert_ne!(cross, [0; 3], "a triangle without area");
        let length = (dot(cross, cross) as f64).sqrt();
        for axis in 0..3 {
            assert!((cross[axis] as f64 / length - f64::from(normal[axis])).abs() < 1e-6);
        }
        six_volumes += dot(a, cross);
    }
    assert!(sides.iter().all(|&[from, to]| sides.contains(&[to, from])), "an open side");
    assert!(surface.segments.iter().all(|side| sides.contains(side)), "a contour not followed");
    assert!(solid.is_empty() || six_volumes > 0);
    for (raw, smooth) in surface.raw.iter().zip(&surface.smooth) {
        let moved = subtract(smooth.map(i64::from), raw.map(|c| 64 * i64::from(c)));
        assert!(dot(moved, moved) <= 128 * 128, "further than a voxel");
    }
}

fn subtract(a: [i64; 3], b: [i64; 3]) -> [i64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn cross(u: [i64; 3], v: [i64; 3]) -> [i64; 3] {
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}

fn dot(a: [i64; 3], b: [i64; 3]) -> i64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Tests all fillings of two adjacent cells along each axis, 48 in one grid with two empty voxels between
/// them, up to all its borders. The mask covers everything, so that all voxels are exported.
#[test]
fn every_pair_of_cells() {
    let all = DenseVolume::from_fn(16, |_| true);
    let (across, along) = ([0, 4, 9, 14], [0, 6, 13]);
    harness!(16, |harness: &mut ExportHarness<16>| for axis in 0..3 {
        for first in (0..4096).step_by(48) {
            let mut volume = DenseVolume::empty(16);
            for (place, solid) in (first..4096).take(48).enumerate() {
                let low = [across[place % 4], across[place / 4 % 4], along[place / 16]];
                for corner in (0..12i32).filter(|corner| solid >> corner & 1 == 1) {
                    let offset = [corner & 1, corner >> 1 & 1, corner >> 2];
                    let mut voxel = [0; 3];
                    (0..3).for_each(|i| voxel[(axis + i) % 3] = low[i] + offset[i]);
                    volume.set(voxel, true);
                }
            }
            harness.check_export(&volume, &all);
        }
    });
}

/// Tests every filling of a cell in the middle of the grid, where only the largest part is exported.
#[test]
fn every_cell_without_ground() {
    let none = DenseVolume::empty(16);
    harness!(16, |harness: &mut ExportHarness<16>| for solid in 0..256 {
        let volume = DenseVolume::from_fn(16, |[x, y, z]| {
            [x, y, z].iter().all(|i| (7..9).contains(i))
                && solid >> ((x - 7) + 2 * (y - 7) + 4 * (z - 7)) & 1 == 1
        });
        harness.check_export(&volume, &none);
    });
}

proptest! {
    #![proptest_config(random_cases(60))]

    #[test]
    fn anything_at_16(dense::MaskedVolume { volume, mask } in dense::closed_volumes_with_inner_mask(16)) {
        harness!(16, |harness: &mut ExportHarness<16>| harness.check_export(&volume, &mask));
    }

    /// Tests volumes without ground and mask, where only the largest part is exported.
    #[test]
    fn anything_afloat_at_16(volume in dense::any_voxels(16)) {
        let none = DenseVolume::empty(16);
        let volume = DenseVolume::from_fn(16, |voxel| voxel[1] > 0 && volume.contains(voxel));
        harness!(16, |harness: &mut ExportHarness<16>| harness.check_export(&volume, &none));
    }

    /// Tests volumes that range maps can't represent: the exporter reads rows.
    #[test]
    fn anything_unclosed_at_16(volume in dense::any_voxels(16), held in any::<bool>()) {
        let mask = DenseVolume::from_fn(16, |_| held);
        harness!(16, |harness: &mut ExportHarness<16>| harness.check_export(&volume, &mask));
    }
}

proptest! {
    #![proptest_config(random_cases(1))]

    /// Tests rows of exactly one word.
    #[test]
    fn anything_at_64(volume in dense::any_voxels(64)) {
        let mask = DenseVolume::empty(64);
        harness!(64, |harness: &mut ExportHarness<64>| harness.check_export(&volume, &mask));
    }
}

proptest! {
    #![proptest_config(random_cases(20))]

    /// Calls with any budget and buffer size write the same file.
    #[test]
    fn any_budget(
        volume in dense::any_voxels(32),
        budgets in proptest::collection::vec(1..3000u32, 1..20),
        rooms in proptest::collection::vec(0..8000usize, 1..20),
    ) {
        let mask = DenseVolume::empty(32);
        harness!(32, |harness: &mut ExportHarness<32>| {
            harness.set(&volume, &mask);
            let file = harness.export_at_once();
            let mut pieces = Vec::new();
            let ExportHarness { exporter, rows, mask } = harness;
            exporter.start_export(HEIGHT_MM).unwrap();
            let mut room = vec![0; Exporter::<32>::MIN_BUFFER];
            for call in 0.. {
                let budget = budgets[call % budgets.len()];
                // Every other call gets a buffer of full size.
                let len = if call % 2 == 0 { room.len() } else { rooms[call % rooms.len()] };
                let ExportProgress { written, phase } =
                    exporter.advance_export(rows, mask, budget, &mut room[..len]);
                pieces.extend_from_slice(&room[..written]);
                if phase == ExportPhase::Done {
                    break;
                }
            }
            assert!(pieces == file);
        });
    }
}

/// Rows of two and four words, filled to the border in every direction, cross all word borders.
#[test]
fn large_grids() {
    fn volume(n: usize) -> DenseVolume {
        let middle = n as i32 / 2;
        let is_beam = |along: i32| (2 * along - 2 * middle + 1).abs() < 8;
        DenseVolume::from_fn(n, |[x, y, z]| {
            let axis_beams = (is_beam(x) && (is_beam(y) || is_beam(z))) || is_beam(y) && is_beam(z);
            // A floor in strips, with holes, near the borders of words and of the grid.
            let is_floor = y < 3 && ((x + 3) % 64 < 6 || z < 6 || z >= n as i32 - 6);
            axis_beams || is_floor && ((x + z) % 2 == 0 || y < 2 && x % 5 < 2)
        })
    }
    harness!(128, |harness: &mut ExportHarness<128>| harness
        .check_export(&volume(128), &DenseVolume::empty(128)));
    harness!(256, |harness: &mut ExportHarness<256>| harness
        .check_export(&volume(256), &DenseVolume::empty(256)));
}

#[test]
fn largest_of_the_parts_of_one_row() {
    let none = DenseVolume::empty(16);
    harness!(16, |harness: &mut ExportHarness<16>| for parts in
        [[1..3, 5..12], [1..8, 10..13], [0..3, 13..16]]
    {
        let volume = DenseVolume::from_fn(16, |[x, y, z]| {
            (y, z) == (7, 15) && parts.iter().any(|part| part.contains(&x))
        });
        harness.check_export(&volume, &none);
    });
}

#[test]
fn exact_room_is_room_enough() {
    harness!(16, |harness: &mut ExportHarness<16>| {
        let volume = DenseVolume::from_fn(16, |[x, y, z]| (x + y + z) % 3 == 0 || y == 0);
        harness.set(&volume, &DenseVolume::empty(16));
        let file = harness.export_at_once();
        let mut exact = vec![0; file.len()];
        harness.exporter.start_export(HEIGHT_MM).unwrap();
        let progress =
            harness.exporter.advance_export(&harness.rows, &harness.mask, u32::MAX, &mut exact);
        assert_eq!(progress, ExportProgress { written: file.len(), phase: ExportPhase::Done });
        assert!(exact == file);
    });
}

#[test]
fn nothing_makes_an_empty_file() {
    harness!(16, |harness: &mut ExportHarness<16>| {
        harness.set(&DenseVolume::empty(16), &DenseVolume::empty(16));
        assert_eq!(harness.export_at_once().len(), 84);
        assert_eq!(harness.exporter.triangles(), Some(0));
    });
}

#[test]
fn heights_out_of_range_change_nothing() {
    harness!(16, |harness: &mut ExportHarness<16>| {
        harness.set(&DenseVolume::from_fn(16, |[_, y, _]| y < 3), &DenseVolume::empty(16));
        let file = harness.export_at_once();
        for height in [0.0, -1.0, 1e9, f32::INFINITY] {
            assert_eq!(harness.exporter.start_export(height), Err(HeightOutOfRange(height)));
        }
        assert!(harness.exporter.start_export(f32::NAN).is_err());
        assert_eq!(harness.exporter.file_len(), Some(file.len() as u64));
    });
}

#[test]
fn scratch_is_small() {
    assert!(size_of::<Exporter<128>>() <= 1 << 20);
    assert!(size_of::<Exporter<256>>() <= 4 << 20);
}
