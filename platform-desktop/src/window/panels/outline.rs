//! Outline of the bit over the picture.

use egui::{Color32, Context, LayerId, Pos2, Stroke};
use glam::Vec3;
use paros_core::World;
use paros_core::internals::BitShape;
use paros_core::limits::INTERVALS;
use paros_core::volume::{Grid, Size};

use super::style;
use crate::window::camera::OrbitCamera;
use crate::window::hands::RIGHT;

/// The bit's projected outline in pixels: a ball's circle or a box's edges.
#[derive(Clone, PartialEq, Debug)]
pub(in crate::window) struct BitOutline {
    lines: Vec<[[f32; 2]; 2]>,
    circle: Option<([f32; 2], f32)>,
    running: bool,
    on_mask: bool,
}

impl BitOutline {
    /// Projects the right hand's bit to a picture of `picture_size` pixels. `None` without a bit, or
    /// behind the eye.
    #[must_use]
    pub(in crate::window) fn project_bit<const N: usize>(
        world: &World<N, INTERVALS>,
        orbit: &OrbitCamera,
        picture_size: [u32; 2],
    ) -> Option<Self>
    where
        Grid<N>: Size,
    {
        let (_, bit) = world.held_tool(RIGHT)?;
        let hand = world.hand_state(RIGHT);
        if !hand.has_frozen_pose {
            return None;
        }
        let (position, rotation) = world.stool_frame().to_room(&hand.frozen_pose);
        let on_mask = world.hand_contact(RIGHT).is_some_and(|contact| contact.on_mask);
        let mut outline =
            BitOutline { lines: Vec::new(), circle: None, running: hand.trigger, on_mask };
        match bit.spec().shape {
            BitShape::Ball { radius_um } => {
                let middle = orbit.project_point(position, picture_size)?;
                let radius_pixels = middle.pixels_per_metre * radius_um as f32 * 1e-6;
                outline.circle = Some((middle.pixel, radius_pixels));
            }
            BitShape::Box { half_extents_um } => {
                let half = Vec3::from_array(half_extents_um.map(|v| v as f32 * 1e-6));
                let corner = |i: u32| {
                    let sign = |k: u32| if i >> k & 1 == 1 { 1.0 } else { -1.0 };
                    let corner = half * Vec3::new(sign(0), sign(1), sign(2));
                    orbit
                        .project_point(position + rotation * corner, picture_size)
                        .map(|corner| corner.pixel)
                };
                for (i, k) in (0..8u32).flat_map(|i| (0..3u32).map(move |k| (i, k))) {
                    if i >> k & 1 == 0 {
                        outline.lines.push([corner(i)?, corner(i | 1 << k)?]);
                    }
                }
            }
        }
        Some(outline)
    }

    pub(super) fn draw(&self, context: &Context) {
        let painter = context.layer_painter(LayerId::background());
        let scale = context.pixels_per_point();
        let point = |pixel: [f32; 2]| Pos2::new(pixel[0] / scale, pixel[1] / scale);
        let color = match (self.on_mask, self.running) {
            (true, _) => style::WARNING,
            (false, true) => style::ACCENT,
            (false, false) => Color32::from_white_alpha(150),
        };
        let stroke = Stroke::new(1.6, color);
        for [from, to] in &self.lines {
            painter.line_segment([point(*from), point(*to)], stroke);
        }
        if let Some((middle, radius)) = self.circle {
            painter.circle_stroke(point(middle), radius / scale, stroke);
        }
    }
}
