//! Countdown of a kiosk to the next visitor's turn.

use egui::{Align2, Area, Context, Id, Order, RichText, Vec2};
use paros_core::edit::UndoCounts;
use paros_core::session::SessionState;

use super::{StudioStatus, style};

/// Shows an idle visitor of a kiosk the countdown to the next visitor's turn.
pub(super) fn show(context: &Context, status: &StudioStatus<'_>, seconds: u32) {
    let area = Area::new(Id::new("handover"))
        .order(Order::Foreground)
        .anchor(Align2::CENTER_CENTER, Vec2::ZERO);
    area.interactable(false).show(context, |ui| {
        style::card_frame().inner_margin(24).show(ui, |ui| {
            ui.label(RichText::new("Are you still here?").size(24.0));
            let text = handover_text(status.session, status.undo, seconds);
            ui.label(RichText::new(text).size(16.0).color(style::ACCENT));
        });
    });
}

/// Describes what happens to a sculpture in `seconds` seconds.
fn handover_text(session: SessionState, strokes: UndoCounts, seconds: u32) -> String {
    let happens = match session {
        SessionState::Sculpting if strokes.undoable > 0 => "your sculpture is finished and kept",
        SessionState::Finished => "the next visitor's turn comes",
        _ => "the start is shown",
    };
    format!("Touch anything. In {seconds} s {happens}.")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_told_before_a_handover_is_what_happens() {
        let told =
            |session, undoable| handover_text(session, UndoCounts { undoable, redoable: 0 }, 9);
        assert_eq!(
            [
                told(SessionState::Sculpting, 1),
                told(SessionState::Sculpting, 0),
                told(SessionState::Finished, 1)
            ],
            [
                "Touch anything. In 9 s your sculpture is finished and kept.",
                "Touch anything. In 9 s the start is shown.",
                "Touch anything. In 9 s the next visitor's turn comes."
            ]
        );
    }
}
