//! What happened in a tick, for shells to show, sound and log.

use crate::edit::EditReport;
use crate::input::Mode;
use crate::islands::IslandReport;
use crate::tools::{Bit, Tool};
use crate::workbench::Item;

/// One thing that happened.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Event {
    /// A session started.
    Started(Mode),
    /// A session was to start from a volume that isn't there; nothing changed.
    NoSuchStart,
    /// A hand took a tool, or mounted a bit.
    Took {
        /// 0 left, 1 right.
        hand: u8,
        /// What it took.
        item: Item,
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
    /// A running tool met the volume.
    Edited {
        /// 0 left, 1 right.
        hand: u8,
        /// Its bit.
        bit: Bit,
        /// What that did.
        report: EditReport,
    },
    /// A search for islands ended with something to tell.
    Islands(IslandReport),
    /// A stroke was taken back.
    Undone,
    /// A stroke was brought back.
    Redone,
    /// The mirror was switched.
    Symmetry(bool),
    /// The session ended: the sculpture is to be exported.
    Finished,
}
