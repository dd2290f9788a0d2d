//! Items outside the stable interface that shells, tools and tests use: reports, errors, layouts and parts of
//! the machinery. They may change at any time. The stable interface is the crate's root and the modules named
//! there.

pub use crate::codec::bytes::ByteWriter;
pub use crate::codec::digest::{DIGEST_PARTS, checksum, combine_digests, mix_bits};
pub use crate::convert::bake::BAKE_UNITS_PER_VOXEL;
pub use crate::edit::brush::{BrushBounds, BrushPiece, BrushPieces, BrushRow, HalfBall, isqrt};
pub use crate::edit::contact::{
    BURIED_WITHIN, FreezeResult, LONG_STRETCH, Obstacle, SHORT_STRETCH, WayBudget, exit_probe_steps,
};
pub use crate::edit::grid_bit::{GridBit, GridShape};
pub use crate::edit::islands::IslandSearch;
pub use crate::edit::pose::FIXED_ONE;
pub use crate::edit::undo::UndoHistory;
pub use crate::session::bit_size::SizeRange;
pub use crate::session::hand::{RoomPose, haptic_amplitude};
pub use crate::session::input::UNITS_PER_METRE;
pub use crate::session::journals::{RemovalJournal, StrokeJournal};
pub use crate::session::stool_frame::{BOX_SIDE, STOOL_RADIUS, STOOL_TOP};
pub use crate::session::tools::{BitAction, BitShape, ToolBitSpec};
pub use crate::session::workbench::{
    BENCH_ITEMS, BENCH_REACH, BENCH_TOP, ToolPlace, Workbench, is_over_bench,
};
pub use crate::volume::column_digest::maps_digest;
pub use crate::volume::line_scan::HoleScan;
pub use crate::volume::range_maps::{ColumnAddress, ColumnsBeyond, RowAddress};
pub use crate::volume::row::BitRow;
pub use crate::volume::row_iter::{BitRuns, SetBits};
