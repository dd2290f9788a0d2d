//! Model of the density field and its mip chain by its naive definition: blur, thin-feature boost and
//! Chebyshev distance of the fast render path's textures, texel by texel.

use crate::dense::DenseVolume;

/// Texels around the grid on each side.
const PAD: i32 = 4;
const HALF: u8 = 128;
const FAR: i32 = 7;

/// The density of a volume at four levels, and the free distances of its cells; x is fastest, then y, then z.
pub struct FieldModel {
    /// The grid's side in voxels.
    n: i32,
    occupied: Vec<bool>,
    /// The density, finest first.
    pub density: [Vec<u8>; 4],
    /// The direction out of the stone at each texel of level 1; 127 stands for a fall of 254 in two texels.
    pub outward: Vec<[i8; 3]>,
    /// The convexity of the surface at each texel of level 1, from -127 to 127.
    pub convexity: Vec<i8>,
    /// The number of free cells around each cell in every direction, 0 to 6.
    pub cells: Vec<u8>,
}

/// Each axis with the other two.
const AXES: [[usize; 3]; 3] = [[0, 1, 2], [1, 2, 0], [2, 0, 1]];

/// The number of voxels around the grid that are read.
const MARGIN: i32 = 12;

impl FieldModel {
    /// Computes the field of a set of voxels.
    pub fn from_voxels(dense: &DenseVolume) -> Self {
        let n = dense.side() as i32;
        let occupied = grid_points(n + 2 * MARGIN)
            .map(|at| at.map(|c| c - MARGIN))
            .map(|[x, y, z]| dense.contains([x, y.max(0), z]))
            .collect();
        let none = [const { Vec::new() }; 4];
        let mut model = FieldModel {
            n,
            occupied,
            density: none,
            outward: Vec::new(),
            convexity: Vec::new(),
            cells: Vec::new(),
        };
        model.density[0] = model.finest_density();
        for level in 1..4 {
            model.density[level] =
                halve_resolution(&model.density[level - 1], model.texels_per_side(level - 1));
        }
        model.outward = model.outward_directions();
        model.convexity = model.convexities();
        model.cells = model.count_free_cells();
        model
    }

    /// Returns the number of texels a side at a level.
    pub fn texels_per_side(&self, level: usize) -> i32 {
        (self.n + 2 * PAD) >> level
    }

    /// Returns `true` if a voxel counts as occupied; it may lie up to [`MARGIN`] voxels outside the grid. The
    /// ground layer repeats below the grid.
    fn is_occupied_with_ground_repeated(&self, voxel_near_grid: [i32; 3]) -> bool {
        self.occupied[grid_index(voxel_near_grid.map(|c| c + MARGIN), self.n + 2 * MARGIN)]
    }

    /// Returns the density of level 0: blurred voxels, with creases and thin features corrected.
    fn finest_density(&self) -> Vec<u8> {
        // One more texel on each side, because a loose voxel is recognised by its neighbours.
        let side = self.texels_per_side(0) + 2;
        let voxel = |at: [i32; 3]| at.map(|c| c - PAD - 1);
        let mut texels: Vec<u8> =
            grid_points(side).map(|at| self.blurred_density(voxel(at))).collect();
        for (texel, at) in texels.iter_mut().zip(grid_points(side)) {
            // An empty voxel in a crease is mirrored to below a half.
            if *texel >= HALF && !self.is_occupied_with_ground_repeated(voxel(at)) {
                *texel = 255 - *texel;
            }
            if *texel < HALF {
                *texel = (*texel).max(self.thin_feature_density(voxel(at)));
            }
        }
        let loose = |at: [i32; 3]| {
            self.is_occupied_with_ground_repeated(voxel(at))
                && cube_around(at, 1).all(|at| texels[grid_index(at, side)] < HALF)
        };
        grid_points(side - 2)
            .map(|at| at.map(|c| c + 1))
            .map(|at| if loose(at) { 255 } else { texels[grid_index(at, side)] })
            .collect()
    }

    /// Returns the density by a separable blur of 5^3 voxels with the weights 1, 4, 6, 4, 1.
    fn blurred_density(&self, voxel: [i32; 3]) -> u8 {
        let weight = |by: i32| [6, 4, 1][by.unsigned_abs() as usize];
        let slice = |z: i32| {
            let square = (0..25).map(|i| [voxel[0] + i % 5 - 2, voxel[1] + i / 5 - 2, z]);
            let full = square.filter(|&at| self.is_occupied_with_ground_repeated(at));
            let sum: u32 = full.map(|at| weight(at[0] - voxel[0]) * weight(at[1] - voxel[1])).sum();
            sum.min(255)
        };
        let sum: u32 = (-2..=2).map(|by| weight(by) * slice(voxel[2] + by)).sum();
        (f64::from(sum) / 16.0).round() as u8
    }

    /// Returns the minimum density of a voxel in a plate or rod one or two voxels thick; 0 for other voxels.
    fn thin_feature_density(&self, voxel: [i32; 3]) -> u8 {
        let mut level = 0;
        for [axis, a, b] in AXES {
            let thin = |at: [i32; 3]| self.occupied_run_length_within_three(at, axis) == 1;
            let beside = [a, b]
                .into_iter()
                .flat_map(|axis| [offset_along(voxel, axis, -1), offset_along(voxel, axis, 1)]);
            if thin(voxel) && beside.filter(|&at| thin(at)).count() >= 3 {
                level = level.max(191);
            }
            let rod = |at: [i32; 3]| {
                [a, b]
                    .iter()
                    .all(|&axis| (1..=2).contains(&self.occupied_run_length_within_three(at, axis)))
            };
            if rod(voxel)
                && (rod(offset_along(voxel, axis, -1)) || rod(offset_along(voxel, axis, 1)))
            {
                level = level.max(
                    match self.occupied_run_length_within_three(voxel, a)
                        + self.occupied_run_length_within_three(voxel, b)
                    {
                        2 => 255,
                        3 => 217,
                        _ => 204,
                    },
                );
            }
        }
        level
    }

    /// Returns the length of the run of occupied voxels through a voxel along an axis, counted up to three
    /// voxels in each direction; 0 for an empty voxel.
    fn occupied_run_length_within_three(&self, voxel: [i32; 3], axis: usize) -> i32 {
        if !self.is_occupied_with_ground_repeated(voxel) {
            return 0;
        }
        let way = |by: i32| {
            (1..=3)
                .take_while(|i| {
                    self.is_occupied_with_ground_repeated(offset_along(voxel, axis, by * i))
                })
                .count()
        };
        1 + way(-1) as i32 + way(1) as i32
    }

    /// Returns outward directions from two central differences of level 1: the wide difference where both
    /// agree, beyond the narrow one at features.
    fn outward_directions(&self) -> Vec<[i8; 3]> {
        let side = self.texels_per_side(1);
        let outward = |at: [i32; 3]| {
            let texel = |by: [i32; 3]| {
                let at = [0, 1, 2].map(|i| (at[i] + by[i]).clamp(0, side - 1));
                i64::from(self.density[1][grid_index(at, side)])
            };
            if cube_around([0; 3], 2).all(|by| texel(by) == texel([0; 3])) {
                return [0; 3];
            }
            let w = central_difference(&texel, [-1, -2, 0, 2, 1], [1, 4, 6, 4, 1], 3);
            let n = central_difference(&texel, [0, -1, 0, 1, 0], [0, 1, 14, 1, 0], 1);
            let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
            let along = dot(w, n).max(0.0);
            let cos_2 = along * along / (dot(w, w) * dot(n, n)).max(1e-9);
            let part = (0.992_404f32 - cos_2) * (1.0 / (0.992_404 - 0.969_846));
            let part = 1.5 * part.clamp(0.0, 1.0);
            let outward = [0, 1, 2].map(|i| -(w[i] + (n[i] - w[i]) * part));
            outward.map(|c| c.clamp(-127.0, 127.0).round_ties_even() as i8)
        };
        grid_points(side).map(outward).collect()
    }

    /// Returns the difference of a narrow and a wide mean of level 1, less the value of a smooth surface.
    fn convexities(&self) -> Vec<i8> {
        let side = self.texels_per_side(1);
        let convexity = |at: [i32; 3]| {
            let mean = |weights: [i64; 5], bits: u32| {
                let sum = |value: &dyn Fn(i32) -> i64| -> i64 {
                    weights.iter().zip(-2..).map(|(weight, by)| weight * value(by)).sum()
                };
                let texel = |by: [i32; 3]| {
                    let at = [0, 1, 2].map(|i| (at[i] + by[i]).clamp(0, side - 1));
                    i64::from(self.density[1][grid_index(at, side)])
                };
                let plane = |z: i32| sum(&|y| sum(&|x| texel([x, y, z]))) >> bits >> (4 - bits);
                (sum(&plane) >> 1) as f32
            };
            let differ = mean([0, 1, 14, 1, 0], 1) - mean([1, 4, 6, 4, 1], 3);
            let differ = differ * (1.0 / (0.16f32 * 255.0 * 128.0));
            let clear = differ - differ.clamp(-0.12, 0.12);
            (clear.clamp(-1.0, 1.0) * 127.0).round_ties_even() as i8
        };
        grid_points(side).map(convexity).collect()
    }

    /// Returns the Chebyshev distance of every cell to the nearest cell with density, minus one.
    fn count_free_cells(&self) -> Vec<u8> {
        let texels = self.texels_per_side(0);
        let size = if self.n > 128 { 4 } else { 2 };
        let side = texels / size;
        let solid = |cell: [i32; 3]| {
            let corner = cell.map(|c| size * c);
            let texel =
                |at: [i32; 3]| [0, 1, 2].map(|i| (corner[i] - 1 + at[i]).clamp(0, texels - 1));
            grid_points(size + 2).any(|at| self.density[0][grid_index(texel(at), texels)] >= HALF)
        };
        let solid: Vec<bool> = grid_points(side).map(solid).collect();
        let is_solid = |&cell: &[i32; 3]| {
            cell.iter().all(|c| (0..side).contains(c)) && solid[grid_index(cell, side)]
        };
        let apart = |a: [i32; 3], b: [i32; 3]| (0..3).map(|i| (a[i] - b[i]).abs()).max().unwrap();
        let distance = |cell: [i32; 3]| {
            let near = cube_around(cell, FAR - 1).filter(is_solid);
            near.map(|at| apart(at, cell)).min().unwrap_or(FAR)
        };
        grid_points(side).map(distance).map(|distance| (distance - 1).max(0) as u8).collect()
    }
}

/// Computes a separable central difference of the texels around a texel, in 256ths: `slope` along its axis
/// and `mean` along the others. The sum over x and y is shifted right by `bits`, rounding half up if it
/// contains the derivative.
fn central_difference(
    texel: &impl Fn([i32; 3]) -> i64,
    slope: [i64; 5],
    mean: [i64; 5],
    bits: u32,
) -> [f32; 3] {
    [0, 1, 2].map(|axis| {
        let sum = |along: usize, value: &dyn Fn(i32) -> i64| -> i64 {
            let kernel = if along == axis { slope } else { mean };
            kernel.iter().zip(-2..).map(|(weight, by)| weight * value(by)).sum()
        };
        let plane = |z: i32| {
            let all = sum(1, &|y| sum(0, &|x| texel([x, y, z])));
            (all + if axis < 2 { 1 << (bits - 1) } else { 0 }) >> bits
        };
        sum(2, &plane) as f32 / 256.0
    })
}

/// Returns the next level: the means of 2^3 texels. `texels_per_side` is the input's.
fn halve_resolution(texels: &[u8], texels_per_side: i32) -> Vec<u8> {
    let mean = |at: [i32; 3]| {
        let finer = grid_points(2).map(|by| [0, 1, 2].map(|i| 2 * at[i] + by[i]));
        let sum: f64 = finer.map(|at| f64::from(texels[grid_index(at, texels_per_side)])).sum();
        (sum / 8.0).round() as u8
    };
    grid_points(texels_per_side / 2).map(mean).collect()
}

/// Returns the voxel `by` steps along an axis.
fn offset_along(mut voxel: [i32; 3], axis: usize, by: i32) -> [i32; 3] {
    voxel[axis] += by;
    voxel
}

/// Returns every voxel within a Chebyshev distance of `radius`.
fn cube_around(centre: [i32; 3], radius: i32) -> impl Iterator<Item = [i32; 3]> {
    grid_points(2 * radius + 1).map(move |at| [0, 1, 2].map(|i| centre[i] + at[i] - radius))
}

/// Returns every voxel of a cube of this side, x fastest.
pub fn grid_points(side: i32) -> impl Iterator<Item = [i32; 3]> {
    (0..side.pow(3)).map(move |i| [i % side, i / side % side, i / (side * side)])
}

/// Returns the index of a voxel in a cube of this side, x fastest.
pub fn grid_index([x, y, z]: [i32; 3], side: i32) -> usize {
    ((z * side + y) * side + x) as usize
}
