//! The studio as data: which meshes stand where, in which light. Takes a world, its events and input newer
//! than its last tick, and gives a list of instances to draw; knows nothing of Vulkan, nor of the shell.
//!
//! Metres, right-handed, y up, the visitor at the origin looking to -z. A surface's reflectance is the
//! mesh's colour times the instance's tint. Its radiance is that reflectance times the sum of three terms:
//! [`SUN_COLOR`] x the cosine x the sun's visibility; the harmonics of [`ROOM_AMBIENT`] (see
//! [`light::ambient_over_pi`](crate::twin::light::ambient_over_pi)) x the vertex's openness; and the tint's
//! fourth component, for what shines by itself. For particles the fourth component is the opacity instead.

pub mod assembly;
pub mod draw;
mod falling;
mod found;
mod guides;
mod island;
mod lit;
pub mod meshes;
pub mod particles;
pub mod placing;
pub mod refusal;
mod resting;

pub use assembly::{LatestInput, SceneAssembler, SculpturePlacement};
pub use draw::{Batch, DrawList, DrawListCapacity, MeshInstance};
pub use falling::MAX_FALL_SECONDS;
pub use lit::{LIT, LIT_STOOL};
pub use meshes::{DrawGroup, HandShape, MESHES, MeshId, MeshRange, MeshVertex};
pub use resting::{resting_placement, resting_studio};

pub use crate::constants::{SUN_COLOR, SUN_DIRECTION};

include!(concat!(env!("OUT_DIR"), "/ambient.rs"));

/// Linear colour of the background, where nothing is drawn: the haze over the garden.
pub const SKY: [f32; 3] = [0.93, 0.93, 0.90];

/// Bounding ball of all that casts or takes the sun's shadows: middle and radius, in metres.
pub const SUN_BOUNDS: ([f32; 3], f32) = ([0.1, 1.95, -0.1], 4.6);
