//! The panels' atlas: signed distance fields of glyphs, pictograms, rims and icons, in one greyscale
//! picture.

pub(crate) mod distance;
pub(crate) mod icons;

use std::collections::BTreeMap;

use paros_core::badge::{BadgeColour, BadgePart, Pictogram};

use crate::constants::{
    PANEL_CAPITAL_TEXELS, PANEL_PICTURE_TEXELS, PANEL_REACH_TEXELS, PANEL_RIM_TEXELS,
};
use distance::{Contours, distance_to_parts};

/// Texels in a row.
const WIDTH: usize = 512;

/// Texels around a shape that hold distances to it.
const MARGIN: usize = PANEL_REACH_TEXELS as usize;

/// A signed distance field.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct AtlasCell {
    pub(crate) size: [usize; 2],
    texels: Vec<u8>,
}

/// A glyph's field, and the offset of its upper left corner from the pen, in texels.
pub(crate) struct GlyphCell {
    pub(crate) cell: AtlasCell,
    pub(crate) corner: [i32; 2],
}

/// All cells in one picture.
pub(crate) struct PackedAtlas {
    pub(crate) size: [usize; 2],
    pub(crate) texels: Vec<u8>,
    /// The upper left corner of each cell.
    pub(crate) corners: Vec<[usize; 2]>,
}

impl AtlasCell {
    /// Creates a cell from a function that returns the distance at a texel's middle, in texels, positive
    /// inside.
    fn new([width, height]: [usize; 2], distance: impl Fn([f32; 2]) -> f32) -> Self {
        let texel = |i: usize| {
            let at = [(i % width) as f32 + 0.5, (i / width) as f32 + 0.5];
            let part = 0.5 + 0.5 * distance(at) / PANEL_REACH_TEXELS;
            // In 64 steps of a sixteenth of a texel, which compress better.
            let step = (part.clamp(0.0, 1.0) * 63.0 + 0.5) as u8;
            step << 2 | step >> 4
        };
        AtlasCell { size: [width, height], texels: (0..width * height).map(texel).collect() }
    }

    /// Creates a cell of parts in the upper left of the unit square; `size` is in 64ths of the square's
    /// side.
    fn of_parts(parts: &[BadgePart], size: [usize; 2], texels_a_side: usize) -> Self {
        let scale = texels_a_side as f32 / 64.0;
        let cells = size.map(|units| (units as f32 * scale) as usize + 2 * MARGIN);
        AtlasCell::new(cells, |at| {
            let unit = at.map(|c| (c - MARGIN as f32) / scale);
            distance_to_parts(parts, unit) * scale
        })
    }

    pub(crate) fn of_picture(parts: &[BadgePart]) -> Self {
        Self::of_parts(parts, [64, 64], PANEL_PICTURE_TEXELS as usize)
    }

    fn of_rim(parts: &[BadgePart]) -> Self {
        Self::of_parts(parts, [64, 8], PANEL_RIM_TEXELS as usize)
    }
}

impl GlyphCell {
    /// Creates the cell of an outline in heights of a capital letter; `None` without ink.
    pub(crate) fn new(outline: &Contours) -> Option<Self> {
        let [low, high] = outline.bounds()?.map(|point| point.map(|c| c * PANEL_CAPITAL_TEXELS));
        let margin = MARGIN as i32;
        let corner = low.map(|c| c.floor() as i32 - margin);
        let size = [0, 1].map(|k| (high[k].ceil() as i32 + margin - corner[k]) as usize);
        let cell = AtlasCell::new(size, |at| {
            let capital = [0, 1].map(|k| (at[k] + corner[k] as f32) / PANEL_CAPITAL_TEXELS);
            outline.signed_distance(capital) * PANEL_CAPITAL_TEXELS
        });
        Some(GlyphCell { cell, corner })
    }
}

/// Returns the cells of all pictograms, by number.
pub(crate) fn pictogram_cells() -> impl Iterator<Item = AtlasCell> {
    Pictogram::all().map(|pictogram| AtlasCell::of_picture(pictogram.parts()))
}

/// Returns the cells of the colours' rims, by number.
pub(crate) fn rim_cells() -> impl Iterator<Item = AtlasCell> {
    BadgeColour::ALL.into_iter().map(|colour| AtlasCell::of_rim(colour.rim()))
}

/// Packs cells in rows, the highest first. Identical cells, such as those of Latin and Greek capitals,
/// share a place.
pub(crate) fn pack_cells(cells: &[AtlasCell]) -> PackedAtlas {
    let mut order: Vec<usize> = (0..cells.len()).collect();
    // Stable, so that the picture is the same on every machine.
    order.sort_by_key(|&i| std::cmp::Reverse(cells[i].size[1]));
    let mut corners = vec![[0; 2]; cells.len()];
    let (mut x, mut y, mut row_height) = (0, 0, 0);
    let mut placed = BTreeMap::new();
    for i in order {
        let [width, height] = cells[i].size;
        if let Some(&corner) = placed.get(&cells[i]) {
            corners[i] = corner;
            continue;
        }
        if x + width > WIDTH {
            (x, y, row_height) = (0, y + row_height, 0);
        }
        row_height = row_height.max(height);
        corners[i] = [x, y];
        placed.insert(&cells[i], corners[i]);
        x += width;
    }
    let size = [WIDTH, (y + row_height).next_multiple_of(4)];
    let mut texels = vec![0; size[0] * size[1]];
    for (cell, [x, y]) in cells.iter().zip(&corners) {
        for (row, line) in cell.texels.chunks_exact(cell.size[0]).enumerate() {
            let at = (y + row) * WIDTH + x;
            texels[at..at + line.len()].copy_from_slice(line);
        }
    }
    PackedAtlas { size, texels, corners }
}

/// Compresses the atlas's texels, row by row, to a zlib stream.
pub(crate) fn compress_texels(atlas: &PackedAtlas) -> Vec<u8> {
    const BEST: u8 = 10;
    miniz_oxide::deflate::compress_to_vec_zlib(&atlas.texels, BEST)
}
