//! Outline of the bit over the picture; with the mirror on, also of the bit's reflection and of the mirror's
//! plane.

use std::f32::consts::TAU;

use egui::{Color32, Context, LayerId, Pos2, Stroke};
use glam::{Quat, Vec3};
use paros_core::World;
use paros_core::edit::Pose;
use paros_core::internals::BitShape;
use paros_core::limits::INTERVALS;
use paros_core::session::Tool;
use paros_core::volume::{Grid, Size};

use super::style;
use crate::window::camera::{OrbitCamera, ProjectedPoint};
use crate::window::hands::RIGHT;

/// Sides of the polygon that a disc's outline is drawn as.
const DISC_SIDES: u32 = 32;

/// A shape's projected outline in pixels: a ball's circle, a box's edges or a disc's rim.
#[derive(Clone, PartialEq, Debug, Default)]
struct Silhouette {
    lines: Vec<[[f32; 2]; 2]>,
    circle: Option<([f32; 2], f32)>,
}

/// The bit's projected outline.
#[derive(Clone, PartialEq, Debug)]
pub(in crate::window) struct BitOutline {
    silhouette: Silhouette,
    running: bool,
    on_mask: bool,
}

/// The mirror's plane and the reflection of the bit, shown while the mirror is in use.
#[derive(Clone, PartialEq, Debug)]
pub(in crate::window) struct MirrorGuide {
    /// The frame of the plane, as far as it is in front of the eye.
    plane: Vec<[[f32; 2]; 2]>,
    reflection: Option<Silhouette>,
}

impl Silhouette {
    /// Projects the silhouette of a bit's shape. `project` projects a point of the bit's own frame, in
    /// metres. Returns `None` if a part is behind the eye.
    fn project_shape(
        shape: &BitShape,
        project: impl Fn(Vec3) -> Option<ProjectedPoint>,
    ) -> Option<Self> {
        let pixel = |point: Vec3| project(point).map(|point| point.pixel);
        let mut silhouette = Silhouette::default();
        match *shape {
            BitShape::Ball { radius_um } => {
                let middle = project(Vec3::ZERO)?;
                let radius_pixels = middle.pixels_per_metre * radius_um as f32 * 1e-6;
                silhouette.circle = Some((middle.pixel, radius_pixels));
            }
            BitShape::Disc { radius_um } => {
                let radius = radius_um as f32 * 1e-6;
                let rim = |part: u32| {
                    let (sine, cosine) = (TAU * part as f32 / DISC_SIDES as f32).sin_cos();
                    pixel(Vec3::new(0.0, cosine, sine) * radius)
                };
                for part in 0..DISC_SIDES {
                    silhouette.lines.push([rim(part)?, rim(part + 1)?]);
                }
            }
            BitShape::Box { half_extents_um } => {
                let half = Vec3::from_array(half_extents_um.map(|v| v as f32 * 1e-6));
                let corner = |i: u32| {
                    let sign = |k: u32| if i >> k & 1 == 1 { 1.0 } else { -1.0 };
                    pixel(half * Vec3::new(sign(0), sign(1), sign(2)))
                };
                for (i, k) in (0..8u32).flat_map(|i| (0..3u32).map(move |k| (i, k))) {
                    if i >> k & 1 == 0 {
                        silhouette.lines.push([corner(i)?, corner(i | 1 << k)?]);
                    }
                }
            }
        }
        Some(silhouette)
    }

    fn draw(&self, context: &Context, stroke: Stroke) {
        draw_lines(context, &self.lines, stroke);
        if let Some((middle, radius)) = self.circle {
            let scale = context.pixels_per_point();
            let painter = context.layer_painter(LayerId::background());
            painter.circle_stroke(to_point(middle, scale), radius / scale, stroke);
        }
    }
}

impl BitOutline {
    /// Projects the right hand's bit to a picture of `picture_size` pixels. Returns `None` without a bit, or
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
        let (shape, frozen) = bit_in_hand(world)?;
        let (position, rotation) = world.stool_frame().to_room(&frozen);
        let silhouette = Silhouette::project_shape(&shape, |point| {
            orbit.project_point(position + rotation * point, picture_size)
        })?;
        let on_mask = world.hand_contact(RIGHT).is_some_and(|contact| contact.on_mask);
        Some(BitOutline { silhouette, running: world.hand_state(RIGHT).trigger, on_mask })
    }

    pub(super) fn draw(&self, context: &Context) {
        let color = match (self.on_mask, self.running) {
            (true, _) => style::WARNING,
            (false, true) => style::ACCENT,
            (false, false) => Color32::from_white_alpha(150),
        };
        self.silhouette.draw(context, Stroke::new(1.6, color));
    }
}

impl MirrorGuide {
    /// Projects the mirror's plane, which halves the grid along x, and the reflection of the right hand's
    /// bit. Returns `None` if nothing is mirrored.
    #[must_use]
    pub(in crate::window) fn project_mirror<const N: usize>(
        world: &World<N, INTERVALS>,
        orbit: &OrbitCamera,
        picture_size: [u32; 2],
    ) -> Option<Self>
    where
        Grid<N>: Size,
    {
        if !world.is_mirrored() {
            return None;
        }
        let (frame, side) = (world.stool_frame(), N as f32);
        let project = |place: Vec3| {
            let (point, _) = frame.to_room(&Pose { position: place, rotation: Quat::IDENTITY });
            orbit.project_point(point, picture_size)
        };
        let corners = [(0.0, 0.0), (0.0, side), (side, side), (side, 0.0)]
            .map(|(y, z)| project(Vec3::new(side / 2.0, y, z)).map(|corner| corner.pixel));
        let edges = (0..4).filter_map(|i| Some([corners[i]?, corners[(i + 1) % 4]?]));
        // Far from the stone nothing is mirrored, so that no reflection is shown there.
        let near = |pose: &Pose| {
            let beyond = pose.position - pose.position.clamp(Vec3::ZERO, Vec3::splat(side));
            beyond.length() < side / 4.0
        };
        let bit = bit_in_hand(world).filter(|(_, frozen)| near(frozen));
        let reflection = bit.and_then(|(shape, frozen)| {
            Silhouette::project_shape(&shape, |point| {
                let place = frozen.position + frozen.rotation * point / frame.voxel_metres();
                project(Vec3 { x: side - place.x, ..place })
            })
        });
        Some(MirrorGuide { plane: edges.collect(), reflection })
    }

    pub(super) fn draw(&self, context: &Context) {
        // The colour is visible on white stone and before a dark wall.
        let stroke = |strength| Stroke::new(1.4, style::ACCENT.gamma_multiply(strength));
        draw_lines(context, &self.plane, stroke(0.6));
        if let Some(reflection) = &self.reflection {
            reflection.draw(context, stroke(0.9));
        }
    }
}

/// Returns `true` if the fill gun runs in the right hand with its nozzle outside the volume, where paste
/// isn't kept.
#[must_use]
pub(in crate::window) fn is_pasting_beyond_box<const N: usize>(world: &World<N, INTERVALS>) -> bool
where
    Grid<N>: Size,
{
    let hand = world.hand_state(RIGHT);
    let nozzle = hand.frozen_pose.position;
    matches!(world.held_tool(RIGHT), Some((Tool::FillGun, _)))
        && hand.trigger
        && hand.has_frozen_pose
        && nozzle != nozzle.clamp(Vec3::ZERO, Vec3::splat(N as f32))
}

/// Returns the shape of the right hand's bit, and its pose in the grid.
fn bit_in_hand<const N: usize>(world: &World<N, INTERVALS>) -> Option<(BitShape, Pose)>
where
    Grid<N>: Size,
{
    let spec = world.held_bit_spec(RIGHT)?;
    let hand = world.hand_state(RIGHT);
    hand.has_frozen_pose.then_some((spec.shape, hand.frozen_pose))
}

fn draw_lines(context: &Context, lines: &[[[f32; 2]; 2]], stroke: Stroke) {
    let scale = context.pixels_per_point();
    let painter = context.layer_painter(LayerId::background());
    for [from, to] in lines {
        painter.line_segment([to_point(*from, scale), to_point(*to, scale)], stroke);
    }
}

fn to_point(pixel: [f32; 2], pixels_per_point: f32) -> Pos2 {
    Pos2::new(pixel[0] / pixels_per_point, pixel[1] / pixels_per_point)
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use paros_core::internals::BitShape;

    use super::Silhouette;
    use crate::window::camera::ProjectedPoint;

    /// Projects along z from far away, at 100 pixels a metre.
    fn along_z(point: Vec3) -> Option<ProjectedPoint> {
        let pixel = [100.0 * point.x, -100.0 * point.y];
        (point.z < 0.5).then_some(ProjectedPoint { pixel, pixels_per_metre: 100.0 })
    }

    #[test]
    fn shapes_have_the_outlines_of_what_is_seen_of_them() {
        let outline = |shape| Silhouette::project_shape(&shape, along_z);
        let ball = outline(BitShape::Ball { radius_um: 20_000 }).expect("before the eye");
        assert_eq!((ball.circle, ball.lines.len()), (Some(([0.0, 0.0], 2.0)), 0));
        let of_box = outline(BitShape::Box { half_extents_um: [10_000, 20_000, 5_000] });
        let of_box = of_box.expect("before the eye");
        assert!(of_box.lines.len() == 12 && of_box.circle.is_none());
        let corners = of_box.lines.as_flattened();
        assert!(corners.iter().all(|[x, y]| (x.abs(), y.abs()) == (1.0, 2.0)), "{corners:?}");
        // A disc's normal is x: from the front only its edge is seen.
        let disc = outline(BitShape::Disc { radius_um: 70_000 }).expect("before the eye");
        assert!(disc.lines.as_flattened().iter().all(|[x, y]| *x == 0.0 && y.abs() < 7.01));
        // A part of this box is behind the eye.
        assert_eq!(outline(BitShape::Box { half_extents_um: [1, 1, 600_000] }), None);
    }
}
