//! Style of the panels: dark, warm and low in contrast, so that the sculpture stands out.

use egui::style::WidgetVisuals;
use egui::{
    Button, Color32, Context, CornerRadius, FontFamily, FontId, Frame, Margin, RichText, Shadow,
    Stroke, TextStyle, Vec2, Visuals,
};

/// Colour of what is selected or emphasised.
pub(super) const ACCENT: Color32 = Color32::from_rgb(222, 172, 104);
/// Colour of faults.
pub(super) const WARNING: Color32 = Color32::from_rgb(238, 148, 120);
/// Colour of text.
pub(super) const TEXT: Color32 = Color32::from_rgb(236, 231, 223);
/// Colour of secondary text.
pub(super) const QUIET: Color32 = Color32::from_rgb(163, 155, 145);

const PANEL: Color32 = Color32::from_rgba_premultiplied(24, 22, 21, 238);
const EDGE: Color32 = Color32::from_rgba_premultiplied(26, 24, 22, 26);

/// Sets the style of all panels.
pub(super) fn set_style(context: &Context) {
    context.all_styles_mut(|style| {
        let font = |size| FontId::new(size, FontFamily::Proportional);
        style.text_styles = [
            (TextStyle::Small, font(12.0)),
            (TextStyle::Body, font(15.0)),
            (TextStyle::Button, font(15.0)),
            (TextStyle::Heading, font(19.0)),
            (TextStyle::Monospace, FontId::new(13.0, FontFamily::Monospace)),
        ]
        .into();
        style.spacing.item_spacing = Vec2::new(8.0, 8.0);
        style.spacing.button_padding = Vec2::new(12.0, 7.0);
        style.spacing.interact_size.y = 32.0;
        style.interaction.selectable_labels = false;
        style.visuals = dark_visuals();
    });
}

/// Frame and background of a panel.
pub(super) fn card_frame() -> Frame {
    Frame::new()
        .fill(PANEL)
        .stroke(Stroke::new(1.0, EDGE))
        .corner_radius(CornerRadius::same(12))
        .inner_margin(Margin::symmetric(16, 12))
        .shadow(Shadow {
            offset: [0, 6],
            blur: 24,
            spread: 0,
            color: Color32::from_black_alpha(90),
        })
}

/// Secondary text.
pub(super) fn quiet_text(text: impl Into<String>) -> RichText {
    RichText::new(text).color(QUIET)
}

/// A button, filled with the accent colour if `chosen`.
pub(super) fn choice_button(text: &str, chosen: bool) -> Button<'_> {
    if chosen {
        let dark = Color32::from_rgb(32, 24, 14);
        Button::new(RichText::new(text).color(dark)).fill(ACCENT)
    } else {
        Button::new(text)
    }
}

fn dark_visuals() -> Visuals {
    let mut visuals = Visuals::dark();
    let light = |alpha| Color32::from_white_alpha(alpha);
    let widget = |fill: Color32, text: Color32| WidgetVisuals {
        bg_fill: fill,
        weak_bg_fill: fill,
        bg_stroke: Stroke::NONE,
        corner_radius: CornerRadius::same(8),
        fg_stroke: Stroke::new(1.0, text),
        expansion: 0.0,
    };
    visuals.widgets.noninteractive = widget(Color32::TRANSPARENT, TEXT);
    visuals.widgets.noninteractive.bg_stroke = Stroke::new(1.0, light(24));
    visuals.widgets.inactive = widget(light(26), TEXT);
    visuals.widgets.hovered = widget(light(44), Color32::WHITE);
    visuals.widgets.active = widget(light(64), Color32::WHITE);
    visuals.widgets.open = widget(light(34), TEXT);
    visuals.selection.bg_fill = ACCENT.gamma_multiply(0.4);
    visuals.selection.stroke = Stroke::new(1.0, TEXT);
    visuals
}
