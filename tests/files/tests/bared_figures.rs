//! What of the hidden figures can be bared: the ends that show where a ball of 15 mm took all that it reaches from
//! above.

use std::sync::{Mutex, PoisonError};

use paros_core::TickInput;
use paros_core::session::SessionMode;
use paros_models::dense::DenseVolume;
use paros_models::world_harness::WorldHarness;
use paros_shell::figures::Figure;

const SIDE: usize = 128;
/// Of the ball, in voxels: the stone's box is 450 mm wide.
const RADIUS: f64 = 15.0 / 450.0 * SIDE as f64;
/// Points of the lattice on which the ball's middle is tried, per voxel.
const STEPS: usize = 2;
/// Of the lattice around a figure, in voxels, on all sides but the ground: more than the ball's radius.
const MARGIN: i32 = 6;

static HARNESS: Mutex<WorldHarness<SIDE, 2>> = Mutex::new(WorldHarness::new());

/// A box of lattice points, z fastest.
struct Lattice {
    /// The voxel at its lowest corner.
    origin: [i32; 3],
    /// Points along x, y, z.
    size: [usize; 3],
}

impl Lattice {
    /// The ball's middles about a figure that stands on the ground.
    fn around(figure: &DenseVolume) -> Self {
        let (mut lo, mut hi) = ([i32::MAX; 3], [i32::MIN; 3]);
        for voxel in figure.occupied() {
            (0..3).for_each(|i| (lo[i], hi[i]) = (lo[i].min(voxel[i]), hi[i].max(voxel[i])));
        }
        let origin = [lo[0] - MARGIN, 0, lo[2] - MARGIN];
        let size = [0, 1, 2].map(|i| STEPS * (hi[i] + 1 + MARGIN - origin[i]) as usize);
        Lattice { origin, size }
    }

    fn len(&self) -> usize {
        self.size.iter().product()
    }

    fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (x * self.size[1] + y) * self.size[2] + z
    }

    /// The point at a voxel's centre; `None` outside.
    fn index_of_voxel(&self, voxel: [i32; 3]) -> Option<usize> {
        let at: [usize; 3] = core::array::from_fn(|i| {
            STEPS.wrapping_mul((voxel[i] - self.origin[i]) as usize).wrapping_add(STEPS / 2)
        });
        (0..3).all(|i| at[i] < self.size[i]).then(|| self.index(at))
    }

    /// The squared distance of each point to the nearest of some, in steps: by parabolas along one axis after the
    /// other (Felzenszwalb and Huttenlocher 2012).
    fn squared_distances(&self, is_seed: &[bool]) -> Vec<f32> {
        const FAR: f32 = 1e9;
        let mut distances: Vec<f32> =
            is_seed.iter().map(|seed| if *seed { 0.0 } else { FAR }).collect();
        let strides = [self.size[1] * self.size[2], self.size[2], 1];
        for (n, stride) in core::iter::zip(self.size, strides) {
            let starts = (0..self.len()).filter(|i| i / stride % n == 0);
            let mut line = vec![0.0; n];
            for start in starts {
                (0..n).for_each(|i| line[i] = distances[start + i * stride]);
                lower_envelope(&line, |i, value| distances[start + i * stride] = value);
            }
        }
        distances
    }

    /// The points that are joined with the top layer by steps between allowed ones.
    fn reach_from_above(&self, is_allowed: &[bool]) -> Vec<bool> {
        let [nx, ny, nz] = self.size;
        let mut is_reached = vec![false; self.len()];
        let mut queue: Vec<[usize; 3]> = Vec::new();
        for x in 0..nx {
            queue.extend((0..nz).map(|z| [x, ny - 1, z]));
        }
        while let Some(at) = queue.pop() {
            let i = self.index(at);
            if is_reached[i] || !is_allowed[i] {
                continue;
            }
            is_reached[i] = true;
            for axis in 0..3 {
                for step in [usize::MAX, 1] {
                    let mut next = at;
                    next[axis] = at[axis].wrapping_add(step);
                    if next[axis] < self.size[axis] {
                        queue.push(next);
                    }
                }
            }
        }
        is_reached
    }
}

/// The least of `line[j] + (i - j)^2` for each i.
fn lower_envelope(line: &[f32], mut set: impl FnMut(usize, f32)) {
    let mut parabolas: Vec<(usize, f32)> = Vec::with_capacity(line.len());
    for (j, value) in line.iter().enumerate() {
        let square = |j: usize| (j * j) as f32;
        loop {
            let Some(&(before, from)) = parabolas.last() else {
                parabolas.push((j, f32::NEG_INFINITY));
                break;
            };
            let at =
                (value + square(j) - line[before] - square(before)) / (2 * (j - before)) as f32;
            if at > from {
                parabolas.push((j, at));
                break;
            }
            parabolas.pop();
        }
    }
    let mut k = 0;
    for i in 0..line.len() {
        while k + 1 < parabolas.len() && parabolas[k + 1].1 < i as f32 {
            k += 1;
        }
        let j = parabolas[k].0;
        set(i, line[j] + ((i as f32) - (j as f32)).powi(2));
    }
}

/// What is left of a block when a ball took all that it can reach without a voxel of the figure.
fn carve_with_ball(figure: &DenseVolume) -> DenseVolume {
    let lattice = Lattice::around(figure);
    let reach = (RADIUS * STEPS as f64).powi(2) as f32;
    let mut seeds = vec![false; lattice.len()];
    for voxel in figure.occupied() {
        seeds[lattice.index_of_voxel(voxel).expect("it lies around the figure")] = true;
    }
    let is_free: Vec<bool> =
        lattice.squared_distances(&seeds).into_iter().map(|d| d > reach).collect();
    let to_ball = lattice.squared_distances(&lattice.reach_from_above(&is_free));
    let is_left = |i: usize| to_ball[i] > reach;
    DenseVolume::from_fn(SIDE, |voxel| lattice.index_of_voxel(voxel).is_some_and(is_left))
}

/// The least bared part, in percent: what is left are hollows that are too narrow for the ball.
const LEAST_PERCENT: u32 = 97;

#[test]
fn a_ball_bares_most_of_each_figure() {
    let mut harness = HARNESS.lock().unwrap_or_else(PoisonError::into_inner);
    for figure in Figure::HIDDEN {
        let shape = DenseVolume::from_fn(SIDE, |voxel| {
            figure.contains_voxel_centre::<SIDE>(voxel.map(|i| i as usize))
        });
        harness.reset_to_voxels(&carve_with_ball(&shape.closure()), &shape);
        let start = SessionMode::Constrained { figure: 0 };
        harness.step(&TickInput { start, ..TickInput::default() });
        (0..3).for_each(|_| harness.step(&TickInput::default()));
        let ends = harness.world.bared_ends();
        assert!(ends.percent() >= LEAST_PERCENT, "{figure:?}: {} %, {ends:?}", ends.percent());
    }
}
