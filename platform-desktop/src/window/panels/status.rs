//! What the panels are told of the studio.

use std::path::Path;

use paros_core::edit::UndoCounts;
use paros_core::session::{BitSize, SessionMode, SessionState, Tool, ToolBit};
use paros_core::visit::VisitPhase;
use paros_shaders::gpu::FrameTimes;
use paros_shaders::panel::Language;

use super::{BitOutline, ItemGlow, MirrorGuide};
use crate::window::slowness::Slowness;

/// The studio's status that the panels show.
#[derive(Clone, Copy, Debug)]
pub(in crate::window) struct StudioStatus<'a> {
    /// State of the session.
    pub(in crate::window) session: SessionState,
    /// Mode of the session.
    pub(in crate::window) mode: SessionMode,
    /// The tool in hand.
    pub(in crate::window) held: Option<(Tool, ToolBit)>,
    /// The held bit's size.
    pub(in crate::window) size: BitSize,
    /// Whether the hand is steadied.
    pub(in crate::window) is_steadied: bool,
    /// The tool's depth in millimetres of the room; negative is above the surface.
    pub(in crate::window) depth_mm: f32,
    /// Millimetres of the print for one of the room; `None` without a voxel to print.
    pub(in crate::window) print_scale: Option<f32>,
    /// How much of the hidden figure is bared, in percent; 0 without one.
    pub(in crate::window) bared_percent: u32,
    /// The world's tick.
    pub(in crate::window) tick: u64,
    /// Whether the tool in hand runs.
    pub(in crate::window) runs: bool,
    /// Whether its bit is on the hidden figure.
    pub(in crate::window) is_on_figure: bool,
    /// Whether paste is being laid where the volume ends.
    pub(in crate::window) pastes_beyond_box: bool,
    /// Whether edits are mirrored.
    pub(in crate::window) symmetry: bool,
    /// Strokes to undo and to redo.
    pub(in crate::window) undo: UndoCounts,
    /// Whether another start would leave an unfinished sculpture.
    pub(in crate::window) unfinished: bool,
    /// Whether there is a sculpture before this one to be had back.
    pub(in crate::window) one_before: bool,
    /// Whether a print is being made.
    pub(in crate::window) printing: bool,
    /// Path of the last print.
    pub(in crate::window) printed: Option<&'a Path>,
    /// Whether a print could not be written.
    pub(in crate::window) unwritten: bool,
    /// Whether frames take so long that ticks are dropped.
    pub(in crate::window) slow: Option<Slowness>,
    /// Voxels along an edge.
    pub(in crate::window) grid_side: usize,
    /// Why the session is not on the disk.
    pub(in crate::window) fault: Option<&'a str>,
    /// The file being read.
    pub(in crate::window) opening: Option<&'a Path>,
    /// The visitor's language.
    pub(in crate::window) language: Language,
    /// Where the visit stands, if sessions are visits.
    pub(in crate::window) visit: Option<VisitPhase>,
    /// Whether a visit's guide has its panel.
    pub(in crate::window) has_guide: bool,
    /// Whether a visit's panel asks something, over the tools.
    pub(in crate::window) is_asking: bool,
    /// Whether the window is one of a kiosk.
    pub(in crate::window) kiosk: bool,
    /// Seconds until a kiosk hands over, once they are to be told.
    pub(in crate::window) seconds_to_handover: Option<u32>,
    /// Whether files can be dropped on the window.
    pub(in crate::window) drops: bool,
    /// Whether the fast path draws.
    pub(in crate::window) fast: bool,
    /// Name of the GPU.
    pub(in crate::window) device: &'a str,
    /// GPU times of the latest frame.
    pub(in crate::window) times: FrameTimes,
    /// Outline of the bit.
    pub(in crate::window) outline: Option<&'a BitOutline>,
    /// What shows of the mirror where it works.
    pub(in crate::window) mirror: Option<&'a MirrorGuide>,
    /// The item on the workbench that a click takes.
    pub(in crate::window) glow: Option<&'a ItemGlow>,
}
