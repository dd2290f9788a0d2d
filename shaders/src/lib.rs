//! Ray marching renderer of sculptures stored as range maps: the Vulkan renderer and its CPU twin.
//!
//! - [`twin`]: the CPU's pictures, the reference that a GPU's pictures are compared with.
//! - [`field`]: the textures that the fast path marches, kept up to date where the volume changed.
//! - [`scene`]: the studio as data: which meshes stand where, in which light.
//! - [`panel`]: panels of text and pictures in the room, with their texts and layouts.
//! - [`gpu`]: the Vulkan renderer of all that.
//!
//! Inside the volume lengths are voxels; outside, the twin's studio measures in sides of the cube
//! and the scene's in metres.

pub mod constants;
pub mod field;
pub mod gpu;
pub mod limits;
pub mod panel;
pub mod scene;
pub mod twin;
pub mod upload;

pub use twin::camera::{self, Camera};
pub use twin::fragment::{self, ShadedHit, TwinScene, TwinSettings, shade_ray};
pub use twin::image::{self, Image, contact_sheet};
pub use twin::march::{self, Ray};
pub use twin::panels::{render_panel_flat, render_panels, render_panels_with_pictures};
pub use twin::render::{
    self, PORTRAIT_SIZE, RenderOptions, lit_studio, portrait_camera, render_image,
    render_image_in_room, render_image_with_panels, render_portrait_png,
};
pub use twin::room::{self, LitRoom};
pub use twin::{carrara, fast, harmonics, light, marble, noise, studio, surface};
