//! Visits in a shell: the host that feeds the core with a visitor's actions, and the panels.
//!
//! The core's [`Visit`](paros_core::visit::Visit) decides what comes next. A [`VisitHost`] stands between it
//! and a shell. Its inputs are rays, presses, the headset's presence, and the state of an export. Its outputs
//! are the visit's part of a tick's input, and panels to draw. In the attract phase it moves the hands
//! itself. It has no access to OpenXR, windows, files, or any clock but the ticks. While a start is chosen, a
//! separate thread draws previews.
#![forbid(unsafe_code)]

mod cards;
mod charger_panel;
mod export_state;
mod headset;
mod host;
mod lathe;
mod options;
mod pin_pad;
mod pointing;
mod previews;
mod queue;
mod screen;
mod standing;

pub use cards::name_of_start;
pub use charger_panel::ChargerPanel;
pub use export_state::ExportState;
pub use headset::HeadsetTick;
pub use host::{DeviceStatus, VisitHost, answer_without_visits, close_visits};
pub use options::{Controls, VisitOptions, send_plan};
pub use pointing::{POINTERS, Pointer};
pub use screen::is_at_work;
pub use standing::{PanelSpot, WindowView, room_pose};
