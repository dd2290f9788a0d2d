//! The parts of the shells that need `std`, shared by the window and the headset: the studio with its ticks,
//! saves and prints, atomic file writes, and the start volumes.
#![forbid(unsafe_code)]

pub mod claim;
pub mod demo;
pub mod durable;
pub mod edit_totals;
pub mod figures;
pub mod file_writer;
pub mod headset;
#[cfg(not(test))]
pub mod instances;
pub mod last_use;
pub mod log_file;
#[cfg(feature = "meshes")]
pub mod mesh;
pub mod modes;
pub mod replay;
pub mod require;
pub mod rmap;
pub mod roughness;
pub mod settings;
pub mod sizes;
pub mod start_volume_store;
pub mod statics;
pub mod stl_export;
pub mod studio;
pub mod studio_paths;
pub mod tick_runner;
pub mod trace;
