//! Highlight of the workbench's item under the cursor, which a click takes.

use egui::{Align2, Color32, Context, LayerId, Pos2, Shape, Stroke, Vec2};
use paros_core::World;
use paros_core::limits::INTERVALS;
use paros_core::session::BenchItem;
use paros_core::volume::{Grid, Size};
use paros_shaders::panel::{Language, Message};

use super::{style, words};
use crate::window::camera::OrbitCamera;
use crate::window::hands::bench_pick;

/// The projected body of an item, and its name.
#[derive(Clone, PartialEq, Debug)]
pub(in crate::window) struct ItemGlow {
    /// The convex hull of the body, in pixels.
    hull: Vec<[f32; 2]>,
    name: Message,
}

impl ItemGlow {
    /// Projects an item's drawn body to a picture of `picture_size` pixels. Returns `None` if it can't be
    /// seen.
    #[must_use]
    pub(in crate::window) fn project_item<const N: usize>(
        world: &World<N, INTERVALS>,
        orbit: &OrbitCamera,
        picture_size: [u32; 2],
        item: BenchItem,
    ) -> Option<Self>
    where
        Grid<N>: Size,
    {
        let vertices = bench_pick::body_vertices(world, item).into_iter();
        let pixels = vertices.map(|vertex| Some(orbit.project_point(vertex, picture_size)?.pixel));
        let hull = convex_hull(pixels.collect::<Option<Vec<_>>>()?);
        (hull.len() > 2).then_some(ItemGlow { hull, name: words::item_name(item) })
    }

    pub(super) fn draw(&self, context: &Context, language: Language) {
        let painter = context.layer_painter(LayerId::background());
        let scale = context.pixels_per_point();
        let points: Vec<_> =
            self.hull.iter().map(|pixel| Pos2::new(pixel[0], pixel[1]) / scale).collect();
        let ground = style::ACCENT.gamma_multiply(0.22);
        let highest = points.iter().copied().min_by(|a, b| a.y.total_cmp(&b.y));
        painter.add(Shape::convex_polygon(points, ground, Stroke::new(2.5, style::ACCENT)));
        if let Some(highest) = highest {
            self.draw_name(context, language, highest - Vec2::new(0.0, 10.0));
        }
    }

    /// Draws the item's name over a point, within the window.
    fn draw_name(&self, context: &Context, language: Language, over: Pos2) {
        let painter = context.layer_painter(LayerId::background());
        let font = egui::FontId::proportional(14.0);
        let galley = painter.layout_no_wrap(self.name.text(language).into(), font, style::TEXT);
        let padding = Vec2::new(8.0, 4.0);
        let size = galley.size() + 2.0 * padding;
        let place = Align2::CENTER_BOTTOM.anchor_size(over, size);
        let window = context.content_rect().shrink(style::MARGIN);
        let inside =
            (window.min - place.min).max(Vec2::ZERO) + (window.max - place.max).min(Vec2::ZERO);
        let place = place.translate(inside);
        painter.rect_filled(place, 8.0, style::PANEL);
        painter.galley(place.min + padding, galley, Color32::WHITE);
    }
}

/// Returns the convex hull of points, counter-clockwise with y up (monotone chain, Andrew 1979).
fn convex_hull(mut points: Vec<[f32; 2]>) -> Vec<[f32; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    points.dedup();
    let turns_left = |a: [f32; 2], b: [f32; 2], c: [f32; 2]| {
        (b[0] - a[0]) * (c[1] - a[1]) > (b[1] - a[1]) * (c[0] - a[0])
    };
    let chain = |points: &mut dyn Iterator<Item = [f32; 2]>| {
        let mut chain: Vec<[f32; 2]> = Vec::new();
        for point in points {
            while let [.., a, b] = chain[..]
                && !turns_left(a, b, point)
            {
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        chain
    };
    let mut hull = chain(&mut points.iter().copied());
    hull.extend(chain(&mut points.iter().rev().copied()));
    hull
}

#[cfg(test)]
mod tests {
    use super::convex_hull;

    #[test]
    fn a_hull_has_the_outer_corners_alone() {
        let square = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
        let mut points = vec![[1.0, 1.0], [2.0, 0.0], [3.0, 2.0], [0.0, 2.0]];
        points.extend(square);
        assert_eq!(convex_hull(points), square);
        assert!(convex_hull(vec![[1.0, 1.0]; 3]).len() < 3, "a point has no inside");
    }
}
