//! The screens of a visit: layout functions of plain data, each of which clears a panel and fills it.
//!
//! The caller gives the buttons, with the rectangles of this module (`*_buttons`) or others.

pub mod palette;
mod screens;
mod staff;
mod visit;

pub use screens::{
    PanelNotice, badge_buttons, draw_attract, draw_badge, draw_notice, notice_button,
};
pub use staff::{HandoverTold, PIN_DIGITS, PinEntry, draw_handover, draw_staff, draw_staff_pin};
pub use staff::{pin_buttons, staff_buttons};
pub use visit::{Clock, Guide, choice_buttons, draw_choice, draw_clock, draw_guide, draw_welcome};
pub use visit::{guide_buttons, welcome_buttons};

use glam::Vec2;

use super::font::Icon;
use super::message::{Language, Message};
use super::model::{BoxStyle, Panel, PanelColor, TextAlign};
use super::pose::PanelRect;

/// Distance of panels from the eye, in metres: there their texts are at least a degree high.
pub const READING_DISTANCE: f32 = 1.2;

/// Clears a panel and draws its ground and its shadow.
fn begin_panel(panel: &mut Panel, size_mm: [f32; 2]) {
    panel.clear(size_mm);
    let whole = panel.rect();
    let shadow = PanelRect { y: whole.y + 10.0, ..whole };
    let soft = BoxStyle {
        radius_mm: 40.0,
        fill: palette::SHADOW,
        softness_mm: 44.0,
        ..BoxStyle::default()
    };
    panel.add_box(shadow, &soft);
    let ground = BoxStyle {
        radius_mm: 32.0,
        fill: palette::GROUND,
        outline: palette::LINE,
        outline_mm: 2.5,
        ..BoxStyle::default()
    };
    panel.add_box(whole, &ground);
}

/// Adds a title in the middle of a panel, with a short rule under it.
fn add_title(panel: &mut Panel, language: Language, title: Message, foot_y: f32) {
    let middle = 0.5 * panel.size_mm()[0];
    let at = Vec2::new(middle, foot_y);
    panel.add_message(title, (language, &[]), at, (palette::INK, TextAlign::Middle));
    add_rule(panel, Vec2::new(middle, foot_y + 30.0));
}

/// Adds a short rule in the colour of clay.
fn add_rule(panel: &mut Panel, middle: Vec2) {
    let rule = PanelRect::new(middle.x - 45.0, middle.y - 3.0, 90.0, 6.0);
    let style = BoxStyle { radius_mm: 3.0, fill: palette::CLAY, ..BoxStyle::default() };
    panel.add_box(rule, &style);
}

/// Adds an icon on a disc.
fn add_medallion(panel: &mut Panel, icon: Icon, middle: Vec2, radius_mm: f32, color: PanelColor) {
    let square = PanelRect::new(middle.x, middle.y, 0.0, 0.0).grown(radius_mm);
    panel.add_box(square, &BoxStyle { radius_mm, fill: color, ..BoxStyle::default() });
    panel.add_icon(icon, square.grown(-0.42 * radius_mm), palette::GROUND);
}
