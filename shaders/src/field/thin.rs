//! Preserves thin features: raises texels of plates, rods and single voxels that the blur leaves
//! below a half.
//!
//! The values here put the surface half a voxel from the centres of a long plate's and rod's outer voxels,
//! given the blurred densities beside them. A rod of one voxel stands out a little more, since rays step
//! over anything narrower.

use super::rows::{AtLeastHalfMasks, TexelRows};
use super::window::{BLUR_MARGIN, MARGIN_X, VoxelWindow, WINDOW_ROWS};

/// Density of a plate of one voxel, with a quarter beside it.
const PLATE: u8 = 191;
/// Density of a rod of one voxel, or of a single voxel, with 0.09 beside it.
const ROD: u8 = 255;
/// Density of a rod of one by two voxels.
const RIBBON: u8 = 217;
/// Density of a rod of two by two voxels, with a fifth beside it.
const SQUARE_ROD: u8 = 204;

/// Bit rows of the voxels that are thin along x, y and z.
#[derive(Clone, Copy, Default)]
struct ThinVoxels {
    /// Voxels whose neighbours are both empty.
    single: [u64; 3],
    /// Voxels in a run of one or two.
    at_most_two: [u64; 3],
}

/// Raises texels of thin features in `row_count` rows of each of `slice_count` slices, and updates
/// `at_least_half`. The outermost rows, slices and columns only serve as neighbours.
pub(super) fn raise_thin_features(
    window: &VoxelWindow,
    [row_count, slice_count]: [usize; 2],
    out: &mut TexelRows,
    at_least_half: &mut AtLeastHalfMasks,
) {
    let mut found = false;
    for z in 0..slice_count {
        for y in 0..row_count {
            let voxels = window.row(y + BLUR_MARGIN, z + BLUR_MARGIN);
            // Texels of at least a half need nothing.
            let weak = voxels & !at_least_half[z][y];
            if weak == 0 {
                continue;
            }
            found = true;
            for RaisedTexels { value, texels } in
                find_thin_texels(window, y + BLUR_MARGIN, z + BLUR_MARGIN)
            {
                raise_texels(out[z][y].as_flattened_mut(), texels & weak, value);
                at_least_half[z][y] |= texels & weak;
            }
        }
    }
    if found {
        raise_vanished_voxels(window, [row_count, slice_count], out, at_least_half);
    }
}

/// Texels of a row, as bits, and the value that they are raised to.
#[derive(Clone, Copy)]
struct RaisedTexels {
    value: u8,
    texels: u64,
}

impl RaisedTexels {
    const NONE: RaisedTexels = RaisedTexels { value: 0, texels: 0 };
}

/// Finds the texels to raise in a row of the window: those of plates, and of rods of three widths.
fn find_thin_texels(window: &VoxelWindow, window_y: usize, window_z: usize) -> [RaisedTexels; 4] {
    let (y, z) = (window_y, window_z);
    let here = find_voxels_thin_along_xyz(window, y, z);
    if here.at_most_two == [0; 3] {
        return [RaisedTexels::NONE; 4];
    }
    let beside = [
        find_voxels_thin_along_xyz(window, y - 1, z),
        find_voxels_thin_along_xyz(window, y + 1, z),
        find_voxels_thin_along_xyz(window, y, z - 1),
        find_voxels_thin_along_xyz(window, y, z + 1),
    ];
    // Returns the neighbours along x, y and z for which `of` holds.
    let around = |of: &dyn Fn(&ThinVoxels) -> u64| {
        let [below, above, before, behind] = [0, 1, 2, 3].map(|i| of(&beside[i]));
        let row = of(&here);
        [[row << 1, row >> 1], [below, above], [before, behind]]
    };
    let mut plates = 0;
    let mut rods = [0; 3];
    for axis in 0..3 {
        let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
        if here.single[axis] != 0 {
            let around = around(&|thin| thin.single[axis]);
            plates |= here.single[axis] & at_least_three_of_four(around[a], around[b]);
        }
        let pair = here.at_most_two[a] & here.at_most_two[b];
        if pair != 0 {
            let [one, other] = around(&|thin| thin.at_most_two[a] & thin.at_most_two[b])[axis];
            let found = pair & (one | other);
            let (single, either) =
                (here.single[a] & here.single[b], here.single[a] | here.single[b]);
            rods[0] |= found & single;
            rods[1] |= found & either & !single;
            rods[2] |= found & !either;
        }
    }
    [(PLATE, plates), (SQUARE_ROD, rods[2]), (RIBBON, rods[1]), (ROD, rods[0])]
        .map(|(value, texels)| RaisedTexels { value, texels })
}

/// Returns the bits that are set in at least three of four rows.
fn at_least_three_of_four([a, b]: [u64; 2], [c, d]: [u64; 2]) -> u64 {
    a & b & (c | d) | c & d & (a | b)
}

/// Finds the voxels of a row of the window that are in runs of one or two along each axis.
fn find_voxels_thin_along_xyz(
    window: &VoxelWindow,
    window_y: usize,
    window_z: usize,
) -> ThinVoxels {
    let (y, z) = (window_y, window_z);
    let row = window.row(y, z);
    if row == 0 {
        return ThinVoxels::default();
    }
    // Classifies the row by its four neighbours along an axis, two before it and two behind.
    let thin = |[a, b, d, e]: [u64; 4]| {
        let three = (b & a) | (b & d) | (d & e);
        (row & !b & !d, row & !three)
    };
    // Rows outside the window affect only results that aren't used.
    let at =
        |y: usize, z: usize| if y < WINDOW_ROWS && z < WINDOW_ROWS { window.row(y, z) } else { 0 };
    let (y_1, y_2, z_1, z_2) =
        (y.wrapping_sub(1), y.wrapping_sub(2), z.wrapping_sub(1), z.wrapping_sub(2));
    let x = thin([row << 2, row << 1, row >> 1, row >> 2]);
    let along_y = thin([at(y_2, z), at(y_1, z), at(y + 1, z), at(y + 2, z)]);
    let along_z = thin([at(y, z_2), at(y, z_1), at(y, z + 1), at(y, z + 2)]);
    ThinVoxels { single: [x.0, along_y.0, along_z.0], at_most_two: [x.1, along_y.1, along_z.1] }
}

/// Raises occupied voxels that still have no texel of a half in their 3 x 3 x 3 neighbourhood.
fn raise_vanished_voxels(
    window: &VoxelWindow,
    [row_count, slice_count]: [usize; 2],
    out: &mut TexelRows,
    at_least_half: &AtLeastHalfMasks,
) {
    // Only texels inside the box have all their neighbours.
    let inner = u64::MAX << MARGIN_X & u64::MAX >> MARGIN_X;
    for z in 1..slice_count - 1 {
        for y in 1..row_count - 1 {
            let weak = window.row(y + BLUR_MARGIN, z + BLUR_MARGIN) & !at_least_half[z][y] & inner;
            if weak == 0 {
                continue;
            }
            let around =
                at_least_half[z - 1..=z + 1].iter().flat_map(|slice| &slice[y - 1..=y + 1]);
            let near = around.fold(0, |all, row| all | row << 1 | row | row >> 1);
            raise_texels(out[z][y].as_flattened_mut(), weak & !near, ROD);
        }
    }
}

fn raise_texels(row: &mut [u8], mut texels: u64, least: u8) {
    while texels != 0 {
        let texel = &mut row[texels.trailing_zeros() as usize];
        *texel = (*texel).max(least);
        texels &= texels - 1;
    }
}
