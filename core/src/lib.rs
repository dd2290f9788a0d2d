//! A solid block held as three axial range maps, carved and filled by [`World::step`]: one tick's
//! input in, dirty columns, events and a digest out.
//!
//! It follows "Real-Time Volume Editing on Low-Power Virtual Reality Devices" (Evangelou,
//! Gkaravelis and Papaioannou, GRAPP 2023), *the paper* in these pages.
//!
//! It does no I/O, allocates nothing, reads no clock, draws no picture and never panics on input.
//! Files, time and devices are the shells' (`paros-shell`); pictures are `paros-shaders`'.
//!
//! # The closure rule
//! The volume is always the intersection of its three range maps, and every range is *tight*: both
//! its end voxels are occupied. An edit is the exact boolean operation on voxels, then closure: the
//! ranges become the tight hulls of the result, and the volume their intersection. So a carve can
//! only fail to remove voxels of its own brush, and a fill can add others only along the three
//! beams of columns through its brush.
//!
//! # Principles
//! 1. Data in, data out: a tick is a function of state, input and start volumes.
//! 2. Time is an argument: one step is a 72nd of a second, and nothing else knows the hour.
//! 3. Decisions are made in integers; floats carry poses between two ticks, and behave alike on
//!    every target (glam with `scalar-math`, libm).
//! 4. Memory is fixed: every capacity stands in [`limits`] with its reason.
//! 5. All zero bytes are the empty world: it lives in a `static`, and never moves.
//! 6. Long work is a state machine with a budget in units of work, never in time.
//! 7. What changed is said (columns, rows, events, rectangles), so that nobody has to look.
//! 8. Failure leaves the state untouched.
//!
//! [`World::step`]: world::World::step
#![no_std]
#![forbid(unsafe_code)]

pub mod bake;
pub mod brush;
pub mod codec;
pub mod contact;
pub mod dirty;
pub mod edit;
pub mod events;
pub mod export;
pub mod frame;
pub mod hand;
pub mod input;
pub mod islands;
pub mod limits;
pub mod maps;
pub mod plane;
pub mod pose;
pub mod row;
mod save;
pub mod shell;
pub mod size;
mod state;
pub mod tick;
pub mod tools;
pub mod trace;
pub mod undo;
pub mod volume;
pub mod workbench;
pub mod world;

pub use save::{PARTS, checksum, combine};
