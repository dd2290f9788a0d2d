//! The supported sizes of a volume, and the type of bit row for each.

use crate::volume::row::{BitRow, BitSet};

mod sealed {
    pub trait Sealed {}
}

/// A grid of N x N x N voxels: a type-level number that implements [`Size`].
#[derive(Debug, Clone, Copy)]
pub struct Grid<const N: usize>;

/// The supported grid sizes, each with its type of bit row. Sealed: 16, 32 and 64 are for tests, 128 is
/// the default and 256 the high setting.
///
/// This is a trait because `[u64; N / 64]` isn't an array type in stable Rust.
pub trait Size: sealed::Sealed {
    /// N bits, one for each voxel along x.
    type Row: BitSet;
    /// A row whose N bits are all set.
    const FULL: Self::Row;
}

macro_rules! sizes {
    ($($n:literal => $words:literal, $top:expr;)*) => {$(
        impl sealed::Sealed for Grid<$n> {}
        impl Size for Grid<$n> {
            type Row = BitRow<$words>;
            const FULL: BitRow<$words> = BitRow([$top; $words]);
        }
    )*};
}

sizes! {
    16 => 1, 0xffff;
    32 => 1, 0xffff_ffff;
    64 => 1, u64::MAX;
    128 => 2, u64::MAX;
    256 => 4, u64::MAX;
}
