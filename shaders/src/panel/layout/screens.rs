//! Informative screens: attract, notices with or without a bar, and the badge.

use glam::Vec2;
use paros_core::badge::Badge;

use super::{add_medallion, add_rule, begin_panel, palette, visit};
use crate::panel::button::PanelButton;
use crate::panel::font::Icon;
use crate::panel::message::{Filling, Language, Message, TextPlace};
use crate::panel::model::{BoxStyle, LINE_HEIGHT, Panel, PanelColor, TextAlign};
use crate::panel::pose::PanelRect;

/// Draws the attract screen, in both languages, as none is chosen yet; `icon` and `body_message` show how
/// to begin.
pub fn draw_attract(panel: &mut Panel, icon: Icon, body_message: Message) {
    begin_panel(panel, [1000.0, 610.0]);
    add_medallion(panel, icon, Vec2::new(500.0, 128.0), 82.0, palette::CLAY);
    for (language, foot) in Language::ALL.into_iter().zip([306.0, 494.0]) {
        let (title, body) = (Vec2::new(500.0, foot), Vec2::new(500.0, foot + 64.0));
        let ink = (palette::INK, TextAlign::Middle);
        let soft = (palette::SOFT_INK, TextAlign::Middle);
        panel.add_message(Message::AttractTitle, (language, &[]), title, ink);
        panel.add_message(body_message, (language, &[]), body, soft);
    }
    add_rule(panel, Vec2::new(500.0, 412.0));
}

/// A title and a text, with a picture.
#[derive(Clone, Copy, Debug)]
pub struct PanelNotice<'a> {
    /// The picture.
    pub icon: Icon,
    /// The colour of the picture's disc and of the bar.
    pub color: PanelColor,
    /// The title.
    pub title: Message,
    /// The text.
    pub body: Message,
    /// The values filled into the text.
    pub fillings: &'a [Filling<'a>],
    /// Fill level of a progress bar, 0 to 1; `None` for no bar.
    pub progress: Option<f32>,
}

/// Returns a notice's button, under its text, in column `column` of `columns`.
#[must_use]
pub const fn notice_button(
    id: u16,
    message: Message,
    column: u16,
    columns: u16,
) -> PanelButton<'static> {
    let (width, gap) = (440.0, 30.0);
    let all = columns as f32 * (width + gap) - gap;
    let left = 0.5 * (1000.0 - all) + column as f32 * (width + gap);
    PanelButton::new(id, PanelRect::new(left, NOTICE_HEIGHT, width, 106.0), message)
}

/// Height of a notice without bar and buttons, in millimetres.
const NOTICE_HEIGHT: f32 = 500.0;

/// Draws a notice: hands off, exporting, thanks, put back, warnings and errors.
pub fn draw_notice(
    panel: &mut Panel,
    language: Language,
    notice: &PanelNotice<'_>,
    buttons: &[PanelButton<'_>],
) {
    let height = NOTICE_HEIGHT + if buttons.is_empty() { 0.0 } else { 150.0 };
    begin_panel(panel, [1000.0, height]);
    add_medallion(panel, notice.icon, Vec2::new(500.0, 116.0), 74.0, notice.color);
    let ink = (palette::INK, TextAlign::Middle);
    panel.add_message(notice.title, (language, &[]), Vec2::new(500.0, 270.0), ink);
    let soft = (palette::SOFT_INK, TextAlign::Middle);
    let foot = Vec2::new(500.0, 346.0);
    panel.add_message(notice.body, (language, notice.fillings), foot, soft);
    if let Some(part) = notice.progress {
        let bar = PanelRect::new(150.0, 442.0, 700.0, 22.0);
        panel.add_progress_bar(bar, part, [palette::LINE, notice.color]);
    }
    visit::add_buttons(panel, language, buttons);
}

/// Returns the button of a badge's panel, which leads to the next screen.
#[must_use]
pub const fn badge_buttons(id: u16) -> [PanelButton<'static>; 1] {
    [PanelButton::new(id, PanelRect::new(355.0, 800.0, 290.0, 96.0), Message::Next)]
}

/// Size of a badge's panel, with room for its button: the button appears later, and the badge, which the
/// visitor is learning, must not move.
const BADGE_SIZE: [f32; 2] = [1000.0, 936.0];

/// Draws a visitor's badge, its words, and a message below, of at most two lines of body text.
pub fn draw_badge(
    panel: &mut Panel,
    language: Language,
    (badge, told): (&Badge, Message),
    buttons: &[PanelButton<'_>],
) {
    begin_panel(panel, BADGE_SIZE);
    super::add_title(panel, language, Message::BadgeTitle, 100.0);
    panel.add_badge(badge, PanelRect::new(64.0, 176.0, 430.0, 430.0));
    let style = TextPlace::Word.style().colored(palette::INK, TextAlign::Left);
    let [r, g, b] = badge.colour.ground();
    let row = |k: usize| PanelRect::new(540.0, 180.0 + 87.0 * k as f32, 70.0, 70.0);
    let foot = |rect: PanelRect| Vec2::new(rect.x + 94.0, rect.middle().y + 0.5 * style.capital_mm);
    let swatch = BoxStyle {
        radius_mm: 14.0,
        fill: [r, g, b, 255],
        outline: palette::INK,
        outline_mm: 2.5,
        ..BoxStyle::default()
    };
    panel.add_box(row(0).grown(-6.0), &swatch);
    panel.add_line(badge.colour.name(language), foot(row(0)), &style);
    for (k, pictogram) in badge.pictograms.iter().enumerate() {
        panel.add_pictogram(*pictogram, row(k + 1), palette::INK);
        panel.add_line(pictogram.name(language), foot(row(k + 1)), &style);
    }
    let capital = told.place().style().capital_mm;
    let body = Vec2::new(500.0, 672.0 + 0.5 * capital);
    let soft = (palette::SOFT_INK, TextAlign::Middle);
    let lines = panel.add_message(told, (language, &[]), body, soft);
    debug_assert!(lines as f32 * LINE_HEIGHT * capital < 128.0, "two lines fit");
    visit::add_buttons(panel, language, buttons);
}
