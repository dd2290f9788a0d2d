//! The lump and the figures as signed distance functions.
//!
//! Each `signed_distance` returns the distance to the surface, or a bound closer to zero, in 1/128 of the
//! box's edge. The origin is the middle of the ground. The shapes are a separate crate so that test builds
//! can optimise them.

pub mod amphora;
pub mod cat;
pub mod dolphin;
pub mod lump;
pub mod owl;
mod sdf;
pub mod toy;
