//! The names of the ways to start a session, as command lines and scripts have them.

use std::fmt;

use paros_core::session::SessionMode;

use crate::figures::{Figure, HiddenStart, MAX_OWN_FIGURES, own_figure_mode};

/// A name of no mode that sessions can be started in by name.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct UnknownMode;

/// The modes that have names, each with its own: `free`, `creative`, and the figures that hide in the
/// stone, alone or with `-half` or `-whole` of it. A start of the visitor's own has none.
pub fn named_modes() -> impl Iterator<Item = (&'static str, SessionMode)> {
    let constrained = HiddenStart::ALL.map(|hidden| (hidden.name(), hidden.mode()));
    [("free", SessionMode::FreeForm), ("creative", SessionMode::Creative)]
        .into_iter()
        .chain(constrained)
}

/// The mode of a name.
///
/// # Errors
/// It has none; the error says which have.
pub fn parse_mode(name: &str) -> Result<SessionMode, UnknownMode> {
    let found = named_modes().find(|(named, _)| *named == name);
    found.map(|(_, mode)| mode).ok_or(UnknownMode)
}

/// The mode of a name, of [`named_modes`] or of one of the operator's own hidden figures, in their order.
///
/// # Errors
/// It has none.
pub fn parse_mode_among(name: &str, own_figures: &[String]) -> Result<SessionMode, UnknownMode> {
    let own = own_figures.iter().take(MAX_OWN_FIGURES).position(|figure| figure == name);
    own.map_or_else(|| parse_mode(name), |number| Ok(own_figure_mode(number)))
}

impl fmt::Display for UnknownMode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let hidden = Figure::HIDDEN.map(Figure::name).join(", ");
        write!(f, "expected free, creative or one of {hidden}, each also with -half or -whole")
    }
}

impl std::error::Error for UnknownMode {}

#[cfg(test)]
mod tests {
    use super::{SessionMode, UnknownMode, named_modes, parse_mode};

    #[test]
    fn names_are_parsed_to_their_modes() {
        for (name, mode) in named_modes() {
            assert_eq!(parse_mode(name), Ok(mode), "{name}");
        }
        assert_eq!(parse_mode("cat-whole"), Ok(SessionMode::Constrained { figure: 1 }));
        assert_eq!(parse_mode("cat"), Ok(SessionMode::Constrained { figure: 9 }));
        assert_eq!(parse_mode("Free"), Err(UnknownMode));
        let told = UnknownMode.to_string();
        let expected = "expected free, creative or one of owl, cat, amphora, dolphin, each also with -half or -whole";
        assert_eq!(told, expected);
    }
}
