//! The picture of a [`StartNotice`]: a panel that the CPU draws, as there are no shader programs yet.

use crate::start_up::{RING_STEPS, StartNotice};
use glam::Vec2;
use paros_shaders::panel::{FontWeight, LINE_HEIGHT, Panel, PanelColor, TextAlign, TextStyle};
use paros_shaders::render_panel_flat;

/// The picture's width and height in pixels.
pub const EXTENT: [u32; 2] = [1024, 512];

/// The picture's resolution in pixels per metre: the picture is as wide as a large screen at arm's length.
pub const PIXELS_PER_METRE: f32 = 900.0;

/// The picture's width and height in millimetres.
const SIZE_MM: [f32; 2] =
    [EXTENT[0] as f32 / PIXELS_PER_METRE * 1e3, EXTENT[1] as f32 / PIXELS_PER_METRE * 1e3];
const MARGIN_MM: f32 = 62.0;

/// The background, dark as the studio's floor at night: a bright picture in a dark headset blinds.
const GROUND: [u8; 3] = [34, 38, 44];
const INK: PanelColor = [226, 222, 214, 255];
/// The colours of the ring's finished part, and of the whole ring.
const DONE: PanelColor = [232, 180, 110, 255];
const RING: PanelColor = [66, 72, 82, 255];

const TITLE: TextStyle =
    TextStyle { weight: FontWeight::Bold, capital_mm: 48.0, color: INK, align: TextAlign::Left };
const TEXT: TextStyle = TextStyle { weight: FontWeight::Regular, capital_mm: 27.0, ..TITLE };

/// The maximum number of lines of a cause, and the letters after which a word is broken, so that the widest
/// letters fit a line.
const CAUSE_LINES: usize = 6;
const WORD_LETTERS: usize = 24;

/// Draws a notice. Returns opaque sRGB pixels, as red, green, blue and alpha, row by row from the top left.
#[must_use]
pub fn draw_notice(notice: &StartNotice) -> Vec<u8> {
    let mut page = Page { panel: Panel::new(SIZE_MM), y: MARGIN_MM };
    match notice {
        StartNotice::Loading { step } => {
            page.write(&TITLE, "Paros");
            page.write(&TEXT, "The studio is being made ready");
            let (middle, size) = (Vec2::new(0.5 * SIZE_MM[0], 367.0), [103.0, 20.0]);
            page.panel.add_ring(middle, size, 1.0, RING);
            page.panel.add_ring(middle, size, (step + 1) as f32 / RING_STEPS as f32, DONE);
        }
        StartNotice::Failed { cause, seconds } => {
            page.write(&TITLE, "Paros can't start");
            page.write(&TEXT, &fit_cause(cause));
            page.y = SIZE_MM[1] - MARGIN_MM - TEXT.capital_mm;
            page.write(&TEXT, &format!("Ends in {seconds} s. The log tells more: paros.log"));
        }
        StartNotice::Waiting { seconds } => {
            page.write(&TITLE, "The last start failed");
            page.write(&TEXT, &format!("Starting again in {seconds} s"));
            page.write(&TEXT, "The log tells why: paros.log");
        }
    }
    let image = render_panel_flat(&page.panel, GROUND, EXTENT.map(|side| side as usize));
    image.pixels.chunks_exact(3).flat_map(|rgb| [rgb[0], rgb[1], rgb[2], 255]).collect()
}

/// A panel whose text is added from the top down.
struct Page {
    panel: Panel,
    /// The upper edge of the next line's capitals, in millimetres.
    y: f32,
}

impl Page {
    /// Writes a text, in several lines if necessary.
    fn write(&mut self, style: &TextStyle, text: &str) {
        let lines = add_text(&mut self.panel, style, text, self.y);
        self.y += (lines as f32 * LINE_HEIGHT + 0.5) * style.capital_mm;
    }
}

/// Adds a text below the height `y`. Returns its number of lines.
fn add_text(panel: &mut Panel, style: &TextStyle, text: &str, y: f32) -> usize {
    let foot = Vec2::new(MARGIN_MM, y + style.capital_mm);
    panel.add_paragraph(text, foot, SIZE_MM[0] - 2.0 * MARGIN_MM, style)
}

/// Breaks words that are longer than a line, and cuts off the text that doesn't fit; the log has all of it.
fn fit_cause(cause: &str) -> String {
    let mut fitting: String = cause.split_whitespace().flat_map(break_word).take(400).collect();
    while add_text(&mut Panel::default(), &TEXT, &fitting, 0.0) > CAUSE_LINES {
        fitting.truncate(fitting.rfind(' ').unwrap_or(0));
    }
    fitting
}

/// Returns a word's letters, with a space before the word and after every [`WORD_LETTERS`] letters.
fn break_word(word: &str) -> impl Iterator<Item = char> {
    let letters = word.chars().enumerate();
    letters
        .flat_map(|(i, letter)| (i % WORD_LETTERS == 0).then_some(' ').into_iter().chain([letter]))
}

#[cfg(test)]
mod tests {
    use super::{
        EXTENT, GROUND, MARGIN_MM, PIXELS_PER_METRE, RING_STEPS, StartNotice, draw_notice,
    };

    const WIDTH: usize = EXTENT[0] as usize;
    const HEIGHT: usize = EXTENT[1] as usize;

    /// Returns the top and bottom rows and the left and right columns of the drawn area.
    fn drawn_box(pixels: &[u8]) -> [usize; 4] {
        let [mut top, mut bottom, mut left, mut right] = [HEIGHT, 0, WIDTH, 0];
        for (i, pixel) in pixels.chunks_exact(4).enumerate() {
            if pixel[..3] != GROUND {
                let (x, y) = (i % WIDTH, i / WIDTH);
                [top, bottom] = [top.min(y), bottom.max(y)];
                [left, right] = [left.min(x), right.max(x)];
            }
        }
        [top, bottom, left, right]
    }

    fn failed(cause: &str) -> Vec<u8> {
        draw_notice(&StartNotice::Failed { cause: cause.into(), seconds: 9 })
    }

    #[test]
    fn every_notice_stays_within_its_margins() {
        let words = "the device is lost; ".repeat(60);
        let notices = [
            draw_notice(&StartNotice::Loading { step: 3 }),
            draw_notice(&StartNotice::Waiting { seconds: 60 }),
            failed(&words),
            failed(&"x".repeat(3000)),
            failed(&"W".repeat(3000)),
            failed("\u{4e2d}\u{1f600} \u{0} no letters of this font"),
        ];
        for pixels in notices {
            assert_eq!(pixels.len(), WIDTH * HEIGHT * 4);
            assert!(pixels.chunks_exact(4).all(|pixel| pixel[3] == 255));
            let [top, bottom, left, right] = drawn_box(&pixels);
            let margin = (MARGIN_MM * 1e-3 * PIXELS_PER_METRE) as usize - 8;
            assert!(top >= margin && bottom < HEIGHT - margin, "rows {top} to {bottom}");
            assert!(left >= margin && right < WIDTH - margin, "columns {left} to {right}");
            assert!(right - left > WIDTH / 3 && bottom - top > HEIGHT / 4);
        }
    }

    #[test]
    fn a_cause_and_the_seconds_are_seen() {
        let cause = "no OpenXR runtime answers";
        assert_ne!(failed(cause), failed("the headset's device draws no Vulkan"));
        let later = StartNotice::Failed { cause: cause.into(), seconds: 8 };
        assert_ne!(failed(cause), draw_notice(&later));
        let waiting = |seconds| draw_notice(&StartNotice::Waiting { seconds });
        assert_ne!(waiting(8), waiting(7));
    }

    #[test]
    fn the_ring_grows_by_every_step() {
        let steps: Vec<_> =
            (0..RING_STEPS).map(|step| draw_notice(&StartNotice::Loading { step })).collect();
        for (i, pixels) in steps.iter().enumerate() {
            assert!(steps[..i].iter().all(|before| before != pixels), "step {i}");
        }
    }
}
