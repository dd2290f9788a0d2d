//! Noto Sans, regular and bold: advances, kerning and outlines.

use ttf_parser::gpos::{PairAdjustment, PositioningSubtable};
use ttf_parser::{Face, GlyphId, OutlineBuilder, Tag};

use super::table::{FontMeasure, FontWeight};
use crate::atlas::distance::Contours;

/// Straight pieces of a curve: the error of a glyph's outline is a hundredth of a texel.
const CURVE_PIECES: u32 = 8;

/// The font in both weights.
pub(crate) struct Font {
    faces: [Face<'static>; 2],
}

impl Font {
    pub(crate) fn new() -> Self {
        let parse = |bytes| Face::parse(bytes, 0).expect("the font's file");
        Font { faces: [parse(ttf_noto_sans::REGULAR), parse(ttf_noto_sans::BOLD)] }
    }

    const fn face(&self, weight: FontWeight) -> &Face<'static> {
        &self.faces[weight as usize]
    }

    fn glyph(&self, weight: FontWeight, character: char) -> Option<GlyphId> {
        self.face(weight).glyph_index(character)
    }

    /// Returns the heights of a capital letter in a unit of the font.
    fn capitals_per_unit(&self, weight: FontWeight) -> f32 {
        1.0 / f32::from(self.face(weight).capital_height().expect("a height of capitals"))
    }

    /// Returns the advance of the pen, in heights of a capital letter.
    pub(crate) fn advance(&self, weight: FontWeight, character: char) -> f32 {
        let glyph = self.glyph(weight, character);
        let units = glyph.and_then(|glyph| self.face(weight).glyph_hor_advance(glyph));
        f32::from(units.unwrap_or(0)) * self.capitals_per_unit(weight)
    }

    /// Returns the kerning between two characters, added to the advance, in heights of a capital letter.
    pub(crate) fn kerning(&self, weight: FontWeight, pair: [char; 2]) -> f32 {
        let [Some(first), Some(second)] = pair.map(|c| self.glyph(weight, c)) else { return 0.0 };
        f32::from(kerning_units(self.face(weight), first, second)) * self.capitals_per_unit(weight)
    }

    /// Returns a glyph's outline, y down, in heights of a capital letter from the pen.
    pub(crate) fn outline(&self, weight: FontWeight, character: char) -> Contours {
        let scale = self.capitals_per_unit(weight);
        let mut pen = OutlinePen { contours: Vec::new(), scale };
        if let Some(glyph) = self.glyph(weight, character) {
            let _ = self.face(weight).outline_glyph(glyph, &mut pen);
        }
        Contours(pen.contours)
    }
}

impl FontMeasure for Font {
    fn has_glyph(&self, weight: FontWeight, character: char) -> bool {
        self.glyph(weight, character).is_some()
    }

    fn line_width(&self, weight: FontWeight, line: &str) -> f32 {
        let advances: f32 = line.chars().map(|c| self.advance(weight, c)).sum();
        let pairs = line.chars().zip(line.chars().skip(1));
        advances + pairs.map(|(a, b)| self.kerning(weight, [a, b])).sum::<f32>()
    }
}

/// Returns the pair adjustment of GPOS's feature `kern`.
fn kerning_units(face: &Face<'_>, first: GlyphId, second: GlyphId) -> i16 {
    let Some(table) = face.tables().gpos else { return 0 };
    let kern = table.features.into_iter().find(|f| f.tag == Tag::from_bytes(b"kern"));
    let lookups = kern.into_iter().flat_map(|feature| feature.lookup_indices);
    let mut units = 0;
    for lookup in lookups.filter_map(|index| table.lookups.get(index)) {
        let pairs = lookup.subtables.into_iter::<PositioningSubtable<'_>>();
        let adjusted = pairs.filter_map(|subtable| match subtable {
            PositioningSubtable::Pair(pair) => adjust_pair(&pair, first, second),
            _ => None,
        });
        units += adjusted.take(1).sum::<i16>();
    }
    units
}

/// Returns the first glyph's change of advance, if the subtable has the pair.
fn adjust_pair(pair: &PairAdjustment<'_>, first: GlyphId, second: GlyphId) -> Option<i16> {
    let covered = pair.coverage().get(first)?;
    let (value, _) = match pair {
        PairAdjustment::Format1 { sets, .. } => sets.get(covered)?.get(second)?,
        PairAdjustment::Format2 { classes, matrix, .. } => {
            matrix.get((classes.0.get(first), classes.1.get(second)))?
        }
    };
    Some(value.x_advance)
}

/// A pen that converts an outline to straight lines.
struct OutlinePen {
    contours: Vec<Vec<[f32; 2]>>,
    scale: f32,
}

impl OutlinePen {
    fn push(&mut self, x: f32, y: f32) {
        let point = [x * self.scale, -y * self.scale];
        self.contours.last_mut().expect("an outline begins with a move").push(point);
    }

    /// Returns the pen's position, in units of the font.
    fn last(&self) -> [f32; 2] {
        let [x, y] = *self.contours.last().and_then(|line| line.last()).expect("a point");
        [x / self.scale, -y / self.scale]
    }
}

impl OutlineBuilder for OutlinePen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.contours.push(Vec::new());
        self.push(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.push(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let [x0, y0] = self.last();
        for i in 1..=CURVE_PIECES {
            let t = i as f32 / CURVE_PIECES as f32;
            let mix = |a: f32, b: f32, c: f32| {
                (1.0 - t) * (1.0 - t) * a + 2.0 * t * (1.0 - t) * b + t * t * c
            };
            self.push(mix(x0, x1, x), mix(y0, y1, y));
        }
    }

    fn curve_to(&mut self, _: f32, _: f32, _: f32, _: f32, _: f32, _: f32) {
        unreachable!("a TrueType font has no cubic curves");
    }

    fn close(&mut self) {}
}
