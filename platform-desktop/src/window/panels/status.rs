//! The studio's status, as input of the panels.

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
    /// `true` if the hand is steadied.
    pub(in crate::window) is_steadied: bool,
    /// The tool's depth in millimetres of the room; negative is above the surface.
    pub(in crate::window) depth_mm: f32,
    /// Millimetres of the print for each millimetre in the room; `None` for an empty volume.
    pub(in crate::window) print_scale: Option<f32>,
    /// Bared percentage of the hidden figure; 0 without a figure.
    pub(in crate::window) bared_percent: u32,
    /// The world's tick.
    pub(in crate::window) tick: u64,
    /// `true` while the tool in hand runs.
    pub(in crate::window) runs: bool,
    /// `true` while the tool's bit is on the hidden figure.
    pub(in crate::window) is_on_figure: bool,
    /// `true` while paste is laid beyond the volume.
    pub(in crate::window) pastes_beyond_box: bool,
    /// `true` if edits are mirrored.
    pub(in crate::window) symmetry: bool,
    /// Numbers of strokes that can be undone and redone.
    pub(in crate::window) undo: UndoCounts,
    /// `true` if another start would discard an unfinished sculpture.
    pub(in crate::window) unfinished: bool,
    /// `true` if there is a previous sculpture to go back to.
    pub(in crate::window) one_before: bool,
    /// `true` while a print is being made.
    pub(in crate::window) printing: bool,
    /// Path of the last print.
    pub(in crate::window) printed: Option<&'a Path>,
    /// `true` if a print could not be written.
    pub(in crate::window) unwritten: bool,
    /// Measured slowness, if frames take so long that ticks are dropped.
    pub(in crate::window) slow: Option<Slowness>,
    /// Voxels along an edge.
    pub(in crate::window) grid_side: usize,
    /// Reason why the session could not be saved to disk.
    pub(in crate::window) fault: Option<&'a str>,
    /// The file being read.
    pub(in crate::window) opening: Option<&'a Path>,
    /// The visitor's language.
    pub(in crate::window) language: Language,
    /// Phase of the visit; `None` without visits.
    pub(in crate::window) visit: Option<VisitPhase>,
    /// `true` if the visit's guide shows its panel.
    pub(in crate::window) has_guide: bool,
    /// `true` if a visit's panel asks a question over the tools.
    pub(in crate::window) is_asking: bool,
    /// `true` in kiosk mode.
    pub(in crate::window) kiosk: bool,
    /// Seconds until a kiosk hands over; `None` before the countdown starts.
    pub(in crate::window) seconds_to_handover: Option<u32>,
    /// `true` if files can be dropped on the window.
    pub(in crate::window) drops: bool,
    /// `true` if the fast path draws.
    pub(in crate::window) fast: bool,
    /// Name of the GPU.
    pub(in crate::window) device: &'a str,
    /// GPU times of the latest frame.
    pub(in crate::window) times: FrameTimes,
    /// Outline of the bit.
    pub(in crate::window) outline: Option<&'a BitOutline>,
    /// The mirror's plane and reflection, while the mirror is in use.
    pub(in crate::window) mirror: Option<&'a MirrorGuide>,
    /// The item on the workbench that a click takes.
    pub(in crate::window) glow: Option<&'a ItemGlow>,
}
