//! Counts allocations: laying a panel out again allocates nothing.

use paros_core::badge::BadgeNumber;
use paros_models::allocations::without_allocating;
use paros_shaders::panel::layout::{self, PanelNotice, palette};
use paros_shaders::panel::{FillingValue, Icon, Language, Message, Panel};

/// Lays out the screens that are updated in every frame for a while.
fn lay_out_screens(panel: &mut Panel, seconds: u32) {
    let badge = BadgeNumber::new(seconds).expect("a number").badge();
    let fillings = [("percent", FillingValue::Number(seconds % 100))];
    let notice = PanelNotice {
        icon: Icon::Printer,
        color: palette::CLAY,
        title: Message::ExportingTitle,
        body: Message::ExportingBody,
        fillings: &fillings,
        progress: Some(0.5),
    };
    for language in Language::ALL {
        layout::draw_welcome(panel, language, 3, &layout::welcome_buttons(0, 3));
        let warning = Some(Message::WarningThirtySeconds);
        let clock = layout::Clock { seconds: Some([seconds, 600]), warning };
        layout::draw_clock(panel, language, &clock, &[]);
        layout::draw_badge(panel, language, (&badge, Message::BadgeBody), &[]);
        layout::draw_notice(panel, language, &notice, &[]);
        layout::draw_staff(panel, language, &layout::staff_buttons(0));
    }
}

#[test]
fn laying_out_again_allocates_nothing() {
    let mut panel = Panel::default();
    // Grows the buffers first, with numbers of three digits and long words.
    (500..520).for_each(|seconds| lay_out_screens(&mut panel, seconds));
    without_allocating("panels laid out again", || {
        (0..200).for_each(|seconds| lay_out_screens(&mut panel, seconds));
    });
    assert!(panel.quads().len() > 50);
}
