//! Ten small sculptures, defined by code.

use paros_core::limits::INTERVALS;
use paros_core::volume::{BitSet as _, Grid};
use paros_shell::rmap;
use paros_shell::statics::{Resident, ResidentBitGrid};

/// Voxels along a side.
pub(crate) const SIDE: usize = 128;

/// A shape: returns `true` if a point is inside. `x` and `z` are voxels from the grid's vertical axis, `y`
/// from the ground.
type Shape = fn(f32, f32, f32) -> bool;

/// All shapes. Each stands on the ground in one piece.
pub(crate) const SHAPES: [Shape; 10] =
    [vase, bowl, twisted_column, ring, pyramid, arch, star, bust, heart, bored_cube];

/// Returns a shape's volume in the format that headsets send.
pub(crate) fn make_volume(shape: Shape) -> Vec<u8> {
    let mut bits = Grid::<SIDE>::lock_bit_grid();
    bits.clear();
    let middle = (SIDE as f32 - 1.0) / 2.0;
    for y in 0..SIDE {
        for z in 0..SIDE {
            let row = bits.row_mut(y, z);
            for x in 0..SIDE {
                let is_stone = shape(x as f32 - middle, y as f32, z as f32 - middle);
                row.insert_if(is_stone, x);
            }
        }
    }
    let mut maps = <Grid<SIDE> as Resident<SIDE, INTERVALS>>::lock_range_maps();
    bits.write_closure(&mut maps);
    let bytes = rmap::encode(&maps);
    maps.clear();
    bytes
}

fn vase(x: f32, y: f32, z: f32) -> bool {
    let belly = 26.0 + 14.0 * (y / 18.0).sin() - y / 16.0;
    let radius = x.hypot(z);
    y < 112.0 && radius < belly && (y < 8.0 || radius > belly - 7.0)
}

fn bowl(x: f32, y: f32, z: f32) -> bool {
    let foot = y < 14.0 && x.hypot(z) < 20.0;
    let from_centre = x.hypot(z).hypot(y - 62.0);
    foot || (y < 62.0 && from_centre < 52.0 && from_centre > 43.0)
}

fn twisted_column(x: f32, y: f32, z: f32) -> bool {
    let (sin, cos) = (y / 40.0).sin_cos();
    let (u, v) = (x * cos - z * sin, x * sin + z * cos);
    let is_base = y < 10.0 && x.abs().max(z.abs()) < 34.0;
    is_base || (y < 120.0 && u.abs().max(v.abs()) < 21.0)
}

fn ring(x: f32, y: f32, z: f32) -> bool {
    let is_base = y < 16.0 && x.hypot(z) < 30.0;
    let from_circle = (x.hypot(y - 66.0) - 40.0).hypot(z);
    is_base || from_circle < 11.0
}

fn pyramid(x: f32, y: f32, z: f32) -> bool {
    let step = (y / 14.0).floor();
    step < 8.0 && x.abs().max(z.abs()) < 54.0 - 6.5 * step
}

fn arch(x: f32, y: f32, z: f32) -> bool {
    let is_open = if y < 50.0 { x.abs() < 22.0 } else { x.hypot(y - 50.0) < 22.0 };
    y < 100.0 && x.abs() < 44.0 && z.abs() < 18.0 && !(is_open && y >= 6.0)
}

fn star(x: f32, y: f32, z: f32) -> bool {
    let angle = z.atan2(x) + y / 90.0;
    y < 104.0 && x.hypot(z) < 34.0 + 12.0 * (5.0 * angle).cos() - y / 8.0
}

fn bust(x: f32, y: f32, z: f32) -> bool {
    let is_plinth = y < 24.0 && x.abs().max(z.abs()) < 26.0;
    let is_neck = y < 70.0 && x.hypot(z) < 13.0;
    let is_head = (x / 24.0).hypot((y - 88.0) / 31.0).hypot(z / 26.0) < 1.0;
    let is_nose = z > 0.0 && (x / 6.0).hypot((y - 84.0) / 10.0).hypot((z - 24.0) / 9.0) < 1.0;
    is_plinth || is_neck || is_head || is_nose
}

fn heart(x: f32, y: f32, z: f32) -> bool {
    let is_base = y < 14.0 && x.abs() < 34.0 && z.abs() < 24.0;
    let (u, v) = (x / 36.0, (y - 66.0) / 36.0);
    let bulge = (u * u + v * v - 1.0).powi(3) - u * u * v.powi(3);
    is_base || (bulge < 0.0 && z.abs() < 17.0) || (y < 40.0 && x.hypot(z) < 12.0)
}

fn bored_cube(x: f32, y: f32, z: f32) -> bool {
    let up = y - 48.0;
    let is_bored = x.hypot(up) < 20.0 || z.hypot(up) < 20.0 || x.hypot(z) < 20.0 && y > 3.0;
    x.abs() < 46.0 && z.abs() < 46.0 && y < 96.0 && !is_bored
}
