//! A panel: what it shows, as a list of quads, and where it stands.

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

/// From one line's foot to the next one's, in heights of a capital letter.
pub const LINE_HEIGHT: f32 = 1.9;

/// Of the margin around a shape in the atlas the outermost half texel isn't drawn, so that nothing of the next cell is.
const TRIM_TEXELS: f32 = 0.5;

/// sRGB with straight alpha.
pub type PanelColor = [u8; 4];

/// How a line lies at its point.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum TextAlign {
    /// It begins there.
    #[default]
    Left,
    /// Its middle is there.
    Middle,
    /// It ends there.
    Right,
}

/// A text's look.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct TextStyle {
    /// The font's weight.
    pub weight: FontWeight,
    /// Height of a capital letter, in millimetres.
    pub capital_mm: f32,
    /// Of the letters.
    pub color: PanelColor,
    /// How it lies.
    pub align: TextAlign,
}

/// A rounded box's look.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
pub struct BoxStyle {
    /// Of its corners, in millimetres.
    pub radius_mm: f32,
    /// Of its inside.
    pub fill: PanelColor,
    /// Of its outline.
    pub outline: PanelColor,
    /// How wide the outline is, within the box; 0 without.
    pub outline_mm: f32,
    /// How far its edge fades, as a shadow's does.
    pub softness_mm: f32,
}

/// A panel. A shell keeps it, and lays it out anew where something changed: nothing is allocated then that fits what
/// was there before.
#[derive(Clone, PartialEq, Default, Debug)]
pub struct Panel {
    /// Where it stands.
    pub pose: PanelPose,
    size_mm: [f32; 2],
    quads: Vec<PanelQuad>,
    least_capital_mm: Option<f32>,
    /// Texts are filled in here.
    filled: String,
}

impl PlaceStyle {
    /// The look of texts of the place.
    #[must_use]
    pub const fn colored(self, color: PanelColor, align: TextAlign) -> TextStyle {
        TextStyle { weight: self.weight, capital_mm: self.capital_mm, color, align }
    }
}

impl Panel {
    /// An empty panel of so many millimetres.
    #[must_use]
    pub fn new(size_mm: [f32; 2]) -> Self {
        Panel { size_mm, ..Panel::default() }
    }

    /// Empties it, and makes it so large.
    pub fn clear(&mut self, size_mm: [f32; 2]) {
        self.quads.clear();
        self.size_mm = size_mm;
        self.least_capital_mm = None;
    }

    /// Its width and height, in millimetres.
    #[must_use]
    pub const fn size_mm(&self) -> [f32; 2] {
        self.size_mm
    }

    /// What it is drawn of, from the back to the front.
    #[must_use]
    pub fn quads(&self) -> &[PanelQuad] {
        &self.quads
    }

    /// All of it.
    #[must_use]
    pub const fn rect(&self) -> PanelRect {
        PanelRect::new(0.0, 0.0, self.size_mm[0], self.size_mm[1])
    }

    /// The angle that a capital letter of its smallest text has at a distance, in degrees; None without text. Below one
    /// it can't be read on a headset.
    #[must_use]
    pub fn least_text_degrees(&self, distance_m: f32) -> Option<f32> {
        self.least_capital_mm.map(|mm| (mm * 1e-3).atan2(distance_m).to_degrees())
    }

    /// Where a ray meets its front, as [`PanelPose::intersect_ray`].
    #[must_use]
    pub fn intersect_ray(&self, origin: Vec3, direction: Vec3) -> Option<PanelPoint> {
        self.pose.intersect_ray(self.size_mm, origin, direction)
    }

    /// Which of its points a point of the room is before or behind, as [`PanelPose::project_point`].
    #[must_use]
    pub fn project_point(&self, point: Vec3) -> PanelPoint {
        self.pose.project_point(self.size_mm, point)
    }

    /// Adds a quad, or leaves it out where the panel has as many as a frame draws.
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

    /// Adds a line of text, its foot at a point: where a capital letter stands.
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

    /// Adds a text in lines of a width at the most, about as long as each other, the first one's foot at a point. How many lines it took.
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

    /// The same with the lines' middle at the height of a point.
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

    /// Adds a message in its place's size and lines, filled in. How many lines it took.
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
        // A string takes any text.
        let _ = message.write_filled(&mut filled, language, fillings);
        let lines = self.add_paragraph(&filled, foot, place.width_mm, &style);
        self.filled = filled;
        lines
    }

    /// Adds a line of text that is written out.
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

    /// Adds the picture of a cell, as large as fits a rectangle, its corners rounded: nothing is seen of it before the
    /// cell has one.
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

    /// Adds a ring around a point, or a part of it from its top clockwise, 0 to 1. Nothing for a part of 0.
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

    /// Adds a bar that is full to a part from its left, 0 to 1.
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
        // In parts of 176 of its side.
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
