//! The way through a volume, row after row: each layer's voxels before the cells that need them.

/// Ends of a box, both inside.
#[derive(Clone, Copy)]
pub(super) struct Bounds {
    pub(super) lo: [i32; 3],
    pub(super) hi: [i32; 3],
}

impl Bounds {
    /// All zero bytes, until first used.
    pub(super) const ZERO: Bounds = Bounds { lo: [0; 3], hi: [0; 3] };

    /// Around nothing.
    pub(super) const NONE: Bounds = Bounds { lo: [i32::MAX; 3], hi: [i32::MIN; 3] };

    pub(super) fn is_empty(&self) -> bool {
        self.lo[0] > self.hi[0]
    }

    /// Stretches to take in a place along an axis.
    #[inline]
    pub(super) fn widen(&mut self, axis: usize, at: i32) {
        self.lo[axis] = self.lo[axis].min(at);
        self.hi[axis] = self.hi[axis].max(at);
    }

    /// Stretches to take in a point.
    #[inline]
    pub(super) fn add(&mut self, point: [i32; 3]) {
        for (axis, at) in point.into_iter().enumerate() {
            self.widen(axis, at);
        }
    }
}

/// What is next on the way.
pub(super) enum Step {
    /// Row (y, z) of voxels.
    Voxels(usize, usize),
    /// The cells between the layers y - 1 and y and the rows z - 1 and z. The voxels of layer y,
    /// and of y + 1 where it has any, have come before.
    Cells(usize, usize),
}

/// A place on the way.
pub(super) struct Walk {
    /// The layer whose voxels are next, or two above the cells that are.
    layer: u32,
    row: u32,
    in_cells: bool,
}

impl Walk {
    /// Nowhere: all zero bytes.
    pub(super) const fn new() -> Self {
        Walk { layer: 0, row: 0, in_cells: false }
    }

    /// Goes to the first row of voxels within bounds that aren't empty.
    pub(super) fn start(&mut self, voxels: &Bounds) {
        let [_, bottom, first] = voxels.lo;
        *self = Walk { layer: bottom as u32, row: first as u32, in_cells: false };
    }

    pub(super) fn step(&self) -> Step {
        let (layer, row) = (self.layer as usize, self.row as usize);
        if self.in_cells { Step::Cells(layer - 1, row) } else { Step::Voxels(layer, row) }
    }

    /// Goes on; false after the last step.
    pub(super) fn next(&mut self, voxels: &Bounds) -> bool {
        let Bounds { lo: [_, bottom, first], hi: [_, top, last] } = *voxels;
        self.row += 1;
        // One more row of cells than of voxels.
        if self.row <= last as u32 + u32::from(self.in_cells) {
            return true;
        }
        self.row = first as u32;
        if !self.in_cells && self.layer > bottom as u32 {
            self.in_cells = true;
            return true;
        }
        self.layer += 1;
        self.in_cells = self.layer > top as u32;
        self.layer <= top as u32 + 2
    }
}
