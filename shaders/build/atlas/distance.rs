//! Signed distances to outlines and to the parts of pictograms, positive inside.

use paros_core::badge::{BadgePart, BadgeShape};

/// Closed outlines of straight lines, filled by the non-zero winding rule.
pub(crate) struct Contours(pub(crate) Vec<Vec<[f32; 2]>>);

impl Contours {
    /// Returns the lowest and the highest coordinates; `None` without points.
    pub(crate) fn bounds(&self) -> Option<[[f32; 2]; 2]> {
        let mut points = self.0.iter().flatten();
        let first = *points.next()?;
        Some(points.fold([first, first], |[low, high], point| {
            [
                [low[0].min(point[0]), low[1].min(point[1])],
                [high[0].max(point[0]), high[1].max(point[1])],
            ]
        }))
    }

    /// Returns the signed distance to the outline.
    pub(crate) fn signed_distance(&self, at: [f32; 2]) -> f32 {
        let (mut nearest, mut winding) = (f32::INFINITY, 0);
        for contour in &self.0 {
            for (from, to) in edges(contour) {
                nearest = nearest.min(distance_to_segment(at, from, to));
                winding += crossing(at, from, to);
            }
        }
        if winding == 0 { -nearest } else { nearest }
    }
}

/// Returns the signed distance to the edge of the area that parts ink, drawn one over the other; in 64ths
/// of the unit square's side.
pub(crate) fn distance_to_parts(parts: &[BadgePart], at: [f32; 2]) -> f32 {
    parts.iter().fold(f32::NEG_INFINITY, |ink, part| {
        let distance = distance_to_shape(&part.shape, at);
        if part.is_hole { ink.min(-distance) } else { ink.max(distance) }
    })
}

fn distance_to_shape(shape: &BadgeShape, at: [f32; 2]) -> f32 {
    match *shape {
        BadgeShape::Polygon(corners) => {
            let corners: Vec<_> = corners.iter().map(|corner| corner.map(f32::from)).collect();
            let nearest = edges(&corners)
                .map(|(from, to)| distance_to_segment(at, from, to))
                .fold(f32::INFINITY, f32::min);
            let crossings = edges(&corners).filter(|(from, to)| crossing(at, *from, *to) != 0);
            if crossings.count() % 2 == 0 { -nearest } else { nearest }
        }
        BadgeShape::Ellipse { centre, radii } => {
            distance_to_ellipse(at, centre.map(f32::from), radii.map(f32::from))
        }
        BadgeShape::Line { points, width } => {
            let nearest = points
                .windows(2)
                .map(|ends| distance_to_segment(at, ends[0].map(f32::from), ends[1].map(f32::from)))
                .fold(f32::INFINITY, f32::min);
            0.5 * f32::from(width) - nearest
        }
    }
}

/// Returns the signed distance to an ellipse: exact for circles, else its implicit function over the
/// gradient's length, exact at the edge to first order.
fn distance_to_ellipse(at: [f32; 2], centre: [f32; 2], radii: [f32; 2]) -> f32 {
    let [x, y] = [at[0] - centre[0], at[1] - centre[1]];
    let [rx, ry] = radii;
    if rx == ry {
        return rx - length([x, y]);
    }
    let scaled = length([x / rx, y / ry]);
    let gradient = length([x / (rx * rx), y / (ry * ry)]);
    if gradient == 0.0 { rx.min(ry) } else { scaled * (1.0 - scaled) / gradient }
}

/// Returns the edges of a closed line.
fn edges(points: &[[f32; 2]]) -> impl Iterator<Item = ([f32; 2], [f32; 2])> {
    let next = points.iter().cycle().skip(1);
    points.iter().copied().zip(next.copied())
}

/// Returns how a ray to the right crosses an edge: 1 downwards, -1 upwards, 0 not at all.
fn crossing(at: [f32; 2], from: [f32; 2], to: [f32; 2]) -> i32 {
    if (from[1] > at[1]) == (to[1] > at[1]) {
        return 0;
    }
    let part = (at[1] - from[1]) / (to[1] - from[1]);
    let is_right = from[0] + part * (to[0] - from[0]) > at[0];
    match (is_right, to[1] > from[1]) {
        (false, _) => 0,
        (true, true) => 1,
        (true, false) => -1,
    }
}

fn distance_to_segment(at: [f32; 2], from: [f32; 2], to: [f32; 2]) -> f32 {
    let along = [to[0] - from[0], to[1] - from[1]];
    let there = [at[0] - from[0], at[1] - from[1]];
    let length2 = along[0] * along[0] + along[1] * along[1];
    let dot = there[0] * along[0] + there[1] * along[1];
    let part = if length2 == 0.0 { 0.0 } else { (dot / length2).clamp(0.0, 1.0) };
    length([there[0] - part * along[0], there[1] - part * along[1]])
}

fn length([x, y]: [f32; 2]) -> f32 {
    (x * x + y * y).sqrt()
}
