//! The fast path's textures by their definition, texel by texel.

use super::dense::Dense;

/// Texels around the grid on each side.
const PAD: i32 = 4;
const HALF: u8 = 128;
const FAR: i32 = 7;

/// The density of a volume at its four levels, and its cells; by x, then y, then z.
pub struct FieldModel {
    /// Voxels along a side.
    n: i32,
    occupied: Vec<bool>,
    /// The density, finest first.
    pub density: [Vec<u8>; 4],
    /// How many cells all around each are free.
    pub cells: Vec<u8>,
}

/// Axis, and the two others.
const AXES: [[usize; 3]; 3] = [[0, 1, 2], [1, 2, 0], [2, 0, 1]];

/// Voxels beyond the grid that anything is asked of.
const MARGIN: i32 = 12;

impl FieldModel {
    /// Of these voxels.
    pub fn new(dense: &Dense) -> Self {
        let n = dense.n() as i32;
        let occupied = places(n + 2 * MARGIN)
            .map(|at| at.map(|c| c - MARGIN))
            .map(|[x, y, z]| dense.contains([x, y.max(0), z]))
            .collect();
        let none = [const { Vec::new() }; 4];
        let mut model = FieldModel { n, occupied, density: none, cells: Vec::new() };
        model.density[0] = model.finest();
        for level in 1..4 {
            model.density[level] = halved(&model.density[level - 1], model.side(level - 1));
        }
        model.cells = model.measure();
        model
    }

    /// Texels along a side at a level.
    pub fn side(&self, level: usize) -> i32 {
        (self.n + 2 * PAD) >> level
    }

    /// Whether a voxel, up to eight beyond the grid, counts as occupied.
    fn full(&self, voxel: [i32; 3]) -> bool {
        self.occupied[index(voxel.map(|c| c + MARGIN), self.n + 2 * MARGIN)]
    }

    fn finest(&self) -> Vec<u8> {
        // One more around, as what is loose looks at its neighbours.
        let side = self.side(0) + 2;
        let voxel = |at: [i32; 3]| at.map(|c| c - PAD - 1);
        let mut texels: Vec<u8> = places(side).map(|at| self.blurred(voxel(at))).collect();
        for (texel, at) in texels.iter_mut().zip(places(side)) {
            // In a crease: as far below a half.
            if *texel >= HALF && !self.full(voxel(at)) {
                *texel = 255 - *texel;
            }
            if *texel < HALF {
                *texel = (*texel).max(self.raised(voxel(at)));
            }
        }
        let loose = |at: [i32; 3]| {
            self.full(voxel(at)) && near(at, 1).all(|at| texels[index(at, side)] < HALF)
        };
        places(side - 2)
            .map(|at| at.map(|c| c + 1))
            .map(|at| if loose(at) { 255 } else { texels[index(at, side)] })
            .collect()
    }

    fn blurred(&self, voxel: [i32; 3]) -> u8 {
        let weight = |by: i32| [6, 4, 1][by.unsigned_abs() as usize];
        let slice = |z: i32| {
            let full = near(voxel, 2).filter(|&at| at[2] == z && self.full(at));
            let sum: u32 = full.map(|at| weight(at[0] - voxel[0]) * weight(at[1] - voxel[1])).sum();
            sum.min(255)
        };
        let sum: u32 = (-2..=2).map(|by| weight(by) * slice(voxel[2] + by)).sum();
        (f64::from(sum) / 16.0).round() as u8
    }

    /// How far a plate or a rod raises a voxel.
    fn raised(&self, voxel: [i32; 3]) -> u8 {
        let mut level = 0;
        for [axis, a, b] in AXES {
            let thin = |at: [i32; 3]| self.run(at, axis) == 1;
            let beside =
                [a, b].into_iter().flat_map(|axis| [step(voxel, axis, -1), step(voxel, axis, 1)]);
            if thin(voxel) && beside.filter(|&at| thin(at)).count() >= 3 {
                level = level.max(191);
            }
            let rod =
                |at: [i32; 3]| [a, b].iter().all(|&axis| (1..=2).contains(&self.run(at, axis)));
            if rod(voxel) && (rod(step(voxel, axis, -1)) || rod(step(voxel, axis, 1))) {
                level = level.max(match self.run(voxel, a) + self.run(voxel, b) {
                    2 => 255,
                    3 => 217,
                    _ => 204,
                });
            }
        }
        level
    }

    /// Voxels of the run along an axis that a voxel belongs to, as far as three each way; 0 where
    /// it is empty.
    fn run(&self, voxel: [i32; 3], axis: usize) -> i32 {
        if !self.full(voxel) {
            return 0;
        }
        let way = |by: i32| (1..=3).take_while(|i| self.full(step(voxel, axis, by * i))).count();
        1 + way(-1) as i32 + way(1) as i32
    }

    fn measure(&self) -> Vec<u8> {
        let texels = self.side(0);
        let size = if self.n > 128 { 4 } else { 2 };
        let side = texels / size;
        let solid = |cell: [i32; 3]| {
            let corner = cell.map(|c| size * c);
            let texel =
                |at: [i32; 3]| [0, 1, 2].map(|i| (corner[i] - 1 + at[i]).clamp(0, texels - 1));
            places(size + 2).any(|at| self.density[0][index(texel(at), texels)] >= HALF)
        };
        let solid: Vec<[i32; 3]> = places(side).filter(|&cell| solid(cell)).collect();
        let apart = |a: [i32; 3], b: [i32; 3]| (0..3).map(|i| (a[i] - b[i]).abs()).max().unwrap();
        places(side)
            .map(|cell| solid.iter().map(|&at| apart(at, cell)).min().unwrap_or(FAR).min(FAR))
            .map(|distance| (distance - 1).max(0) as u8)
            .collect()
    }
}

fn halved(texels: &[u8], side: i32) -> Vec<u8> {
    let mean = |at: [i32; 3]| {
        let finer = places(2).map(|by| [0, 1, 2].map(|i| 2 * at[i] + by[i]));
        let sum: f64 = finer.map(|at| f64::from(texels[index(at, side)])).sum();
        (sum / 8.0).round() as u8
    };
    places(side / 2).map(mean).collect()
}

fn step(mut voxel: [i32; 3], axis: usize, by: i32) -> [i32; 3] {
    voxel[axis] += by;
    voxel
}

/// Every place at most so far along each axis.
fn near(at: [i32; 3], by: i32) -> impl Iterator<Item = [i32; 3]> {
    places(2 * by + 1).map(move |other| [0, 1, 2].map(|i| at[i] + other[i] - by))
}

/// Every place of a cube, x fastest.
pub fn places(side: i32) -> impl Iterator<Item = [i32; 3]> {
    (0..side.pow(3)).map(move |i| [i % side, i / side % side, i / (side * side)])
}

/// Where a place is stored.
pub fn index([x, y, z]: [i32; 3], side: i32) -> usize {
    ((z * side + y) * side + x) as usize
}
