//! A panel: its contents, as a list of quads, and its pose.

use core::fmt::Write as _;

use glam::{Vec2, Vec3};
use paros_core::badge::{Badge, Pictogram};

use super::font::{AtlasPicture, FontWeight, Icon, glyph_of, kerning_of, line_width};
use super::message::{Filling, Language, Message, PlaceStyle};
use super::pose::{PanelPoint, PanelPose, PanelRect};
use super::quad::PanelQuad;
use super::wrap::{WrappedLines, even_width};
use crate::constants::{
    PANEL_BOX, PANEL_CAPITAL_TEXELS, PANEL_IMAGE, PANEL_REACH_TEXELS, PANEL_RING, PANEL_SHAPE,
};
use crate::limits::PANEL_QUADS;

/// Line spacing: the distance between the baselines of two lines, in heights of a capital letter.
pub const LINE_HEIGHT: f32 = 1.9;

/// Texels trimmed from the margin around a shape in the atlas, so that nothing of the next cell is drawn.
const TRIM_TEXELS: f32 = 0.5;

/// sRGB with straight alpha.
pub type PanelColor = [u8; 4];

/// Alignment of a line at its point.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum TextAlign {
    /// The line begins at the point.
    #[default]
    Left,
    /// The line's middle is at the point.
    Middle,
    /// The line ends at the point.
    Right,
}

/// A text's look.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct TextStyle {
    /// The font's weight.
    pub weight: FontWeight,
    /// Height of a capital letter, in millimetres.
    pub capital_mm: f32,
    /// Colour of the letters.
    pub color: PanelColor,
    /// Alignment.
    pub align: TextAlign,
}

/// A rounded box's look.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
pub struct BoxStyle {
    /// Radius of the corners, in millimetres.
    pub radius_mm: f32,
    /// Colour of the inside.
    pub fill: PanelColor,
    /// Colour of the outline.
    pub outline: PanelColor,
    /// Width of the outline, within the box, in millimetres; 0 for none.
    pub outline_mm: f32,
    /// Width over which the edge fades, as a shadow's does, in millimetres.
    pub softness_mm: f32,
}

/// A panel. A shell keeps it, and lays it out again when something changes. This allocates nothing as long
/// as the new contents are no larger than earlier ones.
#[derive(Clone, PartialEq, Default, Debug)]
pub struct Panel {
    /// Pose in the room.
    pub pose: PanelPose,
    size_mm: [f32; 2],
    quads: Vec<PanelQuad>,
    least_capital_mm: Option<f32>,
    /// Buffer in which placeholders are filled in.
    filled: String,
}

impl PlaceStyle {
    /// Returns the look of the place's texts, in a colour and an alignment.
    #[must_use]
    pub const fn colored(self, color: PanelColor, align: TextAlign) -> TextStyle {
        TextStyle { weight: self.weight, capital_mm: self.capital_mm, color, align }
    }
}

impl Panel {
    /// Creates an empty panel of this size, in millimetres.
    #[must_use]
    pub fn new(size_mm: [f32; 2]) -> Self {
        Panel { size_mm, ..Panel::default() }
    }

    /// Empties the panel, and sets its size.
    pub fn clear(&mut self, size_mm: [f32; 2]) {
        self.quads.clear();
        self.size_mm = size_mm;
        self.least_capital_mm = None;
    }

    /// Returns the panel's width and height, in millimetres.
    #[must_use]
    pub const fn size_mm(&self) -> [f32; 2] {
        self.size_mm
    }

    /// Returns the quads that the panel is drawn of, from the back to the front.
    #[must_use]
    pub fn quads(&self) -> &[PanelQuad] {
        &self.quads
    }

    /// Returns the rectangle of the whole panel.
    #[must_use]
    pub const fn rect(&self) -> PanelRect {
        PanelRect::new(0.0, 0.0, self.size_mm[0], self.size_mm[1])
    }

    /// Returns the angle, in degrees, that a capital letter of the smallest text has at a distance; `None`
    /// without text. Text below one degree can't be read on a headset.
    #[must_use]
    pub fn least_text_degrees(&self, distance_m: f32) -> Option<f32> {
        self.least_capital_mm.map(|mm| (mm * 1e-3).atan2(distance_m).to_degrees())
    }

    /// Returns the point where a ray meets the panel's front, as [`PanelPose::intersect_ray`].
    #[must_use]
    pub fn intersect_ray(&self, origin: Vec3, direction: Vec3) -> Option<PanelPoint> {
        self.pose.intersect_ray(self.size_mm, origin, direction)
    }

    /// Projects a point of the room onto the panel, as [`PanelPose::project_point`].
    #[must_use]
    pub fn project_point(&self, point: Vec3) -> PanelPoint {
        self.pose.project_point(self.size_mm, point)
    }

    /// Adds a quad, or drops it if the panel already has as many as a frame draws.
    fn push(&mut self, quad: PanelQuad) {
        if self.quads.len() < PANEL_QUADS {
            self.quads.push(quad);
        }
    }

    /// Adds a rounded box.
    pub fn add_box(&mut self, rect: PanelRect, style: &BoxStyle) {
        let half = [0.5 * rect.width, 0.5 * rect.height];
        let radius = style.radius_mm.min(half[0]).min(half[1]);
        self.push(PanelQuad {
            middle: rect.middle().to_array(),
            half,
            shape: [radius, style.outline_mm, style.softness_mm, 0.0],
            fill: style.fill,
            outline: if style.outline_mm > 0.0 { style.outline } else { style.fill },
            kind: PANEL_BOX,
        });
    }

    /// Adds a line of text. `foot` lies on the baseline.
    pub fn add_line(&mut self, text: &str, foot: Vec2, style: &TextStyle) {
        let width = style.capital_mm * line_width(text, style.weight);
        let mut pen = match style.align {
            TextAlign::Left => foot.x,
            TextAlign::Middle => foot.x - 0.5 * width,
            TextAlign::Right => foot.x - width,
        };
        let least = self.least_capital_mm.unwrap_or(style.capital_mm);
        self.least_capital_mm = Some(least.min(style.capital_mm));
        let mm_per_texel = style.capital_mm / PANEL_CAPITAL_TEXELS;
        let mut last = None;
        for character in text.chars() {
            if let Some(last) = last {
                pen += style.capital_mm * kerning_of(style.weight, [last, character]);
            }
            last = Some(character);
            let glyph = glyph_of(style.weight, character);
            if glyph.size[0] > 0 {
                let size = glyph.size.map(f32::from);
                let middle = |k: usize| f32::from(glyph.corner[k]) + 0.5 * size[k];
                let texel = |k: usize| f32::from(glyph.at[k]) + 0.5 * size[k];
                self.push(PanelQuad {
                    middle: [pen + middle(0) * mm_per_texel, foot.y + middle(1) * mm_per_texel],
                    half: size.map(|size| (0.5 * size - TRIM_TEXELS) * mm_per_texel),
                    shape: [texel(0), texel(1), 1.0 / mm_per_texel, 0.0],
                    fill: style.color,
                    outline: style.color,
                    kind: PANEL_SHAPE,
                });
            }
            pen += style.capital_mm * glyph.advance;
        }
    }

    /// Adds a text in lines of at most `width_mm`, about equally long; `foot` lies on the first baseline.
    /// Returns the number of lines.
    pub fn add_paragraph(
        &mut self,
        text: &str,
        foot: Vec2,
        width_mm: f32,
        style: &TextStyle,
    ) -> usize {
        let measure = |line: &str| style.capital_mm * line_width(line, style.weight);
        let width_mm = even_width(text, width_mm, measure);
        let mut lines = 0;
        for line in WrappedLines::new(text, width_mm, measure) {
            let down = lines as f32 * LINE_HEIGHT * style.capital_mm;
            self.add_line(line, foot + Vec2::Y * down, style);
            lines += 1;
        }
        lines
    }

    /// Adds a text like [`Panel::add_paragraph`], with its lines vertically centred at `at`.
    pub fn add_paragraph_around(
        &mut self,
        text: &str,
        at: Vec2,
        width_mm: f32,
        style: &TextStyle,
    ) -> usize {
        let measure = |line: &str| style.capital_mm * line_width(line, style.weight);
        let more = WrappedLines::new(text, width_mm, measure).count().saturating_sub(1);
        let foot = 0.5 * style.capital_mm * (1.0 - more as f32 * LINE_HEIGHT);
        self.add_paragraph(text, at + Vec2::Y * foot, width_mm, style)
    }

    /// Adds a message with its placeholders filled in, in its place's size and width. Returns the number of
    /// lines.
    pub fn add_message(
        &mut self,
        message: Message,
        (language, fillings): (Language, &[Filling<'_>]),
        foot: Vec2,
        (color, align): (PanelColor, TextAlign),
    ) -> usize {
        let place = message.place().style();
        let style = place.colored(color, align);
        let mut filled = core::mem::take(&mut self.filled);
        filled.clear();
        // Writing to a string can't fail.
        let _ = message.write_filled(&mut filled, language, fillings);
        let lines = self.add_paragraph(&filled, foot, place.width_mm, &style);
        self.filled = filled;
        lines
    }

    /// Adds a line of formatted text.
    pub fn add_written_line(
        &mut self,
        text: core::fmt::Arguments<'_>,
        foot: Vec2,
        style: &TextStyle,
    ) {
        let mut filled = core::mem::take(&mut self.filled);
        filled.clear();
        let _ = filled.write_fmt(text);
        self.add_line(&filled, foot, style);
        self.filled = filled;
    }

    /// Adds an icon, as large as fits a rectangle.
    pub fn add_icon(&mut self, icon: Icon, rect: PanelRect, color: PanelColor) {
        self.add_picture(&AtlasPicture::of_icon(icon), rect, 0, color);
    }

    /// Adds a badge's pictogram, as large as fits a rectangle.
    pub fn add_pictogram(&mut self, pictogram: Pictogram, rect: PanelRect, color: PanelColor) {
        self.add_picture(&AtlasPicture::of_pictogram(pictogram), rect, 0, color);
    }

    /// Adds the picture of a cell, as large as fits a rectangle, with rounded corners. It is invisible
    /// until the cell has a picture.
    pub fn add_image(&mut self, cell: u8, rect: PanelRect, radius_mm: f32) {
        let half = 0.5 * rect.width.min(rect.height);
        self.push(PanelQuad {
            middle: rect.middle().to_array(),
            half: [half; 2],
            shape: [radius_mm.min(half), 0.0, 0.0, f32::from(cell)],
            fill: [255; 4],
            outline: [255; 4],
            kind: PANEL_IMAGE,
        });
    }

    /// Adds a picture in the middle of a rectangle, after quarter turns clockwise.
    fn add_picture(
        &mut self,
        picture: &AtlasPicture,
        rect: PanelRect,
        quarter_turns: u8,
        color: PanelColor,
    ) {
        let [width, height] = match quarter_turns % 2 {
            0 => picture.size,
            _ => [picture.size[1], picture.size[0]],
        };
        let mm_per_texel = (rect.width / width).min(rect.height / height);
        let (along, across) = match quarter_turns % 4 {
            0 => (1.0, 0.0),
            1 => (0.0, -1.0),
            2 => (-1.0, 0.0),
            _ => (0.0, 1.0),
        };
        let [u, v] = picture.middle;
        self.push(PanelQuad {
            middle: rect.middle().to_array(),
            half: [width, height]
                .map(|size| (0.5 * size + PANEL_REACH_TEXELS - TRIM_TEXELS) * mm_per_texel),
            shape: [u, v, along / mm_per_texel, across / mm_per_texel],
            fill: color,
            outline: color,
            kind: PANEL_SHAPE,
        });
    }

    /// Adds a ring around a point, or an arc of it: the `part`, 0 to 1, clockwise from its top. A part of 0
    /// adds nothing.
    pub fn add_ring(
        &mut self,
        middle: Vec2,
        [radius_mm, width_mm]: [f32; 2],
        part: f32,
        color: PanelColor,
    ) {
        if part > 0.0 {
            self.push(PanelQuad {
                middle: middle.to_array(),
                half: [radius_mm; 2],
                shape: [width_mm, part.min(1.0), 0.0, 0.0],
                fill: color,
                outline: color,
                kind: PANEL_RING,
            });
        }
    }

    /// Adds a progress bar, filled from its left to `part`, 0 to 1.
    pub fn add_progress_bar(&mut self, rect: PanelRect, part: f32, colors: [PanelColor; 2]) {
        let [track, bar] = colors;
        let radius_mm = 0.5 * rect.height;
        self.add_box(rect, &BoxStyle { radius_mm, fill: track, ..BoxStyle::default() });
        let part = part.clamp(0.0, 1.0);
        if part > 0.0 {
            let width = rect.height + (rect.width - rect.height) * part;
            let done = PanelRect { width, ..rect };
            self.add_box(done, &BoxStyle { radius_mm, fill: bar, ..BoxStyle::default() });
        }
    }

    /// Adds a badge in a square: its pictograms in two rows on its colour, its rim around them.
    pub fn add_badge(&mut self, badge: &Badge, square: PanelRect) {
        let opaque = |[r, g, b]: [u8; 3]| [r, g, b, 255];
        let (ground, ink) = (opaque(badge.colour.ground()), opaque(badge.colour.ink()));
        // Coordinates are in 176ths of the badge's side.
        let unit = square.width / 176.0;
        let part = |x: f32, y: f32, width: f32, height: f32| {
            PanelRect::new(square.x + x * unit, square.y + y * unit, width * unit, height * unit)
        };
        let style = BoxStyle { radius_mm: 4.0 * unit, fill: ground, ..BoxStyle::default() };
        self.add_box(square, &style);
        let rim = AtlasPicture::of_rim(badge.colour);
        let (long, high) = (168.0, 21.0);
        let edges = [
            part(4.0, 4.0, long, high),
            part(172.0 - high, 4.0, high, long),
            part(4.0, 172.0 - high, long, high),
            part(4.0, 4.0, high, long),
        ];
        for (turns, edge) in (0u8..).zip(edges) {
            self.add_picture(&rim, edge, turns, ink);
        }
        for (k, pictogram) in badge.pictograms.iter().enumerate() {
            let (column, row) = ((k % 2) as f32, (k / 2) as f32);
            let place = part(29.0 + column * 62.0, 29.0 + row * 62.0, 56.0, 56.0);
            self.add_pictogram(*pictogram, place, ink);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panel_draws_no_more_than_it_may() {
        let mut panel = Panel::new([100.0; 2]);
        for _ in 0..PANEL_QUADS + 10 {
            panel.add_box(panel.rect(), &BoxStyle::default());
        }
        assert_eq!(panel.quads().len(), PANEL_QUADS);
    }
}
