//! Events of a tick, for shells to show, sound and log.

use crate::edit::islands::IslandReport;
use crate::edit::operation::EditReport;
use crate::session::input::SessionMode;
use crate::session::tools::{Tool, ToolBit};
use crate::session::workbench::BenchItem;
use crate::visit::VisitPhase;
use crate::volume::voxel_box::VoxelBox;

/// An event of a tick.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum WorldEvent {
    /// A session started.
    Started(SessionMode),
    /// A session was asked for whose start volume doesn't exist; nothing changed.
    NoSuchStart,
    /// A hand took a tool, or mounted a bit.
    Took {
        /// 0 left, 1 right.
        hand: u8,
        /// What it took.
        item: BenchItem,
    },
    /// A hand let go of a tool.
    Released {
        /// 0 left, 1 right.
        hand: u8,
        /// The tool.
        tool: Tool,
    },
    /// A tool was put back on the bench.
    Returned {
        /// 0 left, 1 right.
        hand: u8,
        /// The tool.
        tool: Tool,
    },
    /// Each hand holds what the other one held.
    HandsSwapped,
    /// A running tool edited the volume, or was refused by it.
    Edited {
        /// 0 left, 1 right.
        hand: u8,
        /// Its bit.
        bit: ToolBit,
        /// The effect, in voxels.
        report: EditReport,
    },
    /// A blow split a flake off, which its [`WorldEvent::Edited`] counts too.
    Split {
        /// 0 left, 1 right.
        hand: u8,
        /// How many voxels went.
        removed: u32,
        /// Where they were; a mirrored edit's other half is the mirror image.
        within: VoxelBox,
    },
    /// An island pass ended that removed or kept voxels, or had no support to start from.
    Islands(IslandReport),
    /// A stroke was undone.
    Undone,
    /// A stroke was redone.
    Redone,
    /// The mirror was switched.
    Symmetry(bool),
    /// So many tenths of the hidden figure's ends are bared, more than ever before.
    Bared {
        /// 1 to 10.
        tenths: u8,
    },
    /// The hidden figure is found: [`FOUND_PERCENT`](crate::session::FOUND_PERCENT) of its ends are bared.
    Found,
    /// The session ended: the sculpture is to be exported.
    Finished,
    /// The visit is in another phase.
    Visit(VisitPhase),
    /// The visit's clock has so many seconds left, of [`WARNING_SECONDS`](crate::visit::WARNING_SECONDS).
    TimeLeft {
        /// Seconds.
        seconds: u16,
    },
}
