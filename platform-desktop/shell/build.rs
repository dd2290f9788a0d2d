//! Draws the letters of a headset's notices: as pixels they take a tenth of the font's bytes, and no code that reads fonts.

use std::env;
use std::fmt::Write;
use std::fs;
use std::path::PathBuf;

use ab_glyph::{Font, FontRef, PxScale, ScaleFont, point};

/// Name, height in pixels and letters of each sheet. Titles have few words.
const SHEETS: [(&str, f32, &str); 2] = [
    ("TITLE", 64.0, "Paros can't start The last start failed"),
    (
        "TEXT",
        36.0,
        " !\"#$%&'()*+,-./0123456789:;<=>?@ABCDEFGHIJKLMNOPQRSTUVWXYZ[\\]^_`abcdefghijklmnopqrstuvwxyz{|}~",
    ),
];

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let folder = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets it"));
    let font = FontRef::try_from_slice(epaint_default_fonts::UBUNTU_LIGHT).expect("a font");
    let (mut source, mut shares) = (String::new(), Vec::new());
    for (name, size, letters) in SHEETS {
        let mut letters: Vec<char> = letters.chars().collect();
        letters.sort_unstable();
        letters.dedup();
        let ascent = font.as_scaled(PxScale::from(size)).ascent();
        writeln!(
            source,
            "static {name}: Sheet = Sheet {{ size: {size:?}, ascent: {ascent:?}, letters: &["
        )
        .expect("room");
        for letter in letters {
            writeln!(source, "    {},", draw_letter(&font, size, letter, &mut shares))
                .expect("room");
        }
        writeln!(source, "] }};").expect("room");
    }
    fs::write(folder.join("letters.rs"), source).expect("the folder is cargo's");
    fs::write(folder.join("letters.bin"), shares).expect("the folder is cargo's");
}

/// Draws a letter: appends each pixel's share of ink, 0 to 255. Returns its `Letter`.
fn draw_letter(font: &FontRef<'_>, size: f32, letter: char, shares: &mut Vec<u8>) -> String {
    let id = font.glyph_id(letter);
    let (advance, start) = (font.as_scaled(PxScale::from(size)).h_advance(id), shares.len());
    let outline = font.outline_glyph(id.with_scale_and_position(size, point(0.0, 0.0)));
    let ([mut left, mut top], [mut width, mut height]) = ([0; 2], [0; 2]);
    if let Some(outline) = outline {
        let bounds = outline.px_bounds();
        [left, top] = [bounds.min.x as i32, bounds.min.y as i32];
        [width, height] = [bounds.width() as usize, bounds.height() as usize];
        shares.resize(start + width * height, 0);
        outline.draw(|x, y, share| {
            let at = start + y as usize * width + x as usize;
            shares[at] = (share.clamp(0.0, 1.0) * 255.0).round() as u8;
        });
    }
    format!(
        "Letter {{ letter: {letter:?}, advance: {advance:?}, left: {left}, top: {top}, width: {width}, \
         height: {height}, start: {start} }}"
    )
}
