//! Start volumes of large grids.

use crate::dense::{DenseVolume, MaskedVolume};
use crate::random_visitor::RandomSource;

/// Returns a floor with boxes on it and above it, some of which float. One box on the floor is the mask.
pub fn scattered_boxes(side: usize, seed: u64) -> MaskedVolume {
    let mut dice = RandomSource::new(seed);
    let n = side as i32;
    let mut boxes = vec![([0; 3], [n - 1, n / 32, n - 1])];
    for _ in 0..10 {
        let mut below = |end: i32| dice.below(end as u64) as i32;
        let corner = [below(n * 3 / 4), below(n / 2), below(n * 3 / 4)];
        boxes.push((corner, corner.map(|lo| lo + n / 16 + below(n / 6))));
    }
    let foot = [n / 3, n / 32, n / 3];
    let mask = (foot, foot.map(|lo| lo + n / 6));
    boxes.push(mask);
    let fill = |boxes: &[([i32; 3], [i32; 3])]| {
        let mut voxels = DenseVolume::empty(side);
        for (lo, hi) in boxes {
            for y in lo[1]..=hi[1].min(n - 1) {
                for z in lo[2]..=hi[2].min(n - 1) {
                    (lo[0]..=hi[0].min(n - 1)).for_each(|x| voxels.set([x, y, z], true));
                }
            }
        }
        voxels
    };
    // The world starts from the closure, which keeps a box-shaped mask whole.
    MaskedVolume { volume: fill(&boxes), mask: fill(&[mask]) }
}
