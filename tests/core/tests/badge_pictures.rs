//! Checks that no two pictograms, rims or colours look alike, and draws them all to `target/tmp/badges.png`.

use std::fs::File;
use std::path::Path;

use paros_core::badge::{
    BadgeColour, BadgeNumber, BadgePart, Language, POINT_STEPS, Pictogram, covers_point,
};
use paros_models::badge_pictures::{
    KINDS_OF_SIGHT, colour_difference, is_inked, to_linear, transform,
};
use paros_models::random_visitor::RandomSource;

/// Side of a rasterised pictogram in pixels, as for a badge at arm's length.
const SIDE: usize = 48;

/// The least share of pixels in which two pictograms differ, at every offset of up to two pixels.
const DIFFERING_SHARE: f64 = 0.10;

/// Rasterises a pictogram row by row, sampling the centre of each pixel.
fn rasterise(parts: &[BadgePart], side: usize) -> Vec<bool> {
    let steps = 64 * POINT_STEPS as usize;
    let middle = |i: usize| ((2 * i + 1) * steps / (2 * side)) as i32;
    (0..side * side).map(|i| covers_point(parts, [i % side, i / side].map(middle))).collect()
}

/// Returns the share of pixels in which `a` differs from `b` moved by an offset in pixels.
fn differing_share(a: &[bool], b: &[bool], [dx, dy]: [i32; 2]) -> f64 {
    let side = SIDE as i32;
    let pixel = |x: i32, y: i32| {
        (0..side).contains(&x) && (0..side).contains(&y) && b[(y * side + x) as usize]
    };
    let differing = (0..side * side).filter(|i| {
        let (x, y) = (i % side, i / side);
        a[*i as usize] != pixel(x - dx, y - dy)
    });
    differing.count() as f64 / f64::from(side * side)
}

#[test]
fn no_two_pictograms_look_alike() {
    let pictures: Vec<_> = Pictogram::all().map(|p| (p, rasterise(p.parts(), SIDE))).collect();
    let mut least = (1.0, "", "");
    for (i, (a, of_a)) in pictures.iter().enumerate() {
        for (b, of_b) in &pictures[..i] {
            let moves = (-2..=2).flat_map(|x| (-2..=2).map(move |y| [x, y]));
            let share = moves.map(|by| differing_share(of_a, of_b, by)).fold(1.0, f64::min);
            let names = [a, b].map(|p| p.name(Language::English));
            assert!(share >= DIFFERING_SHARE, "{names:?} differ in {share:.3}");
            if share < least.0 {
                least = (share, names[0], names[1]);
            }
        }
    }
    println!("the most alike: {least:?}");
}

#[test]
fn every_pictogram_has_ink_and_ground_and_keeps_within_its_square() {
    for pictogram in Pictogram::all() {
        let name = pictogram.name(Language::English);
        let inked = rasterise(pictogram.parts(), SIDE).iter().filter(|inked| **inked).count();
        let share = inked as f64 / (SIDE * SIDE) as f64;
        assert!((0.1..0.75).contains(&share), "{name}: {share:.2} is ink");
        // No ink lies more than a 64th of the side outside the square.
        let end = 64 * POINT_STEPS;
        for at in -end..2 * end {
            for outside in [-POINT_STEPS * 5 / 4, end + POINT_STEPS * 5 / 4] {
                assert!(!covers_point(pictogram.parts(), [at, outside]), "{name} at {at}");
                assert!(!covers_point(pictogram.parts(), [outside, at]), "{name} at {at}");
            }
        }
    }
}

#[test]
fn points_are_inked_as_the_model_says() {
    let mut dice = RandomSource::new(2);
    let parts = Pictogram::all().map(Pictogram::parts);
    for parts in parts.chain(BadgeColour::ALL.map(BadgeColour::rim)) {
        for _ in 0..2000 {
            let point = [0; 2].map(|_| dice.below(66 * 16) as i32 - 16);
            let expected = is_inked(parts, point.map(|i| f64::from(i) / f64::from(POINT_STEPS)));
            if let Some(expected) = expected {
                assert_eq!(covers_point(parts, point), expected, "{parts:?} at {point:?}");
            }
        }
        // Points far away aren't covered, and nothing overflows.
        for far in [i32::MIN, -100_000, 100_000, i32::MAX] {
            assert!(![[far, 500], [500, far], [far, far]].iter().any(|p| covers_point(parts, *p)));
        }
    }
}

#[test]
fn colours_are_told_apart_by_every_eye_and_rims_without_any() {
    let mut least = f64::INFINITY;
    for (sight, matrix) in KINDS_OF_SIGHT {
        for (i, a) in BadgeColour::ALL.iter().enumerate() {
            let seen = |colour: [u8; 3]| transform(&matrix, to_linear(colour));
            for b in &BadgeColour::ALL[..i] {
                let difference = colour_difference(seen(a.ground()), seen(b.ground()));
                println!("{sight}: {a:?}, {b:?}: {difference:.0}");
                least = least.min(difference);
                assert!(difference >= 18.0, "{sight}: {a:?}, {b:?}: {difference:.0}");
            }
            // Minimum contrast as for small text (WCAG 2.2, 1.4.3).
            let luminance =
                |c: [u8; 3]| transform(&[[0.2126, 0.7152, 0.0722]; 3], to_linear(c))[0] + 0.05;
            let (ground, ink) = (luminance(a.ground()), luminance(a.ink()));
            assert!(ground.max(ink) / ground.min(ink) >= 4.5, "{a:?}");
        }
    }
    println!("the most alike colours: {least:.0}");
    let strip = |colour: BadgeColour| -> Vec<_> { rasterise(colour.rim(), 64)[..64 * 6].to_vec() };
    for (i, a) in BadgeColour::ALL.iter().enumerate() {
        for b in &BadgeColour::ALL[..i] {
            let (a_pixels, b_pixels) = (strip(*a), strip(*b));
            let differing = a_pixels.iter().zip(&b_pixels).filter(|(a, b)| a != b).count();
            assert!(differing * 100 >= 15 * a_pixels.len(), "{a:?}, {b:?}: {differing} pixels");
        }
    }
}

/// An RGB image.
struct Sheet {
    width: usize,
    pixels: Vec<[u8; 3]>,
}

impl Sheet {
    fn new(width: usize, height: usize) -> Self {
        Sheet { width, pixels: vec![[128; 3]; width * height] }
    }

    /// Draws parts in a square with its corner at `x`, `y`, rotated by `turns` quarter turns.
    fn draw(&mut self, parts: &[BadgePart], [x, y, side]: [usize; 3], turns: usize, ink: [u8; 3]) {
        let inked = rasterise(parts, side);
        for (i, _) in inked.iter().enumerate().filter(|(_, inked)| **inked) {
            let (mut u, mut v) = (i % side, i / side);
            (0..turns).for_each(|_| (u, v) = (side - 1 - v, u));
            self.pixels[(y + v) * self.width + x + u] = ink;
        }
    }

    fn fill(&mut self, [x, y, width, height]: [usize; 4], colour: [u8; 3]) {
        for row in y..y + height {
            self.pixels[row * self.width + x..][..width].fill(colour);
        }
    }

    fn write(&self, path: &Path) {
        let file = File::create(path).expect("a file for the picture");
        let height = self.pixels.len() / self.width;
        let mut encoder = png::Encoder::new(file, self.width as u32, height as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        let mut writer = encoder.write_header().expect("a header");
        writer.write_image_data(self.pixels.as_flattened()).expect("pixels");
    }
}

/// Draws all pictograms, eight in a row, and a badge of each colour, four in a row.
#[test]
fn a_sheet_shows_them_all() {
    const CELL: usize = 96;
    let mut sheet = Sheet::new(8 * CELL, 8 * CELL + 2 * 192);
    for pictogram in Pictogram::all() {
        let (column, row) = (pictogram.number() % 8, pictogram.number() / 8);
        sheet.fill([column * CELL + 2, row * CELL + 2, CELL - 4, CELL - 4], [255; 3]);
        let place = [column * CELL + 8, row * CELL + 8, CELL - 16];
        sheet.draw(pictogram.parts(), place, 0, [0; 3]);
    }
    for colour in BadgeColour::ALL {
        let number = BadgeNumber::new((colour as u32) << 18 | 777).expect("a number");
        let (x, y) = (colour as usize % 4 * 192, 8 * CELL + colour as usize / 4 * 192);
        sheet.fill([x + 8, y + 8, 176, 176], colour.ground());
        (0..4)
            .for_each(|turns| sheet.draw(colour.rim(), [x + 12, y + 12, 168], turns, colour.ink()));
        for (k, pictogram) in number.badge().pictograms.iter().enumerate() {
            let place = [x + 34 + k % 2 * 64, y + 34 + k / 2 * 64, 56];
            sheet.draw(pictogram.parts(), place, 0, colour.ink());
        }
    }
    sheet.write(&Path::new(env!("CARGO_TARGET_TMPDIR")).join("badges.png"));
    assert!(sheet.pixels.contains(&[0; 3]));
}
