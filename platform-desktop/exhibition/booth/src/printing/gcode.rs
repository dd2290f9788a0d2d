//! Reads PrusaSlicer's estimate from the comments of its G-code. Files from other programs are safe: little
//! is read, and all numbers are checked.

use std::fs::File;
use std::io::{self, Read as _, Seek as _, SeekFrom};
use std::path::Path;

/// The bytes that are read at the file's end: the estimate stands before the settings, which take some 20 KB.
const END_BYTES: u64 = 256 << 10;

/// The longest print time that is accepted.
const MAX_MINUTES: u64 = 100 * 24 * 60;

/// The time and the material that a print takes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Estimate {
    pub(crate) minutes: u32,
    pub(crate) tenths_gram: u32,
}

/// Reads the estimate of a G-code file. Returns `None` if the file has none.
///
/// # Errors
/// An I/O error.
pub(crate) fn read_estimate(path: &Path) -> io::Result<Option<Estimate>> {
    let mut file = File::open(path)?;
    let length = file.metadata()?.len();
    file.seek(SeekFrom::Start(length.saturating_sub(END_BYTES)))?;
    let mut end = Vec::new();
    file.take(END_BYTES).read_to_end(&mut end)?;
    Ok(parse_estimate(&String::from_utf8_lossy(&end)))
}

/// Parses the estimate in the last part of a G-code file.
pub(crate) fn parse_estimate(text: &str) -> Option<Estimate> {
    let value = |name: &str| {
        let mut lines = text.lines().rev();
        lines.find_map(|line| line.strip_prefix(name)?.strip_prefix(" = "))
    };
    let seconds = parse_seconds(value("; estimated printing time (normal mode)")?)?;
    let grams: f64 = value("; total filament used [g]")?.trim().parse().ok()?;
    let minutes = seconds.div_ceil(60);
    if minutes == 0 || minutes > MAX_MINUTES || !(0.0..=1e6).contains(&grams) {
        return None;
    }
    Some(Estimate { minutes: minutes as u32, tenths_gram: (10.0 * grams).ceil() as u32 })
}

/// Parses a time such as `1d 2h 3m 4s` into seconds.
fn parse_seconds(text: &str) -> Option<u64> {
    let mut seconds = 0u64;
    for part in text.split_whitespace() {
        let unit = match part.chars().next_back()? {
            'd' => 86_400,
            'h' => 3600,
            'm' => 60,
            's' => 1,
            _ => return None,
        };
        let count: u64 = part[..part.len() - 1].parse().ok()?;
        seconds = seconds.checked_add(count.checked_mul(unit)?)?;
    }
    Some(seconds)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::{Estimate, parse_estimate, parse_seconds};

    proptest! {
        #[test]
        fn any_text_is_read(words in "[0-9dhmsώ .]*", rest in ".*") {
            let name = "; estimated printing time (normal mode) = ";
            let text = format!("{name}{words}\n; total filament used [g] = {words}\n{rest}");
            let _ = (parse_estimate(&text), parse_seconds(&words), parse_seconds(&rest));
        }
    }

    #[test]
    fn times_are_read() {
        for (text, seconds) in
            [("1h 11m 13s", Some(4273)), ("2d 0h 0m 1s", Some(172_801)), ("45s", Some(45))]
        {
            assert_eq!(parse_seconds(text), seconds);
        }
        for text in ["1x", "h", "-1s", "1.5h", "99999999999999999999s", "213503982334601d 9d", "ώ"]
        {
            assert_eq!(parse_seconds(text), None, "{text}");
        }
    }

    #[test]
    fn the_last_words_count_and_nonsense_is_nothing() {
        let text = "G1 X0\n; estimated printing time (normal mode) = 9s\n\
                    ; total filament used [g] = 29.41\n; estimated printing time (normal mode) = 1h 0m 1s\n; a = b\n";
        assert_eq!(parse_estimate(text), Some(Estimate { minutes: 61, tenths_gram: 295 }));
        for grams in ["NaN", "inf", "-1", "1e9", "", "x"] {
            assert_eq!(parse_estimate(&text.replace("29.41", grams)), None, "{grams}");
        }
        assert_eq!(parse_estimate(&text.replace("1h 0m 1s", "4000000h")), None);
        assert_eq!(parse_estimate(""), None);
    }
}
