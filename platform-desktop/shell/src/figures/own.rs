//! The operator's own hidden figures, which a headset's package brings beside those that there are always.

use paros_core::session::SessionMode;

use super::HiddenStart;
use crate::modes::parse_mode;

/// The most figures of the operator's own: twice as many as there are without, and 12 MiB of maps at 256.
pub const MAX_OWN_FIGURES: usize = 8;

/// The most bytes of a figure's name.
const MAX_NAME_BYTES: usize = 32;

/// The mode that starts with the figure at a place among the operator's own.
#[must_use]
pub const fn own_figure_mode(place: usize) -> SessionMode {
    debug_assert!(place < MAX_OWN_FIGURES);
    SessionMode::Constrained { figure: (HiddenStart::ALL.len() + place) as u8 }
}

/// Checks the names of the operator's own figures: how many there are, and whether each is a name that no other mode
/// has, of small letters, digits and hyphens.
///
/// # Errors
/// A text: the name, and what was expected.
pub fn check_own_figure_names(names: &[String]) -> Result<(), String> {
    if names.len() > MAX_OWN_FIGURES {
        return Err(format!("{} figures, expected at most {MAX_OWN_FIGURES}", names.len()));
    }
    for (place, name) in names.iter().enumerate() {
        let is_name_byte = |c: u8| c.is_ascii_lowercase() || c.is_ascii_digit() || c == b'-';
        let shown = name.escape_debug();
        if name.is_empty() || name.len() > MAX_NAME_BYTES || !name.bytes().all(is_name_byte) {
            return Err(format!(
                "{shown}: no name of a figure, expected 1 to {MAX_NAME_BYTES} small letters, digits and hyphens"
            ));
        }
        if parse_mode(name).is_ok() || name == "own" || names[..place].contains(name) {
            return Err(format!("{shown}: there is one of this name already, expected another"));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::{MAX_OWN_FIGURES, check_own_figure_names, own_figure_mode};
    use crate::figures::HiddenStart;
    use crate::modes::parse_mode_among;

    #[test]
    fn own_figures_follow_the_others_by_their_numbers() {
        let own = ["lion", "hand-2"].map(String::from);
        assert_eq!(check_own_figure_names(&own), Ok(()));
        assert_eq!(parse_mode_among("hand-2", &own), Ok(own_figure_mode(1)));
        assert_eq!(parse_mode_among("owl", &own), parse_mode_among("owl", &[]));
        for place in 0..MAX_OWN_FIGURES {
            let mode = own_figure_mode(place);
            assert!(HiddenStart::ALL.into_iter().all(|start| start.mode() != mode));
        }
    }

    #[test]
    fn a_name_that_another_has_or_none_could_have_is_refused() {
        for (names, why) in [
            (&["owl"][..], "owl: there is one"),
            (&["lion", "lion"], "lion: there is one"),
            (&["cat-half"], "cat-half: there is one"),
            (&["own"], "own: there is one"),
            (&["Lion"], "Lion: no name"),
            (&["a/b"], "a/b: no name"),
            (&[""], ": no name"),
            (&["a\nb"], "a\\nb: no name"),
            (&["a"; 9], "9 figures, expected at most 8"),
        ] {
            let names: Vec<_> = names.iter().map(ToString::to_string).collect();
            let told = check_own_figure_names(&names).expect_err(why);
            assert!(told.starts_with(why), "{told}");
        }
        let long = [str::repeat("a", 33)];
        assert!(check_own_figure_names(&long).is_err());
    }
}
