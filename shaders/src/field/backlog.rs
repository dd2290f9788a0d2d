//! What of the textures is behind the maps: boxes of texels to compute, lines of maps to hand out.

use paros_core::limits::LAYERS;
use paros_core::maps::{Axis, Range};

use super::blur::MOST;
use super::extent::Extent;
use super::{PAD, REACH};

/// Texels along the sides of the chunks that each have a box of stale texels.
pub(super) const CHUNK: [usize; 3] = [32, 16, 16];

/// Texels of boxes that are computed together: no more than a chunk's, of which nothing but detail is
/// about a frame's work.
const MOST_JOINED: usize = CHUNK[0] * CHUNK[1] * CHUNK[2];

/// The finest texels to compute again: a box in each chunk.
#[derive(Debug)]
pub(super) struct Backlog {
    side: usize,
    /// Chunks along each axis.
    chunks: [usize; 3],
    stale: Vec<Extent>,
    /// Chunks with a stale box.
    count: usize,
    /// The chunk to look at next, so that each gets its turn.
    next: usize,
}

impl Backlog {
    /// Nothing stale.
    pub(super) fn new(side: usize) -> Self {
        let chunks = CHUNK.map(|chunk| side.div_ceil(chunk));
        let stale = vec![Extent::NONE; chunks.iter().product()];
        Backlog { side, chunks, stale, count: 0, next: 0 }
    }

    pub(super) fn clear(&mut self) {
        self.stale.fill(Extent::NONE);
        self.count = 0;
    }

    pub(super) const fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Voxels of a box, ends included, may have changed.
    pub(super) fn add_voxels(&mut self, lo: [usize; 3], hi: [usize; 3]) {
        let mut extent = Extent {
            lo: lo.map(|c| c + PAD - REACH),
            hi: hi.map(|c| (c + PAD + REACH + 1).min(self.side)),
        };
        // The ground layer's copies go down to the last texel.
        if lo[1] == 0 {
            extent.lo[1] = 0;
        }
        // Eight texels of a row are computed at once.
        extent.lo[0] = extent.lo[0] / 8 * 8;
        extent.hi[0] = extent.hi[0].next_multiple_of(8);
        self.add(&extent);
    }

    /// The texels of a box are stale.
    pub(super) fn add(&mut self, extent: &Extent) {
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
                    *stale = stale.union(&Extent { lo, hi });
                }
            }
        }
    }

    /// Takes the box that is next, with those of chunks beside it as far as all can be computed at
    /// once.
    pub(super) fn take(&mut self) -> Option<Extent> {
        if self.is_empty() {
            return None;
        }
        while self.stale[self.next].is_empty() {
            self.next = (self.next + 1) % self.stale.len();
        }
        let [along_x, along_y, _] = self.chunks;
        let chunk =
            [self.next % along_x, self.next / along_x % along_y, self.next / (along_x * along_y)];
        let mut all = self.take_one(self.next);
        let near = Extent {
            lo: chunk.map(|c| c.saturating_sub(1)),
            hi: [0, 1, 2].map(|axis| self.chunks[axis].min(chunk[axis] + 2)),
        };
        for (y, z) in near.rows() {
            for x in near.lo[0]..near.hi[0] {
                let i = (z * along_y + y) * along_x + x;
                let both = all.union(&self.stale[i]);
                let size = both.size();
                let fits =
                    (0..3).all(|axis| size[axis] <= MOST[axis]) && both.volume() <= MOST_JOINED;
                if !self.stale[i].is_empty() && fits {
                    self.take_one(i);
                    all = both;
                }
            }
        }
        Some(all)
    }

    fn take_one(&mut self, chunk: usize) -> Extent {
        self.count -= 1;
        std::mem::replace(&mut self.stale[chunk], Extent::NONE)
    }
}

/// In each line of the three maps the places that are to be handed out.
#[derive(Debug)]
pub(super) struct Lines {
    stale: [Vec<Range>; 3],
}

impl Lines {
    pub(super) fn new(n: usize) -> Self {
        Lines { stale: [0; 3].map(|_| vec![Range::EMPTY; n]) }
    }

    pub(super) fn clear(&mut self) {
        self.stale.iter_mut().for_each(|lines| lines.fill(Range::EMPTY));
    }

    pub(super) fn add(&mut self, axis: Axis, line: usize, places: Range) {
        let stale = &mut self.stale[axis as usize][line];
        *stale = stale.hull_with(places);
    }

    pub(super) fn is_empty(&self) -> bool {
        self.stale.iter().flatten().all(|places| places.is_empty())
    }

    /// The next lines of a map, from the first up to but without the last, and the places of all of
    /// them; no more than `bytes` unless it is one line.
    pub(super) fn first(&self, bytes: usize) -> Option<(Axis, usize, usize, Range)> {
        let is_stale = |places: &Range| !places.is_empty();
        for axis in Axis::ALL {
            let lines = &self.stale[axis as usize];
            let Some(first) = lines.iter().position(is_stale) else { continue };
            let (mut end, mut places) = (first + 1, lines[first]);
            while end < lines.len() && is_stale(&lines[end]) {
                let wider = places.hull_with(lines[end]);
                let width = wider.hi() + 1 - wider.lo();
                if width * (end + 1 - first) * 2 * LAYERS > bytes {
                    break;
                }
                (end, places) = (end + 1, wider);
            }
            return Some((axis, first, end, places));
        }
        None
    }

    pub(super) fn done(&mut self, axis: Axis, first: usize, end: usize) {
        self.stale[axis as usize][first..end].fill(Range::EMPTY);
    }
}
