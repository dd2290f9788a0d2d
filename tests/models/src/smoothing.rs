//! Model of smoothing: counts the voxels of a cube one by one.

use paros_core::edit::{Dither, EditOperation};
use paros_core::internals::{BrushPiece, mix_bits};

use crate::dense::DenseVolume;

type Voxel = [i32; 3];

/// The rule of a smoothing edit, as documented at [`EditOperation::Smooth`](paros_core::edit::EditOperation).
#[derive(Clone, Copy, Debug)]
pub struct Smoothing {
    /// Half-side of the cube: the number of voxels on each side of the middle one.
    pub radius: i32,
    /// The dithering of the threshold, if any.
    pub dither: Option<Dither>,
    /// `true` if the edit includes the brush's mirror image.
    pub is_mirrored: bool,
}

impl Smoothing {
    /// Returns the rule of an operation, or `None` if it doesn't smooth.
    pub fn of(operation: EditOperation, is_mirrored: bool) -> Option<Self> {
        match operation {
            EditOperation::Smooth { radius, dither } => {
                Some(Smoothing { radius: radius as i32, dither, is_mirrored })
            }
            _ => None,
        }
    }

    /// Returns `true` if a voxel of the brush is occupied after the edit, before closure.
    pub fn is_occupied_after(&self, volume: &DenseVolume, voxel: Voxel) -> bool {
        let mirrored = [volume.side() as i32 - 1 - voxel[0], voxel[1], voxel[2]];
        let is_in = |piece: &BrushPiece| {
            holds(piece, voxel, volume.side())
                || self.is_mirrored && holds(piece, mirrored, volume.side())
        };
        let side = 2 * self.radius + 1;
        let mut occupied = 0;
        let [xs, ys, zs] = voxel.map(|i| i - self.radius..=i + self.radius);
        for (y, z) in ys.flat_map(|y| zs.clone().map(move |z| (y, z))) {
            for x in xs.clone() {
                occupied += i32::from(y < 0 || volume.contains([x, y, z]));
            }
        }
        match self.dither {
            Some(dither) if is_in(&dither.piece) => {
                // Both halves of a mirrored edit use the same dither.
                let x = if self.is_mirrored { voxel[0].min(mirrored[0]) } else { voxel[0] };
                let u = dither_of([x, voxel[1], voxel[2]], dither.seed, side * side);
                2 * occupied > side.pow(3) - side.pow(2) + 2 * u
            }
            _ => 2 * occupied > side.pow(3),
        }
    }
}

/// Returns a number from 0 to `end - 1`, determined by voxel and seed.
fn dither_of([x, y, z]: Voxel, seed: u64, end: i32) -> i32 {
    let index = x + 256 * y + 256 * 256 * z;
    let random = mix_bits(seed ^ mix_bits(index as u64 + 1)) >> 32;
    (random * end as u64 / (1 << 32)) as i32
}

/// Returns `true` if a piece contains a voxel of a grid of this side.
fn holds(piece: &BrushPiece, [x, y, z]: Voxel, side: usize) -> bool {
    let row = piece.x_range(y as usize, z as usize, side);
    row.is_some_and(|row| row.contains(x as usize))
}
