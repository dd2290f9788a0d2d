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
    /// A session was requested whose start volume doesn't exist; nothing changed.
    NoSuchStart,
    /// A hand took a tool, or mounted a bit.
    Took {
        /// 0 left, 1 right.
        hand: u8,
        /// The item that it took.
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
    /// The tools of the two hands were swapped.
    HandsSwapped,
    /// A running tool edited the volume, or its edit was refused.
    Edited {
        /// 0 left, 1 right.
        hand: u8,
        /// Its bit.
        bit: ToolBit,
        /// The effect, in voxels.
        report: EditReport,
    },
    /// A blow split off a flake. Its voxels are also counted in [`WorldEvent::Edited`].
    Split {
        /// 0 left, 1 right.
        hand: u8,
        /// Number of voxels removed.
        removed: u32,
        /// Their bounds; for a mirrored edit, the other half is the mirror image.
        within: VoxelBox,
    },
    /// An island pass ended. It removed or kept voxels, or had no support to start from.
    Islands(IslandReport),
    /// A stroke was undone.
    Undone,
    /// A stroke was redone.
    Redone,
    /// The mirror was switched on or off.
    Symmetry(bool),
    /// More tenths of the hidden figure's ends are bared than ever before.
    Bared {
        /// Tenths bared, 1 to 10.
        tenths: u8,
    },
    /// The hidden figure was found: [`FOUND_PERCENT`](crate::session::FOUND_PERCENT) of its ends are bared.
    Found,
    /// The session ended: the sculpture is ready to be exported.
    Finished,
    /// The visit entered another phase.
    Visit(VisitPhase),
    /// The remaining time of the visit reached one of [`WARNING_SECONDS`](crate::visit::WARNING_SECONDS).
    TimeLeft {
        /// Remaining seconds.
        seconds: u16,
    },
}
