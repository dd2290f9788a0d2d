//! Style of the panels: dark and warm, so that the sculpture stands out. Text has a contrast of at least 4.5
//! to 1 (WCAG 2, success criterion 1.4.3) on a panel over a room of any brightness.

use egui::style::WidgetVisuals;
use egui::{
    Button, Color32, Context, CornerRadius, FontFamily, FontId, Frame, Margin, RichText,
    ScrollArea, Shadow, Stroke, TextStyle, TextWrapMode, Ui, Vec2, Visuals,
};

/// Colour of selected or emphasised items.
pub(super) const ACCENT: Color32 = Color32::from_rgb(222, 172, 104);
/// Colour of faults and warnings.
pub(super) const WARNING: Color32 = Color32::from_rgb(238, 148, 120);
/// Colour of text.
pub(super) const TEXT: Color32 = Color32::from_rgb(236, 231, 223);
/// Colour of secondary text.
pub(super) const QUIET: Color32 = Color32::from_rgb(188, 180, 170);

/// Background colour of panels.
pub(super) const PANEL: Color32 = Color32::from_rgba_premultiplied(24, 22, 21, 250);
/// Text on the accent colour.
const ON_ACCENT: Color32 = Color32::from_rgb(32, 24, 14);
const EDGE: Color32 = Color32::from_rgba_premultiplied(26, 24, 22, 26);

/// Distance of panels from the window's edge, in points.
pub(super) const MARGIN: f32 = 12.0;

/// Width of the window in points below which buttons are closer together.
const NARROW: f32 = 800.0;

/// Returns the largest size of a panel's content, in points: the window within [`MARGIN`], minus `frame`.
pub(super) fn largest_content_size(context: &Context, frame: &Frame) -> Vec2 {
    context.content_rect().shrink(MARGIN).size() - frame.total_margin().sum()
}

/// Limits a panel to the window: its content wraps and scrolls within [`largest_content_size`], whatever size
/// the panel had in the frame before.
pub(super) fn show_within_window<R>(
    ui: &mut Ui,
    frame: Frame,
    width: f32,
    add_contents: impl FnOnce(&mut Ui) -> R,
) -> R {
    let largest = largest_content_size(ui.ctx(), &frame);
    let shown = frame.show(ui, |ui| {
        ui.set_max_height(largest.y);
        ui.set_width(width.min(largest.x));
        let area = ScrollArea::vertical().max_height(largest.y).auto_shrink([false, true]);
        area.show(ui, add_contents).inner
    });
    shown.inner
}

/// Lays out buttons and labels in rows that are no wider than the window.
pub(super) fn show_rows<R>(ui: &mut Ui, frame: Frame, add_rows: impl FnOnce(&mut Ui) -> R) -> R {
    let largest = largest_content_size(ui.ctx(), &frame);
    let is_narrow = ui.ctx().content_rect().width() < NARROW;
    let shown = frame.show(ui, |ui| {
        ui.set_max_width(largest.x);
        ui.style_mut().wrap_mode = Some(TextWrapMode::Extend);
        if is_narrow {
            ui.spacing_mut().item_spacing = Vec2::splat(5.0);
            ui.spacing_mut().button_padding = Vec2::new(8.0, 4.0);
            ui.spacing_mut().interact_size.y = 26.0;
        }
        add_rows(ui)
    });
    shown.inner
}

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

/// Returns the frame and background of a panel.
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

/// Returns the frame and background of a line of text over the picture.
pub(super) fn line_frame() -> Frame {
    Frame::new()
        .fill(PANEL)
        .corner_radius(CornerRadius::same(8))
        .inner_margin(Margin::symmetric(10, 4))
}

/// Returns secondary text.
pub(super) fn quiet_text(text: impl Into<String>) -> RichText {
    RichText::new(text).color(QUIET)
}

/// Returns a button, filled with the accent colour if `chosen`.
pub(super) fn choice_button(text: &str, chosen: bool) -> Button<'_> {
    if chosen {
        Button::new(RichText::new(text).color(ON_ACCENT)).fill(ACCENT)
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
    visuals.widgets.active = widget(light(54), Color32::WHITE);
    visuals.widgets.open = widget(light(34), TEXT);
    visuals.selection.bg_fill = ACCENT.gamma_multiply(0.4);
    visuals.selection.stroke = Stroke::new(1.0, TEXT);
    visuals
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the linear value of an sRGB channel.
    fn linear(channel: u8) -> f64 {
        let value = f64::from(channel) / 255.0;
        if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
    }

    /// Blends a premultiplied colour over a linear one, as the overlay's shader and an sRGB target do.
    fn over(color: Color32, below: [f64; 3]) -> [f64; 3] {
        let shown = 1.0 - f64::from(color.a()) / 255.0;
        let [r, g, b, _] = color.to_array();
        let own = [r, g, b].map(linear);
        [0, 1, 2].map(|k| own[k] + shown * below[k])
    }

    /// Returns the contrast ratio of WCAG 2 between two linear colours.
    fn contrast(a: [f64; 3], b: [f64; 3]) -> f64 {
        let luminance = |[r, g, b]: [f64; 3]| 0.2126 * r + 0.7152 * g + 0.0722 * b;
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn text_is_read_over_the_brightest_room_and_the_darkest() {
        let visuals = dark_visuals();
        let widgets = visuals.widgets;
        let on_panel = [ACCENT, WARNING, TEXT, QUIET];
        for room in [[1.0; 3], [0.0; 3]] {
            let panel = over(PANEL, room);
            let mut pairs: Vec<_> = on_panel.map(|text| (text, panel)).into();
            for widget in [widgets.inactive, widgets.hovered, widgets.active, widgets.open] {
                let button = over(widget.bg_fill, panel);
                pairs.extend([(widget.fg_stroke.color, button), (QUIET, button)]);
            }
            pairs.push((visuals.selection.stroke.color, over(visuals.selection.bg_fill, panel)));
            pairs.push((ON_ACCENT, over(ACCENT, panel)));
            for (text, ground) in pairs {
                let ratio = contrast(over(text, ground), ground);
                assert!(ratio >= 4.5, "{text:?} on {ground:?}, room {room:?}: {ratio:.2}");
            }
        }
    }

    #[test]
    fn contrast_is_that_of_the_definition() {
        let gray = |value| over(Color32::from_gray(value), [0.0; 3]);
        assert!((contrast(gray(255), gray(0)) - 21.0).abs() < 1e-9);
        // The lightest gray with a sufficient contrast on white.
        assert!((contrast(gray(118), gray(255)) - 4.54).abs() < 0.01);
    }
}
