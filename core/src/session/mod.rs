//! Sessions: the world's state, and the fixed time step that advances it.
//!
//! Inputs: one tick's input and the start volumes. Outputs: edits, events, dirty columns, the poses and
//! haptics of hands, and the places of tools. Independent of devices, windows, clocks, files and pictures.

pub(crate) mod bared;
pub(crate) mod bit_edit;
pub(crate) mod bit_size;
pub(crate) mod events;
pub(crate) mod float;
pub(crate) mod grab;
pub(crate) mod hand;
pub(crate) mod input;
pub(crate) mod journals;
pub(crate) mod ledger;
pub(crate) mod start_volumes;
pub(crate) mod state;
pub(crate) mod step;
pub(crate) mod stool_frame;
pub(crate) mod strike;
pub(crate) mod tool_step;
pub(crate) mod tools;
pub(crate) mod trail;
pub(crate) mod visit_step;
pub(crate) mod workbench;
pub(crate) mod world;

pub use bared::{BaredEnds, FOUND_PERCENT};
pub use bit_size::BitSize;
pub use grab::GrabTarget;
pub use hand::HandState;
pub use input::{PointerCommand, RawPose, SessionMode, TICK_RATE, buttons, commands};
pub use state::SessionState;
pub use stool_frame::StoolFrame;
pub use tools::{Tool, ToolBit};
pub use trail::HandTrail;
pub use workbench::BenchItem;
