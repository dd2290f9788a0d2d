//! The size of a picture on a command line.

/// The longest side of a picture in pixels.
const LONGEST: usize = 8192;

/// Parses `WxH`: width and height in pixels, each from 1 to 8192.
///
/// # Errors
/// Returns a text that says what was expected.
pub fn parse_width_x_height(text: &str) -> Result<[usize; 2], String> {
    let side = |text: &str| text.parse().ok().filter(|side| (1..=LONGEST).contains(side));
    text.split_once('x')
        .and_then(|(width, height)| Some([side(width)?, side(height)?]))
        .ok_or_else(|| format!("expected WxH, each 1 to {LONGEST}"))
}
