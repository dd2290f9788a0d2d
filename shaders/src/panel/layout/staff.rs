//! Screens for the staff: the handover between two visitors, the PIN pad, and the menu that the PIN opens.

use glam::Vec2;

use super::screens::{PanelNotice, draw_notice};
use super::{begin_panel, palette, visit};
use crate::panel::button::{ButtonLabel, PanelButton, PanelPicture};
use crate::panel::font::Icon;
use crate::panel::message::{FillingValue, Language, Message};
use crate::panel::model::{BoxStyle, Panel, TextAlign};
use crate::panel::pose::PanelRect;

/// Digits of the staff's PIN that have a dot.
pub const PIN_DIGITS: u32 = 4;

/// The state of the PIN's panel.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum PinEntry {
    /// This many digits are entered.
    Entered(u32),
    /// The digits entered were not the PIN.
    Wrong,
    /// A wrong PIN was entered too often.
    Locked,
}

/// The state of the sculptures, shown to the staff as a headset is handed over.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct HandoverTold {
    /// Sculptures not yet stored on the device.
    pub pending: u32,
    /// Sculptures not yet acknowledged by the booth; `None` where there is no booth.
    pub owed: Option<u32>,
    /// `true` if sculptures nearly fill the device.
    pub is_nearly_full: bool,
}

/// Draws the handover: the sculptures that the device or the booth doesn't have yet, and the button to
/// press once the headset is cleaned.
pub fn draw_handover(
    panel: &mut Panel,
    language: Language,
    told: HandoverTold,
    buttons: &[PanelButton<'_>],
) {
    let HandoverTold { pending, owed, is_nearly_full } = told;
    let (warning, fine) = ((Icon::Warning, palette::AMBER), (Icon::Tick, palette::OLIVE));
    let ((icon, color), body, count) = match (pending, owed) {
        (1, _) => (warning, Message::HandoverPendingOne, 1),
        (2.., _) => (warning, Message::HandoverPendingMany, pending),
        (0, Some(owed @ 1..)) if is_nearly_full => (warning, Message::HandoverNearlyFull, owed),
        (0, None) => (fine, Message::HandoverSafe, 0),
        (0, Some(0)) => (fine, Message::HandoverAtBooth, 0),
        (0, Some(1)) => (fine, Message::HandoverOwedOne, 1),
        (0, Some(owed)) => (fine, Message::HandoverOwedMany, owed),
    };
    let notice = PanelNotice {
        icon,
        color,
        title: Message::HandoverTitle,
        body,
        fillings: &[("count", FillingValue::Number(count))],
        progress: None,
    };
    draw_notice(panel, language, &notice, buttons);
}

/// Returns the keys of the PIN: 1 to 9, back, 0, cancel; numbered from `first_id` on in this order.
#[must_use]
pub fn pin_buttons(first_id: u16) -> [PanelButton<'static>; 12] {
    const DIGITS: [&str; 9] = ["1", "2", "3", "4", "5", "6", "7", "8", "9"];
    core::array::from_fn(|k| {
        let (column, row) = ((k % 3) as f32, (k / 3) as f32);
        let rect = PanelRect::new(60.0 + 170.0 * column, 250.0 + 122.0 * row, 150.0, 104.0);
        let key = PanelButton::new(first_id + k as u16, rect, Message::Cancel);
        let icon =
            |icon| PanelButton { label: None, picture: Some(PanelPicture::Icon(icon)), ..key };
        match k {
            0..9 => key.with_label(ButtonLabel::Text(DIGITS[k])),
            9 => icon(Icon::Back),
            10 => key.with_label(ButtonLabel::Text("0")),
            _ => icon(Icon::Cross),
        }
    })
}

/// Draws the PIN's panel.
pub fn draw_staff_pin(
    panel: &mut Panel,
    language: Language,
    entry: PinEntry,
    buttons: &[PanelButton<'_>],
) {
    begin_panel(panel, [610.0, 770.0]);
    let (message, color, entered) = match entry {
        PinEntry::Entered(count) => (Message::StaffPin, palette::SOFT_INK, count),
        PinEntry::Wrong => (Message::StaffPinWrong, palette::RED, 0),
        PinEntry::Locked => (Message::StaffPinLocked, palette::RED, 0),
    };
    let at = |y| Vec2::new(305.0, y);
    let ink = (palette::CLAY, TextAlign::Middle);
    panel.add_message(Message::StaffTitle, (language, &[]), at(80.0), ink);
    panel.add_message(message, (language, &[]), at(144.0), (color, TextAlign::Middle));
    for k in 0..PIN_DIGITS {
        let x = 305.0 + 64.0 * (k as f32 - 0.5 * (PIN_DIGITS - 1) as f32);
        let dot = PanelRect::new(x, 198.0, 0.0, 0.0).grown(15.0);
        let fill = if k < entered { palette::INK } else { palette::GROUND };
        let style = BoxStyle {
            radius_mm: 15.0,
            fill,
            outline: palette::INK,
            outline_mm: 3.5,
            ..BoxStyle::default()
        };
        panel.add_box(dot, &style);
    }
    visit::add_buttons(panel, language, buttons);
}

/// Returns the staff's buttons: a minute more, end, begin again, recentre, cancel; numbered from `first_id`
/// on.
#[must_use]
pub const fn staff_buttons(first_id: u16) -> [PanelButton<'static>; 5] {
    const fn at(column: u16, row: u16) -> PanelRect {
        PanelRect::new(50.0 + 530.0 * column as f32, 150.0 + 152.0 * row as f32, 510.0, 130.0)
    }
    [
        PanelButton::new(first_id, at(0, 0), Message::StaffExtend).with_icon(Icon::Plus).primary(),
        PanelButton::new(first_id + 1, at(1, 0), Message::StaffEnd).with_icon(Icon::Tick),
        PanelButton::new(first_id + 2, at(0, 1), Message::StaffReset).with_icon(Icon::Turn),
        PanelButton::new(first_id + 3, at(1, 1), Message::StaffRecentre).with_icon(Icon::Recentre),
        PanelButton::new(first_id + 4, PanelRect::new(365.0, 462.0, 410.0, 100.0), Message::Cancel)
            .with_icon(Icon::Cross),
    ]
}

/// Draws the staff's menu, which the PIN opens.
pub fn draw_staff(panel: &mut Panel, language: Language, buttons: &[PanelButton<'_>]) {
    begin_panel(panel, [1140.0, 600.0]);
    let at = Vec2::new(570.0, 92.0);
    panel.add_message(Message::StaffTitle, (language, &[]), at, (palette::CLAY, TextAlign::Middle));
    visit::add_buttons(panel, language, buttons);
}
