//! Line breaking: as many words on a line as fit. The build wraps by this code too, so that texts that it
//! accepts fit.

/// The lines of a text, broken at spaces: each as long as fits a width. A wider word has a line of its own.
#[derive(Clone, Debug)]
pub(crate) struct WrappedLines<'a, F> {
    rest: &'a str,
    width: f32,
    measure: F,
}

impl<'a, F: Fn(&str) -> f32> WrappedLines<'a, F> {
    /// Creates the lines of a text, for a width in the unit of `measure`, which returns a line's width.
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

/// Returns the narrowest width, in steps, at which a text has no more lines than at `width`, so that no
/// word is left alone on a line.
pub(crate) fn even_width(text: &str, width: f32, measure: impl Fn(&str) -> f32) -> f32 {
    const STEP: f32 = 0.04;
    let lines = |room| WrappedLines::new(text, room, &measure);
    let (count, mut even) = (lines(width).count(), width);
    for step in 1..(0.5 / STEP) as u32 {
        let narrow = width * (1.0 - step as f32 * STEP);
        if count < 2 || lines(narrow).count() > count || lines(narrow).any(|l| measure(l) > narrow)
        {
            break;
        }
        even = narrow;
    }
    even
}

#[cfg(test)]
mod tests {
    use super::{WrappedLines, even_width};

    /// Returns the lines of a text whose letters are one wide.
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

    #[test]
    fn lines_are_about_as_long() {
        let measure = |line: &str| line.chars().count() as f32;
        let text = "walk round your sculpture and then take it off";
        assert_eq!(even_width(text, 100.0, measure), 100.0, "one line stays as it is");
        let width = even_width(text, 42.0, measure);
        let lines: Vec<&str> = WrappedLines::new(text, width, measure).collect();
        assert_eq!(lines, ["walk round your sculpture", "and then take it off"]);
    }
}
