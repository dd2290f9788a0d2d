#![no_std]
#![forbid(unsafe_code)]
//! The sculpture as three axial range maps, and every decision about it.
pub mod brush;
pub mod codec;
pub mod dirty;
pub mod edit;
pub mod limits;
pub mod maps;
pub mod plane;
pub mod pose;
pub mod row;
pub mod shell;
pub mod size;
pub mod volume;
