//! Policies of the headset that need no device, and that the exhibition, the settings or the package need too: what hands
//! are read from, feel and do, how much is drawn, who wears the headset, how hot it is, and what the app's package holds.
//! They take plain numbers and times, as a runtime or a device tells them, and give inputs and decisions.
//! They call neither OpenXR nor Android. `paros-headset` has the others.

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
