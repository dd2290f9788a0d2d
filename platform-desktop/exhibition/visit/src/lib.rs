//! Visits in a shell: what the core is told of a visitor, and the panels that show what it decides.
//!
//! The core's [`Visit`](paros_core::visit::Visit) decides what comes next; a [`VisitHost`] stands between it and a shell.
//! It takes rays and presses, whether the headset is worn, and how far an export is; it gives the visit's part of a
//! tick's input, and panels to be drawn. While nobody is there it moves the hands itself. It knows no
//! OpenXR, no window, no file and no clock but the ticks. While a start is chosen, a thread of its own draws previews.
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
