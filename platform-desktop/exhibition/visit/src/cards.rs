//! The cards of the ways to start a session.

use paros_core::session::SessionMode;
use paros_shaders::panel::{Icon, Message};
use paros_shell::modes::named_modes;

/// Returns the name of a way to start.
#[must_use]
pub fn name_of_start(start: SessionMode) -> Message {
    card_of_start(start).0
}

/// Returns the card of a way to start: its text and its icon.
pub(crate) fn card_of_start(start: SessionMode) -> (Message, Icon) {
    match start {
        SessionMode::None | SessionMode::FreeForm => (Message::ChoiceFree, Icon::Stone),
        SessionMode::Creative => (Message::ChoiceShape, Icon::Shape),
        SessionMode::Own => (Message::FigureOwn, Icon::Figure),
        SessionMode::Constrained { .. } => {
            let name = named_modes().find(|(_, mode)| *mode == start).map(|(name, _)| name);
            match name.and_then(|name| name.split('-').next()) {
                Some("owl") => (Message::FigureOwl, Icon::Owl),
                Some("cat") => (Message::FigureCat, Icon::Cat),
                Some("dolphin") => (Message::FigureDolphin, Icon::Dolphin),
                Some("amphora") => (Message::FigureAmphora, Icon::Amphora),
                // A figure of the operator.
                _ => (Message::FigureSurprise, Icon::Surprise),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use paros_core::session::SessionMode;
    use paros_shaders::panel::Message;
    use paros_shell::modes::named_modes;

    use super::card_of_start;

    #[test]
    fn every_named_start_has_a_card_of_its_own() {
        for (name, mode) in named_modes() {
            let (message, _) = card_of_start(mode);
            let is_surprise = matches!(message, Message::FigureSurprise | Message::FigureOwn);
            assert!(!is_surprise, "{name}");
        }
        let own = SessionMode::Constrained { figure: 250 };
        assert_eq!(card_of_start(own).0, Message::FigureSurprise);
    }
}
