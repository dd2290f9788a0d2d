//! The picture of a [`StartNotice`]: text and a ring, drawn by the processor, as there are no programs yet.

use super::start_up::{RING_STEPS, StartNotice};

/// Pixels across and down.
pub const EXTENT: [u32; 2] = [1024, 512];

/// Pixels of a metre where it hangs: the picture is as wide as a large screen at arm's length.
pub const PIXELS_PER_METRE: f32 = 900.0;

const WIDTH: usize = EXTENT[0] as usize;
const HEIGHT: usize = EXTENT[1] as usize;

/// The darkness of the studio's floor at night; dark, as a bright picture on black blinds.
const GROUND: [u8; 3] = [34, 38, 44];
const INK: [u8; 3] = [226, 222, 214];
/// The ring's stretch that turns, and the rest of it.
const TURNING: [u8; 3] = [232, 180, 110];
const RESTING: [u8; 3] = [66, 72, 82];

const MARGIN: f32 = 56.0;

/// Letters of one size, drawn when this is built.
struct Sheet {
    /// Pixels.
    size: f32,
    /// Pixels from a line's upper edge down to its base.
    ascent: f32,
    /// In their order.
    letters: &'static [Letter],
}

/// A letter's pixels.
struct Letter {
    letter: char,
    /// Pixels to the next letter's place.
    advance: f32,
    /// Pixels from its place on the base to the upper left corner of its box.
    left: i32,
    top: i32,
    width: usize,
    height: usize,
    /// Where its box stands in [`SHARES`], row by row.
    start: usize,
}

/// Each pixel's share of ink, 0 to 255.
static SHARES: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/letters.bin"));

include!(concat!(env!("OUT_DIR"), "/letters.rs"));

impl Sheet {
    /// A letter, or a question mark for one that isn't there.
    fn find(&self, letter: char) -> Option<&'static Letter> {
        let place =
            |letter: char| self.letters.binary_search_by_key(&letter, |found| found.letter).ok();
        place(letter).or_else(|| place('?')).map(|place| &self.letters[place])
    }

    fn advance(&self, letter: char) -> f32 {
        self.find(letter).map_or(0.0, |letter| letter.advance)
    }
}

/// The ring's middle, its radius and half its thickness, in pixels.
const RING: [f32; 4] = [512.0, 330.0, 84.0, 9.0];

/// The picture's red, green, blue and alpha, row by row from the top left: sRGB, and all of it opaque.
#[must_use]
pub fn draw_notice(notice: &StartNotice) -> Vec<u8> {
    let [red, green, blue] = GROUND;
    let mut pixels = [red, green, blue, 255].repeat(WIDTH * HEIGHT);
    let mut page = Page { pixels: &mut pixels, y: MARGIN };
    match notice {
        StartNotice::Loading { step } => {
            page.write(&TITLE, "Paros");
            page.write(&TEXT, "The studio is being made ready");
            page.draw_ring(*step);
        }
        StartNotice::Failed { cause, seconds } => {
            page.write(&TITLE, "Paros can't start");
            let end = format!("Ends in {seconds} s. The log tells more: paros.log");
            page.write_within(&TEXT, cause, HEIGHT as f32 - MARGIN - 1.5 * TEXT.size);
            page.y = HEIGHT as f32 - MARGIN - TEXT.size;
            page.write(&TEXT, &end);
        }
        StartNotice::Waiting { seconds } => {
            page.write(&TITLE, "The last start failed");
            page.write(&TEXT, &format!("Starting again in {seconds} s"));
            page.write(&TEXT, "The log tells why: paros.log");
        }
    }
    pixels
}

/// A picture that is written from the top.
struct Page<'a> {
    pixels: &'a mut [u8],
    /// The upper edge of the next line.
    y: f32,
}

impl Page<'_> {
    /// Writes a text in as many lines as it takes.
    fn write(&mut self, sheet: &Sheet, text: &str) {
        self.write_within(sheet, text, HEIGHT as f32);
    }

    /// Writes a text in as many lines as it takes, down to `bottom`. What has no room is left out: the log has it.
    fn write_within(&mut self, sheet: &Sheet, text: &str, bottom: f32) {
        for line in break_lines(sheet, text) {
            if self.y + sheet.size > bottom {
                return;
            }
            self.draw_line(sheet, &line);
            self.y += 1.3 * sheet.size;
        }
        self.y += 0.4 * sheet.size;
    }

    fn draw_line(&mut self, sheet: &Sheet, line: &str) {
        let (mut x, base) = (MARGIN, self.y + sheet.ascent);
        for letter in line.chars().filter_map(|letter| sheet.find(letter)) {
            let [left, top] = [(libm::roundf(x), letter.left), (libm::roundf(base), letter.top)]
                .map(|(place, offset)| place + offset as f32);
            x += letter.advance;
            let shares = &SHARES[letter.start..][..letter.width * letter.height];
            for (i, share) in shares.iter().enumerate() {
                let (across, down) = (i % letter.width, i / letter.width);
                let at = [left + across as f32, top + down as f32];
                self.blend(at, INK, f32::from(*share) / 255.0);
            }
        }
    }

    fn draw_ring(&mut self, step: u32) {
        let [middle_x, middle_y, radius, half] = RING;
        let reach = (radius + half + 1.0) as i32;
        for down in -reach..=reach {
            for across in -reach..=reach {
                let (x, y) = (across as f32, down as f32);
                let share = (half + 0.5 - (libm::hypotf(x, y) - radius).abs()).clamp(0.0, 1.0);
                // Clockwise from the top, in turns.
                let turn = libm::atan2f(x, -y) / core::f32::consts::TAU;
                let since = (turn - step as f32 / RING_STEPS as f32).rem_euclid(1.0);
                let color = if since < 0.25 { TURNING } else { RESTING };
                self.blend([middle_x + x, middle_y + y], color, share);
            }
        }
    }

    /// Lays a colour over a pixel, for a share of it. Beyond the edge there is none.
    fn blend(&mut self, [x, y]: [f32; 2], color: [u8; 3], share: f32) {
        if x < 0.0 || y < 0.0 || x >= WIDTH as f32 || y >= HEIGHT as f32 {
            return;
        }
        let at = (y as usize * WIDTH + x as usize) * 4;
        for (under, over) in self.pixels[at..at + 3].iter_mut().zip(color) {
            let mixed = f32::from(*under) + (f32::from(over) - f32::from(*under)) * share.min(1.0);
            *under = libm::roundf(mixed) as u8;
        }
    }
}

/// Breaks a text between its words, and a word that is longer than a line where it must be.
fn break_lines(sheet: &Sheet, text: &str) -> Vec<String> {
    let width = |text: &str| text.chars().map(|letter| sheet.advance(letter)).sum::<f32>();
    let room = WIDTH as f32 - 2.0 * MARGIN;
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let line = lines.last_mut().expect("at least one");
        if !line.is_empty() && width(line) + sheet.advance(' ') + width(word) > room {
            lines.push(String::new());
        } else if !line.is_empty() {
            line.push(' ');
        }
        for letter in word.chars() {
            let line = lines.last_mut().expect("at least one");
            if width(line) + sheet.advance(letter) > room {
                lines.push(letter.into());
            } else {
                line.push(letter);
            }
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::{GROUND, HEIGHT, MARGIN, RING_STEPS, StartNotice, TEXT, TITLE, WIDTH, draw_notice};

    /// The rows, top and bottom, and the columns, left and right, in which something is drawn.
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
            failed("\u{4e2d}\u{1f600} \u{0} no letters of this font"),
        ];
        for pixels in notices {
            assert_eq!(pixels.len(), WIDTH * HEIGHT * 4);
            assert!(pixels.chunks_exact(4).all(|pixel| pixel[3] == 255));
            let [top, bottom, left, right] = drawn_box(&pixels);
            let margin = MARGIN as usize - 8;
            assert!(top >= margin && bottom < HEIGHT - margin, "rows {top} to {bottom}");
            assert!(left >= margin && right < WIDTH - margin, "columns {left} to {right}");
            assert!(right - left > WIDTH / 3 && bottom - top > HEIGHT / 4);
        }
    }

    #[test]
    fn every_letter_is_there() {
        for (sheet, words) in [(&TITLE, "Paros can't start The last start failed"), (&TEXT, "?~ !")]
        {
            for letter in words.chars() {
                assert_eq!(sheet.find(letter).map(|found| found.letter), Some(letter));
            }
        }
        assert_eq!(TEXT.find('\u{4e2d}').map(|found| found.letter), Some('?'));
        assert_eq!(TEXT.letters.len(), 95);
    }

    #[test]
    fn a_cause_and_the_seconds_are_seen() {
        let one = failed("no OpenXR runtime answers");
        assert_ne!(one, failed("the headset's device draws no Vulkan"));
        assert_ne!(
            one,
            draw_notice(&StartNotice::Failed {
                cause: "no OpenXR runtime answers".into(),
                seconds: 8
            })
        );
        assert_ne!(
            draw_notice(&StartNotice::Waiting { seconds: 8 }),
            draw_notice(&StartNotice::Waiting { seconds: 7 })
        );
    }

    #[test]
    fn the_ring_turns_by_every_step() {
        let steps: Vec<_> =
            (0..RING_STEPS).map(|step| draw_notice(&StartNotice::Loading { step })).collect();
        for (i, pixels) in steps.iter().enumerate() {
            assert!(steps[..i].iter().all(|before| before != pixels), "step {i}");
        }
    }
}
