//! Editing: brush operations on a volume, contact of bits with it, removal of islands, undo.
//!
//! Inputs: a volume, its mask, poses in the grid and a budget. Outputs: the edited volume, reports, frozen
//! poses and undo entries. Every changed column is reported to a journal. Independent of hands, rooms,
//! metres, tools, ticks and sessions.

pub(crate) mod brush;
pub(crate) mod contact;
pub(crate) mod flake;
pub(crate) mod grid_bit;
pub(crate) mod half_space;
pub(crate) mod islands;
pub(crate) mod operation;
pub(crate) mod pose;
pub(crate) mod undo;

pub use contact::Contact;
pub use half_space::HalfSpace;
pub use islands::IslandReport;
pub use operation::{ANY_DEPTH, BrushTooLarge, Dither, EditOperation, EditReport, EditScratch};
pub use pose::{Pose, SUBUNITS_PER_VOXEL};
pub use undo::UndoCounts;
