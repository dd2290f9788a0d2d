//! Line breaking: as many words on a line as fit. The build wraps by this too, so that what it has checked fits.

/// The lines of a text, broken at spaces: each as long as fits a width. A word that is wider has a line of its own.
#[derive(Clone, Debug)]
pub(crate) struct WrappedLines<'a, F> {
    rest: &'a str,
    width: f32,
    measure: F,
}

impl<'a, F: Fn(&str) -> f32> WrappedLines<'a, F> {
    /// Of a text, for a width in the unit of `measure`, which gives a line's width.
    pub(crate) const fn new(text: &'a str, width: f32, measure: F) -> Self {
        WrappedLines { rest: text, width, measure }
    }
}

impl<'a, F: Fn(&str) -> f32> Iterator for WrappedLines<'a, F> {
    type Item = &'a str;

    fn next(&mut self) -> Option<&'a str> {
        let text = self.rest.trim_start_matches(' ');
        if text.is_empty() {
            return None;
        }
        let ends = text.match_indices(' ').map(|(at, _)| at).chain([text.len()]);
        let mut line = "";
        for end in ends {
            let longer = &text[..end];
            if !line.is_empty() && (self.measure)(longer) > self.width {
                break;
            }
            line = longer;
        }
        self.rest = &text[line.len()..];
        Some(line.trim_end_matches(' '))
    }
}

#[cfg(test)]
mod tests {
    use super::WrappedLines;

    /// Lines of a text whose letters are one wide.
    fn wrapped(text: &str, width: f32) -> Vec<&str> {
        WrappedLines::new(text, width, |line: &str| line.chars().count() as f32).collect()
    }

    #[test]
    fn lines_are_as_long_as_fits() {
        assert_eq!(wrapped("one two three", 7.0), ["one two", "three"]);
        assert_eq!(wrapped("one two three", 6.9), ["one", "two", "three"]);
        assert_eq!(wrapped("one two three", 13.0), ["one two three"]);
    }

    #[test]
    fn a_long_word_has_a_line_of_its_own() {
        assert_eq!(wrapped("a cauliflower is", 5.0), ["a", "cauliflower", "is"]);
        assert_eq!(wrapped("  πέτρα   και ", 5.0), ["πέτρα", "και"]);
        assert_eq!(wrapped("   ", 5.0), [""; 0]);
    }
}
