//! The names of session modes on command lines and in scripts.

use std::fmt;

use paros_core::session::SessionMode;

use crate::figures::{Figure, HiddenStart, MAX_OWN_FIGURES, own_figure_mode};

/// An error: no mode that a session can be started in has this name.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct UnknownMode;

/// Returns the modes that have names: `free`, `creative`, and the hidden figures, alone or with `-half` or
/// `-whole` for thicker stone. The visitor's own start volume has no name.
pub fn named_modes() -> impl Iterator<Item = (&'static str, SessionMode)> {
    let constrained = HiddenStart::ALL.map(|hidden| (hidden.name(), hidden.mode()));
    [("free", SessionMode::FreeForm), ("creative", SessionMode::Creative)]
        .into_iter()
        .chain(constrained)
}

/// Returns the mode with a name.
///
/// # Errors
/// Returns an error if there is no such mode. Its text lists the names.
pub fn parse_mode(name: &str) -> Result<SessionMode, UnknownMode> {
    let found = named_modes().find(|(named, _)| *named == name);
    found.map(|(_, mode)| mode).ok_or(UnknownMode)
}

/// Returns the mode with a name, from [`named_modes`] or from the operator's own hidden figures, whose names
/// are given in their order.
///
/// # Errors
/// Returns an error if there is no such mode.
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
