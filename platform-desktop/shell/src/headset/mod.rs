//! Policies of the headset that need no device, and that the exhibition, the settings or the package need
//! too.
//!
//! They cover hand input, haptics, rendering resolution, who wears the headset, its temperature, and the
//! contents of the app's package. They take plain numbers and times from a runtime or a device, and return
//! inputs and decisions. They call neither OpenXR nor Android. `paros-headset` has the other policies.

pub mod device_health;
pub mod foveation;
pub mod hand_reader;
pub mod hand_sample;
pub mod haptics;
pub mod height_step;
pub mod package;
pub mod resolution;
pub mod sealed;
pub mod visit;
