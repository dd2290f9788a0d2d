//! Volumes: a grid of N^3 voxels as three range maps and as bit rows, kept in step.
//!
//! Inputs: sets of voxels and replaced columns. Outputs: membership, neighbourhoods, tight maps, their
//! digest, and the rectangles of changed columns. Independent of brushes, tools, sessions, files and time.

pub(crate) mod bit_grid;
mod box_check;
pub(crate) mod box_sum;
pub(crate) mod closing_line;
pub(crate) mod closure;
pub(crate) mod column_digest;
pub(crate) mod dirty;
pub(crate) mod editable;
pub(crate) mod journal;
pub(crate) mod line_scan;
pub(crate) mod neighbourhood;
pub(crate) mod range;
pub(crate) mod range_maps;
pub(crate) mod row;
pub(crate) mod row_iter;
pub(crate) mod size;
pub(crate) mod voxel_box;

pub use bit_grid::BitGrid;
pub use dirty::{ColumnRect, DirtyRects};
pub use journal::{Journal, SwapJournal};
pub use range::Range;
pub use range_maps::{Axis, Column};
pub use row::BitSet;
pub use size::{Grid, Size};
pub use voxel_box::VoxelBox;
