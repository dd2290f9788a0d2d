//! Work queues of the update: boxes of stale texels, and lines of map columns to compare or upload.

use paros_core::volume::{Axis, Range};

use super::extent::TexelBox;
use super::rows::MAX_BOX;
use super::sizes::{PAD, REACH};

/// Size in texels of the chunks that each keep a box of stale texels.
pub(super) const CHUNK: [usize; 3] = [32, 16, 16];

/// The most texels in a merged box: those of a chunk, which take about a frame's work where all is surface.
pub(super) const MAX_MERGED_TEXELS: usize = CHUNK[0] * CHUNK[1] * CHUNK[2];

/// The finest texels to recompute: a dirty box in each chunk.
#[derive(Debug)]
pub(super) struct BoxBacklog {
    /// Texels along a side of the finest density.
    density_side: usize,
    /// Chunks along each axis.
    chunks: [usize; 3],
    stale: Vec<TexelBox>,
    /// Chunks with a stale box.
    count: usize,
    /// The chunk to look at next: round robin.
    next_chunk: usize,
}

impl BoxBacklog {
    /// Creates a queue with nothing stale.
    pub(super) fn new(density_side: usize) -> Self {
        let chunks = CHUNK.map(|chunk| density_side.div_ceil(chunk));
        let stale = vec![TexelBox::NONE; chunks.iter().product()];
        BoxBacklog { density_side, chunks, stale, count: 0, next_chunk: 0 }
    }

    pub(super) fn clear(&mut self) {
        self.stale.fill(TexelBox::NONE);
        self.count = 0;
    }

    pub(super) const fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Marks the texels stale that depend on the voxels from the first to the last, both included.
    pub(super) fn mark_texels_around_voxels(
        &mut self,
        first_voxel: [usize; 3],
        last_voxel: [usize; 3],
    ) {
        let mut extent = TexelBox {
            lo: first_voxel.map(|c| c + PAD - REACH),
            hi: last_voxel.map(|c| (c + PAD + REACH + 1).min(self.density_side)),
        };
        // The ground layer is repeated down to the last texel.
        if first_voxel[1] == 0 {
            extent.lo[1] = 0;
        }
        // Texels are computed in groups of eight along x.
        extent.lo[0] = extent.lo[0] / 8 * 8;
        extent.hi[0] = extent.hi[0].next_multiple_of(8);
        self.mark_texels(&extent);
    }

    /// Marks the texels of a box stale.
    pub(super) fn mark_texels(&mut self, extent: &TexelBox) {
        let first = [0, 1, 2].map(|axis| extent.lo[axis] / CHUNK[axis]);
        let last = [0, 1, 2].map(|axis| (extent.hi[axis] - 1) / CHUNK[axis]);
        for z in first[2]..=last[2] {
            for y in first[1]..=last[1] {
                for x in first[0]..=last[0] {
                    let chunk = [x, y, z];
                    let lo = [0, 1, 2].map(|axis| extent.lo[axis].max(chunk[axis] * CHUNK[axis]));
                    let end = |axis: usize| (chunk[axis] + 1) * CHUNK[axis];
                    let hi = [0, 1, 2].map(|axis| extent.hi[axis].min(end(axis)));
                    let stale = &mut self.stale[(z * self.chunks[1] + y) * self.chunks[0] + x];
                    self.count += usize::from(stale.is_empty());
                    *stale = stale.union(&TexelBox { lo, hi });
                }
            }
        }
    }

    /// Takes the next stale box, merged with those of neighbouring chunks as far as the joint box
    /// can be computed at once.
    pub(super) fn take_merged_box(&mut self) -> Option<TexelBox> {
        if self.is_empty() {
            return None;
        }
        while self.stale[self.next_chunk].is_empty() {
            self.next_chunk = (self.next_chunk + 1) % self.stale.len();
        }
        let [along_x, along_y, _] = self.chunks;
        let chunk = [
            self.next_chunk % along_x,
            self.next_chunk / along_x % along_y,
            self.next_chunk / (along_x * along_y),
        ];
        let mut all = self.take_chunk(self.next_chunk);
        let near = TexelBox {
            lo: chunk.map(|c| c.saturating_sub(1)),
            hi: [0, 1, 2].map(|axis| self.chunks[axis].min(chunk[axis] + 2)),
        };
        for (y, z) in near.rows() {
            for x in near.lo[0]..near.hi[0] {
                let i = (z * along_y + y) * along_x + x;
                let both = all.union(&self.stale[i]);
                let size = both.size();
                let fits = (0..3).all(|axis| size[axis] <= MAX_BOX[axis])
                    && both.volume() <= MAX_MERGED_TEXELS;
                if !self.stale[i].is_empty() && fits {
                    self.take_chunk(i);
                    all = both;
                }
            }
        }
        Some(all)
    }

    fn take_chunk(&mut self, chunk_index: usize) -> TexelBox {
        self.count -= 1;
        std::mem::replace(&mut self.stale[chunk_index], TexelBox::NONE)
    }
}

/// A run of lines of a map, and the places in them that are stale.
pub(super) struct LineRun {
    pub(super) axis: Axis,
    pub(super) lines: std::ops::Range<usize>,
    pub(super) places: Range,
}

/// For each line of the three maps, the hull of the stale places.
#[derive(Debug)]
pub(super) struct StaleLines {
    stale: [Vec<Range>; 3],
}

impl StaleLines {
    pub(super) fn new(grid_side: usize) -> Self {
        StaleLines { stale: [0; 3].map(|_| vec![Range::EMPTY; grid_side]) }
    }

    pub(super) fn clear(&mut self) {
        self.stale.iter_mut().for_each(|lines| lines.fill(Range::EMPTY));
    }

    pub(super) fn mark_stale(&mut self, axis: Axis, line: usize, places: Range) {
        let stale = &mut self.stale[axis as usize][line];
        *stale = stale.hull_with(places);
    }

    pub(super) fn is_empty(&self) -> bool {
        self.stale.iter().flatten().all(|places| places.is_empty())
    }

    /// Returns the next run of stale lines of a map, with the hull of their places: at most `max_columns`
    /// columns, unless it is a single line.
    pub(super) fn next_run(&self, max_columns: usize) -> Option<LineRun> {
        let is_stale = |places: &Range| !places.is_empty();
        for axis in Axis::ALL {
            let lines = &self.stale[axis as usize];
            let Some(first) = lines.iter().position(is_stale) else { continue };
            let (mut end, mut places) = (first + 1, lines[first]);
            while end < lines.len() && is_stale(&lines[end]) {
                let wider = places.hull_with(lines[end]);
                let width = wider.last() + 1 - wider.first();
                if width * (end + 1 - first) > max_columns {
                    break;
                }
                (end, places) = (end + 1, wider);
            }
            return Some(LineRun { axis, lines: first..end, places });
        }
        None
    }

    pub(super) fn clear_lines(&mut self, axis: Axis, lines: std::ops::Range<usize>) {
        self.stale[axis as usize][lines].fill(Range::EMPTY);
    }
}
