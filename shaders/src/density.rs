//! A blurred copy of the volume whose iso-surface is smooth where the voxels are steps.
//!
//! Beyond the paper: its blobs know seven voxels, and show them. Here every voxel is averaged with
//! those two steps around it by binomial weights, and the surface is where half is full. What is
//! too thin for that (a sheet or a rod of one voxel) keeps its blobs.

use glam::Vec3;
use paros_core::maps::{Axis, Maps};
use rayon::prelude::*;

use crate::march::{Ray, Sample, inside_cube, occupied};
use crate::surface::{Surface, blobs};

/// Texels around the grid on each side, so that a surface on the cube's border is met as any other.
const PAD: usize = 3;
const WEIGHTS: [u16; 5] = [1, 4, 6, 4, 1];
/// Length of a step in search of the surface, in voxels.
const STEP: f32 = 0.5;
/// Texels along a side of the blocks that rays skip where they are empty.
const BLOCK: usize = 4;
/// No occupied voxel has less: one by itself keeps 216 of 4096.
const LEAST: u8 = 13;
/// How far from a point the slopes that give its normal are taken, in voxels. The near ones follow
/// the surface closely, the far ones level the steps.
const SLOPES: [f32; 2] = [1.0, 2.0];

/// Density in bytes, 255 where all is full, at the centres of a grid's voxels and a few around it.
/// Under the ground layer the volume continues as it is there.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Density {
    side: usize,
    texels: Vec<u8>,
    /// Blocks in or beside which a texel has at least LEAST.
    blocks: Vec<bool>,
}

impl Density {
    /// The density of a volume, made on all cores.
    #[must_use]
    pub fn of<const N: usize>(maps: &Maps<N>) -> Self {
        let side = N + 2 * PAD;
        // Blurred along x: 0 to 16.
        let mut rows = vec![0u8; side * side * side];
        rows.par_chunks_mut(side * side).enumerate().for_each(|(y, layer)| {
            // Copies of the ground layer lie under it.
            let y = y.saturating_sub(PAD);
            for (z, row) in (0..N).zip(layer.chunks_exact_mut(side).skip(PAD)).filter(|_| y < N) {
                let range = maps.column(Axis::X, Axis::X.address([0, y, z])).hull();
                for x in (range.lo()..=range.hi()).filter(|&x| maps.contains([x, y, z])) {
                    for (texel, weight) in row[x + PAD - 2..].iter_mut().zip(WEIGHTS) {
                        *texel += weight as u8;
                    }
                }
            }
        });
        let mut texels = vec![0u8; rows.len()];
        texels.par_chunks_mut(side * side).enumerate().for_each_init(
            || vec![0u16; side * side],
            |sums, (y, layer)| blur_layer(&rows, side, y, sums, layer),
        );
        let blocks = full_blocks(&texels, side);
        Density { side, texels, blocks }
    }

    /// The density at a point in voxels, 0 to 1, filtered trilinearly.
    #[must_use]
    pub fn at(&self, point: Vec3) -> f32 {
        let place = point + Vec3::splat(PAD as f32 - 0.5);
        let most = (self.side - 1) as f32;
        if !(place.min_element() >= 0.0 && place.max_element() < most) {
            return 0.0;
        }
        let [x, y, z] = place.to_array().map(|c| c as usize);
        let part = place - Vec3::new(x as f32, y as f32, z as f32);
        let texel = |y: usize, z: usize| {
            let i = (y * self.side + z) * self.side + x;
            let (a, b) = (f32::from(self.texels[i]), f32::from(self.texels[i + 1]));
            a + (b - a) * part.x
        };
        let line = |y| {
            let (a, b) = (texel(y, z), texel(y, z + 1));
            a + (b - a) * part.z
        };
        let (low, high) = (line(y), line(y + 1));
        (low + (high - low) * part.y) / 255.0
    }

    /// The density of the voxel that a point lies in, 0 to 1.
    #[must_use]
    #[inline]
    pub fn near(&self, point: Vec3) -> f32 {
        let place = point + Vec3::splat(PAD as f32);
        let most = self.side as f32;
        if !(place.min_element() >= 0.0 && place.max_element() < most) {
            return 0.0;
        }
        let [x, y, z] = place.to_array().map(|c| c as usize);
        f32::from(self.texels[(y * self.side + z) * self.side + x]) / 255.0
    }

    /// The outward normal of the surface of equal density through a point in voxels.
    #[must_use]
    pub fn normal(&self, point: Vec3) -> Vec3 {
        let slope = |axis: Vec3| {
            let pair = |step: f32| self.at(point - axis * step) - self.at(point + axis * step);
            pair(SLOPES[0]) + pair(SLOPES[1])
        };
        Vec3::new(slope(Vec3::X), slope(Vec3::Y), slope(Vec3::Z)).try_normalize().unwrap_or(Vec3::Y)
    }

    /// Where a ray in voxels first meets the half-full surface, or the blobs of something thin.
    #[must_use]
    pub fn surface<const N: usize>(&self, maps: &Maps<N>, ray: &Ray) -> Option<Surface> {
        let (near, far) = inside_cube(ray, N as f32)?;
        let mut distance = near;
        let per_voxel = ray.direction.recip();
        // A diagonal of the cube has 1.74 N voxels of length, and blocks take a step each.
        for _ in 0..6 * N {
            if distance >= far {
                break;
            }
            let point = ray.at(distance);
            if let Some(exit) = self.empty_block(point, per_voxel) {
                distance += exit;
                continue;
            }
            if self.at(point) >= 0.5 {
                return Some(self.meet(ray, distance));
            }
            if let Some(voxel) = thin_voxel(self, maps, point) {
                return Some(blobs(maps, ray, &Sample { voxel, distance }));
            }
            distance += STEP;
        }
        None
    }

    /// How far a ray goes from a point of the cube until it is out of an empty block, given its
    /// distance for each voxel along the axes; `None` in another block.
    fn empty_block(&self, point: Vec3, per_voxel: Vec3) -> Option<f32> {
        let size = BLOCK as f32;
        let place = point + Vec3::splat(PAD as f32);
        let blocks = self.side.div_ceil(BLOCK);
        let block = (place * (1.0 / size)).to_array().map(|c| (c as usize).min(blocks - 1));
        if self.blocks[(block[1] * blocks + block[2]) * blocks + block[0]] {
            return None;
        }
        // Along an axis that the ray doesn't move on, the end is infinitely far.
        let exit = |axis: usize| {
            let ahead = if per_voxel[axis] > 0.0 { size } else { 0.0 };
            (size * block[axis] as f32 + ahead - place[axis]) * per_voxel[axis]
        };
        Some(exit(0).min(exit(1)).min(exit(2)).max(0.0) + 0.01)
    }

    /// The surface between a point inside it and the step before, by bisection.
    fn meet(&self, ray: &Ray, inside: f32) -> Surface {
        let (mut out, mut inside) = (inside - STEP, inside);
        for _ in 0..6 {
            let middle = 0.5 * (out + inside);
            if self.at(ray.at(middle)) >= 0.5 {
                inside = middle;
            } else {
                out = middle;
            }
        }
        let position = ray.at(inside);
        Surface { position, normal: self.normal(position), distance: inside }
    }
}

/// The occupied voxel at a point, if the blur left less than half of it and of all its neighbours.
fn thin_voxel<const N: usize>(
    density: &Density,
    maps: &Maps<N>,
    point: Vec3,
) -> Option<[usize; 3]> {
    if !occupied(maps, point) || density.near(point) >= 0.5 {
        return None;
    }
    let dense = Axis::ALL.iter().any(|&axis| {
        let mut step = Vec3::ZERO;
        step[axis as usize] = 1.0;
        density.near(point - step) >= 0.5 || density.near(point + step) >= 0.5
    });
    (!dense).then(|| point.to_array().map(|c| c as usize))
}

fn full_blocks(texels: &[u8], side: usize) -> Vec<bool> {
    let blocks = side.div_ceil(BLOCK);
    let beside =
        |block: usize| (block * BLOCK).saturating_sub(1)..(block * BLOCK + BLOCK + 1).min(side);
    let full = |i: usize| {
        let (x, z, y) = (i % blocks, i / blocks % blocks, i / (blocks * blocks));
        beside(y).any(|y| {
            beside(z).any(|z| {
                let row = (y * side + z) * side;
                texels[row + beside(x).start..row + beside(x).end].iter().any(|&t| t >= LEAST)
            })
        })
    };
    (0..blocks.pow(3)).into_par_iter().map(full).collect()
}

/// Blurs layer y of rows blurred along x, along y into `sums` (0 to 256), then along z.
fn blur_layer(rows: &[u8], side: usize, y: usize, sums: &mut [u16], layer: &mut [u8]) {
    sums.fill(0);
    for (i, weight) in WEIGHTS.into_iter().enumerate() {
        // Past the grid's first layer lies another copy of it, past its last one nothing.
        let from = (y + i).saturating_sub(2);
        if from < side {
            let rows = &rows[from * side * side..(from + 1) * side * side];
            for (sum, texel) in sums.iter_mut().zip(rows) {
                *sum += weight * u16::from(*texel);
            }
        }
    }
    for (z, row) in layer.chunks_exact_mut(side).enumerate() {
        for (x, texel) in row.iter_mut().enumerate() {
            let tap = |i: usize| match (z + i).checked_sub(2) {
                Some(z) if z < side => sums[z * side + x] * WEIGHTS[i],
                _ => 0,
            };
            let sum: u16 = (0..5).map(tap).sum();
            *texel = (sum / 16).min(255) as u8;
        }
    }
}
