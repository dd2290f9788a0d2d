//! Panels in the room: texts, icons and boxes, laid out in code. The GPU and its CPU twin draw them from
//! the same list of quads, for the window and the headset.
//!
//! This module knows texts, sizes and colours, and where a ray meets a panel. It knows neither what a
//! button does nor when a panel is shown.

pub mod button;
mod font;
pub mod layout;
mod message;
mod model;
mod pictures;
mod pose;
mod quad;
mod wrap;

pub use button::{ButtonState, PanelButton, PanelPicture, find_button};
pub use font::{ATLAS_SIZE, FontWeight, Icon, atlas_texels, line_width};
pub use message::{Filling, FillingValue, Language, Message, PlaceStyle, TextPlace};
pub use model::{BoxStyle, LINE_HEIGHT, Panel, PanelColor, TextAlign, TextStyle};
pub use pictures::PanelPictures;
pub(crate) use pictures::is_cell_picture;
pub use pose::{PanelPoint, PanelPose, PanelRect};
pub use quad::PanelQuad;
pub(crate) use quad::linear_color;
