//! The quads that a panel is drawn of, and the colour at a point of a quad: the twin of `wgsl/panel.wgsl`.

use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3};

use super::font::{ATLAS_SIZE, atlas_texels};
use super::pictures::PanelPictures;
use crate::constants::{
    PANEL_BOX, PANEL_IMAGE, PANEL_QUAD_MARGIN, PANEL_REACH_TEXELS, PANEL_RING, PANEL_SHAPE,
    SRGB_EXPONENT, SRGB_LINEAR_SLOPE, SRGB_OFFSET,
};

/// A rectangle of a panel, drawn over those before it.
#[derive(Clone, Copy, PartialEq, Default, Pod, Zeroable, Debug)]
#[repr(C)]
pub struct PanelQuad {
    /// Millimetres from the panel's upper left corner, y down.
    pub middle: [f32; 2],
    /// Half the width and height, in millimetres: with the margin for a shape, without it for other kinds.
    pub half: [f32; 2],
    /// Parameters by kind. A box: its corners' radius, its outline's width and the width over which its
    /// edge fades, in millimetres. A shape: its middle in the atlas, in texels, and the texels of a
    /// millimetre to the right. A ring: its width in millimetres, and the part of it from its top
    /// clockwise. An image: its corners' radius in millimetres, and as the fourth its cell's number.
    pub shape: [f32; 4],
    /// Fill colour: sRGB with straight alpha.
    pub fill: [u8; 4],
    /// Outline colour of a box.
    pub outline: [u8; 4],
    /// `PANEL_BOX`, `PANEL_SHAPE`, `PANEL_RING` or `PANEL_IMAGE`.
    pub kind: u32,
}

/// A linear colour with straight alpha.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct QuadColor {
    pub(crate) rgb: Vec3,
    pub(crate) alpha: f32,
}

impl PanelQuad {
    /// Returns half the width and height that are drawn, in millimetres.
    pub(crate) fn drawn_half(&self) -> Vec2 {
        let margin = match self.kind {
            PANEL_SHAPE => 0.0,
            PANEL_RING | PANEL_IMAGE => PANEL_QUAD_MARGIN,
            _ => PANEL_QUAD_MARGIN + 0.5 * self.shape[2],
        };
        Vec2::from_array(self.half) + Vec2::splat(margin)
    }

    /// Returns the colour at a point, in millimetres from the quad's middle, y down; a pixel is `pixel_mm`
    /// wide there.
    pub(crate) fn color_at(&self, at: Vec2, pixel_mm: f32, pictures: &PanelPictures) -> QuadColor {
        let coverage = |distance: f32, width: f32| (distance / width + 0.5).clamp(0.0, 1.0);
        if self.kind == PANEL_IMAGE {
            let half = Vec2::from_array(self.half);
            let QuadColor { rgb, alpha } =
                pictures.color_at(self.shape[3], (at + half) / (2.0 * half));
            let alpha = alpha * coverage(self.box_distance(at), pixel_mm);
            return QuadColor { rgb, alpha };
        }
        let fill = linear_color(self.fill);
        if self.kind != PANEL_BOX {
            let distance = match self.kind {
                PANEL_RING => self.ring_distance(at),
                _ => self.shape_distance(at),
            };
            return QuadColor { alpha: fill.alpha * coverage(distance, pixel_mm), ..fill };
        }
        let [_, outline_width, softness, _] = self.shape;
        let distance = self.box_distance(at);
        let mut outer = coverage(distance, pixel_mm.max(softness));
        if softness > 0.0 {
            outer = outer * outer * (3.0 - 2.0 * outer);
        }
        let outline = linear_color(self.outline);
        let inner = match outline_width > 0.0 {
            true => coverage(distance - outline_width, pixel_mm),
            false => 1.0,
        };
        QuadColor {
            rgb: outline.rgb.lerp(fill.rgb, inner),
            alpha: outer * (outline.alpha + (fill.alpha - outline.alpha) * inner),
        }
    }

    /// Returns the distance to a rounded box's edge, positive inside.
    fn box_distance(&self, at: Vec2) -> f32 {
        let radius = self.shape[0];
        let beyond = at.abs() - Vec2::from_array(self.half) + Vec2::splat(radius);
        let outside = beyond.max(Vec2::ZERO);
        radius - length(outside) - beyond.max_element().min(0.0)
    }

    /// Returns the distance to the edge of a part of a ring with round ends, positive inside.
    fn ring_distance(&self, at: Vec2) -> f32 {
        let [width, part, ..] = self.shape;
        let middle_radius = self.half[0] - 0.5 * width;
        let turn = core::f32::consts::TAU * part;
        let mut angle = at.x.atan2(-at.y);
        if angle < 0.0 {
            angle += core::f32::consts::TAU;
        }
        if angle <= turn {
            return 0.5 * width - (length(at) - middle_radius).abs();
        }
        let start = Vec2::new(0.0, -middle_radius);
        let end = Vec2::new(turn.sin(), -turn.cos()) * middle_radius;
        0.5 * width - length(at - start).min(length(at - end))
    }

    /// Returns the distance to a shape's edge by the atlas, positive inside.
    fn shape_distance(&self, at: Vec2) -> f32 {
        let [u, v, along, across] = self.shape;
        let texel = [u + at.x * along - at.y * across, v + at.x * across + at.y * along];
        let texels_per_mm = length(Vec2::new(along, across));
        (sample_atlas(texel) - 0.5) * 2.0 * PANEL_REACH_TEXELS / texels_per_mm
    }
}

/// Samples the atlas bilinearly at a place in texels, 0 to 1.
fn sample_atlas([u, v]: [f32; 2]) -> f32 {
    let texels = atlas_texels();
    let [width, height] = ATLAS_SIZE.map(|side| side as i32);
    let (x, y) = ((u - 0.5).floor(), (v - 0.5).floor());
    let (s, t) = (u - 0.5 - x, v - 0.5 - y);
    let texel = |i: i32, j: i32| {
        let (i, j) = ((x as i32 + i).clamp(0, width - 1), (y as i32 + j).clamp(0, height - 1));
        f32::from(texels[(j * width + i) as usize]) / 255.0
    };
    let row = |j| texel(0, j) * (1.0 - s) + texel(1, j) * s;
    row(0) * (1.0 - t) + row(1) * t
}

/// Converts sRGB bytes to a linear colour.
pub(crate) fn linear_color(color: [u8; 4]) -> QuadColor {
    let [r, g, b, alpha] = color.map(|c| f32::from(c) / 255.0);
    let linear = |c: f32| match c <= 0.04045 {
        true => c / SRGB_LINEAR_SLOPE,
        false => ((c + SRGB_OFFSET) / (1.0 + SRGB_OFFSET)).powf(SRGB_EXPONENT),
    };
    QuadColor { rgb: Vec3::new(linear(r), linear(g), linear(b)), alpha }
}

/// Returns a vector's length, by the hardware's square root; glam uses libm's here, as the core needs it.
fn length(v: Vec2) -> f32 {
    (v.x * v.x + v.y * v.y).sqrt()
}
