//! The tables as Rust source: texts, glyphs, and the place of each thing in the atlas.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use super::font::Font;
use super::table::{self, FontMeasure, FontWeight, TextTable};
use crate::atlas::icons::{IconShape, all_icons};
use crate::atlas::{self, AtlasCell, GlyphCell, PackedAtlas};
use crate::constants::PANEL_CAPITAL_TEXELS;

const WEIGHTS: [FontWeight; 2] = [FontWeight::Regular, FontWeight::Bold];

/// A variant's name, and its doc comment.
type Variant = (String, String);

/// Converts a key to a variant's name: `time-left` becomes `TimeLeft`.
fn variant_name(key: &str) -> String {
    let word = |word: &str| word[..1].to_uppercase() + &word[1..];
    key.split('-').map(word).collect()
}

/// Returns the source of an enum without values, with the list of all variants.
fn enum_source(name: &str, about: &str, variants: &[Variant]) -> String {
    let all: Vec<String> = variants.iter().map(|(one, _)| format!("{name}::{one}")).collect();
    let lines = variants.iter().map(|(one, about)| format!("    /// {about}\n    {one},\n"));
    let lines: String = lines.collect();
    format!(
        "/// {about}\n#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]\n#[repr(u8)]\npub enum {name} \
         {{\n{lines}}}\n\nimpl {name} {{\n    /// All of them.\n    pub const ALL: [{name}; {}] = [{}];\n}}\n",
        all.len(),
        all.join(", ")
    )
}

/// Returns the source of the enums `TextPlace` and `Message`, and of their tables.
pub(super) fn messages_source(table: &TextTable) -> String {
    let (mut places, mut styles) = (Vec::new(), String::new());
    for place in &table.places {
        let table::Place { name, weight, capital_mm, width_mm, lines } = place;
        let about = format!("Capitals of {capital_mm} mm, {lines} x {width_mm} mm.");
        places.push((variant_name(name), about));
        write!(
            styles,
            "PlaceStyle {{ weight: FontWeight::{weight:?}, capital_mm: {capital_mm:?}, width_mm: \
             {width_mm:?}, lines: {lines} }}, "
        )
        .expect("strings take text");
    }
    let (mut messages, mut rows) = (Vec::new(), String::new());
    for message in &table.messages {
        let table::MessageRow { key, texts, fillings, place } = message;
        messages.push((variant_name(key), format!("\"{}\"", texts[0].replace(['[', ']'], ""))));
        let place = &places[*place].0;
        writeln!(
            rows,
            "    MessageRow {{ texts: {texts:?}, place: TextPlace::{place}, fillings: &{fillings:?} }},"
        )
        .expect("strings take text");
    }
    let enums = enum_source("TextPlace", "Size and room of a text.", &places)
        + &enum_source("Message", "A text of the panels.", &messages);
    let (styles_count, rows_count) = (places.len(), messages.len());
    format!(
        "{enums}\nstatic STYLES: [PlaceStyle; {styles_count}] = [{styles}];\nstatic ROWS: [MessageRow; \
         {rows_count}] = [\n{rows}];\n"
    )
}

/// A character of a weight, and the index and corner of its cell, if it has ink.
struct PlacedGlyph {
    character: char,
    cell: Option<(usize, [i32; 2])>,
}

/// Returns the atlas, and the source of the tables of its cells' places.
pub(super) fn atlas_source(font: &Font, lines: &[String]) -> (PackedAtlas, String) {
    let characters: BTreeSet<char> = lines.iter().flat_map(|line| line.chars()).collect();
    let mut cells: Vec<AtlasCell> = Vec::new();
    let glyphs = WEIGHTS.map(|weight| add_glyphs(font, weight, &characters, &mut cells));
    let icons = all_icons();
    let mut add = |more: Vec<AtlasCell>| {
        let first = cells.len();
        cells.extend(more);
        first..cells.len()
    };
    let ranges = [
        ("PICTOGRAMS", add(atlas::pictogram_cells().collect())),
        ("RIMS", add(atlas::rim_cells().collect())),
        ("ICONS", add(icons.iter().map(|icon| AtlasCell::of_picture(&icon.parts)).collect())),
    ];
    let packed = atlas::pack_cells(&cells);
    let size = packed.size;
    let mut source =
        format!("/// Texels across and down.\npub const ATLAS_SIZE: [u32; 2] = {size:?};\n");
    for (name, range) in ranges {
        let corners = &packed.corners[range];
        let count = corners.len();
        source += &format!("static {name}: [[u16; 2]; {count}] = {corners:?};\n");
    }
    for ((weight, glyphs), name) in WEIGHTS.into_iter().zip(&glyphs).zip(["REGULAR", "BOLD"]) {
        let rows: String =
            glyphs.iter().map(|glyph| glyph_row(font, weight, glyph, &packed, &cells)).collect();
        source += &format!("static {name}_GLYPHS: [Glyph; {}] = [\n{rows}];\n", glyphs.len());
        let kerns = kerned_pairs(font, weight, lines);
        source +=
            &format!("static {name}_KERNS: [([char; 2], f32); {}] = {kerns:?};\n", kerns.len());
    }
    let variant = |icon: &IconShape| (icon.name.to_owned(), icon.shows.to_owned());
    let variants: Vec<Variant> = icons.iter().map(variant).collect();
    (packed, source + &enum_source("Icon", "An icon of the panels.", &variants))
}

/// Adds the cells of a weight's glyphs. Returns the characters that the font has, with their cells.
fn add_glyphs(
    font: &Font,
    weight: FontWeight,
    characters: &BTreeSet<char>,
    cells: &mut Vec<AtlasCell>,
) -> Vec<PlacedGlyph> {
    let known = characters.iter().filter(|&&c| font.has_glyph(weight, c));
    let placed = known.map(|&character| {
        let cell = GlyphCell::new(&font.outline(weight, character)).map(|glyph| {
            cells.push(glyph.cell);
            (cells.len() - 1, glyph.corner)
        });
        PlacedGlyph { character, cell }
    });
    placed.collect()
}

fn glyph_row(
    font: &Font,
    weight: FontWeight,
    glyph: &PlacedGlyph,
    packed: &PackedAtlas,
    cells: &[AtlasCell],
) -> String {
    let PlacedGlyph { character, cell } = glyph;
    let advance = font.advance(weight, *character);
    let (at, size, corner) = cell.map_or(([0; 2], [0; 2], [0; 2]), |(cell, corner)| {
        (packed.corners[cell], cells[cell].size, corner)
    });
    format!(
        "    Glyph {{ character: {character:?}, advance: {advance:?}, at: {at:?}, size: {size:?}, corner: \
         {corner:?} }},\n"
    )
}

/// Returns the kerned pairs of characters in lines, sorted: those whose distance the font changes by more
/// than a twentieth of a texel. Kerning is in heights of a capital letter.
fn kerned_pairs(font: &Font, weight: FontWeight, lines: &[String]) -> Vec<([char; 2], f32)> {
    let pairs = lines.iter().flat_map(|line| line.chars().zip(line.chars().skip(1)));
    let pairs: BTreeSet<[char; 2]> = pairs.map(|(a, b)| [a, b]).collect();
    let kerned = pairs.into_iter().map(|pair| (pair, font.kerning(weight, pair)));
    kerned.filter(|(_, kerning)| kerning.abs() * PANEL_CAPITAL_TEXELS > 0.05).collect()
}
