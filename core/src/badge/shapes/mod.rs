//! The pictograms and rims as vector shapes, which can be drawn at any size.
//!
//! Inputs: a pictogram or a colour. Outputs: its parts as constants, and a test for points that they ink.
//! Independent of pixels: shells either fill polygons or test point by point.

mod creatures;
mod nature;
mod places;
mod rims;
mod things;

use crate::badge::code::{BadgeColour, Pictogram};

/// A point of the unit square, in 64ths of its side: x to the right, y down, 0 to 64.
pub type BadgePoint = [i8; 2];

/// Resolution of [`covers_point`]: steps in a 64th of the square's side.
pub const POINT_STEPS: i32 = 16;

/// A part of a pictogram. Parts are drawn over each other, in order.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct BadgePart {
    /// The area that it covers.
    pub shape: BadgeShape,
    /// `true` if it removes ink, so that the ground shows.
    pub is_hole: bool,
}

/// A filled shape in the unit square; lengths in 64ths of its side.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum BadgeShape {
    /// A polygon whose edges don't cross; the last point is connected to the first.
    Polygon(&'static [BadgePoint]),
    /// An axis-aligned ellipse.
    Ellipse {
        /// The centre.
        centre: BadgePoint,
        /// Half its width and height, at least 1.
        radii: [i8; 2],
    },
    /// Straight lines from point to point, with round ends and corners.
    Line {
        /// The points, at least two.
        points: &'static [BadgePoint],
        /// The width of the line.
        width: i8,
    },
}

impl Pictogram {
    /// Returns its parts, drawn in the ink of its badge's colour.
    #[must_use]
    pub const fn parts(self) -> &'static [BadgePart] {
        PICTOGRAMS[self.number()]
    }
}

impl BadgeColour {
    /// Returns the ground colour of the badge, in sRGB. The colours also differ in lightness, and their rims
    /// distinguish them without any colour.
    #[must_use]
    pub const fn ground(self) -> [u8; 3] {
        match self {
            BadgeColour::Red => [0xc4, 0x12, 0x2f],
            BadgeColour::Orange => [0xf5, 0x8a, 0x00],
            BadgeColour::Yellow => [0xff, 0xe8, 0x38],
            BadgeColour::Green => [0x00, 0x9e, 0x60],
            BadgeColour::Blue => [0x00, 0x55, 0xc8],
            BadgeColour::Pink => [0xff, 0xa6, 0xd2],
            BadgeColour::White => [0xff, 0xff, 0xff],
            BadgeColour::Black => [0x10, 0x10, 0x10],
        }
    }

    /// Returns the ink of pictograms and rim on this ground, in sRGB: black or white, whichever has more
    /// contrast.
    #[must_use]
    pub const fn ink(self) -> [u8; 3] {
        match self {
            BadgeColour::Red | BadgeColour::Blue | BadgeColour::Black => [0xff; 3],
            _ => [0; 3],
        }
    }

    /// Returns the pattern of its rim along the upper edge of a square around the pictograms, drawn in the
    /// ink. The other edges are rotated by quarter turns.
    #[must_use]
    pub const fn rim(self) -> &'static [BadgePart] {
        rims::RIMS[self as usize]
    }
}

/// Returns `true` if the parts ink a point of the unit square, in [`POINT_STEPS`] to a 64th of its side.
#[must_use]
pub fn covers_point(parts: &[BadgePart], point: [i32; 2]) -> bool {
    parts.iter().rev().find(|part| part.shape.contains(point)).is_some_and(|part| !part.is_hole)
}

/// The pictograms of all groups, in the order of their numbers.
const PICTOGRAMS: [&[BadgePart]; Pictogram::COUNT] = {
    let groups: [&[&[BadgePart]]; 4] =
        [&creatures::CREATURES, &nature::NATURE, &things::THINGS, &places::PLACES];
    let mut all: [&[BadgePart]; Pictogram::COUNT] = [&[]; Pictogram::COUNT];
    let (mut number, mut group) = (0, 0);
    while group < groups.len() {
        let mut i = 0;
        while i < groups[group].len() {
            all[number] = groups[group][i];
            number += 1;
            i += 1;
        }
        group += 1;
    }
    assert!(number == Pictogram::COUNT);
    all
};

impl BadgeShape {
    /// Returns `true` if a point is inside the shape or on its edge.
    fn contains(&self, point: [i32; 2]) -> bool {
        let point = point.map(i64::from);
        match *self {
            BadgeShape::Polygon(corners) => is_in_polygon(corners, point),
            BadgeShape::Ellipse { centre, radii } => {
                let [rx, ry] = radii.map(to_steps);
                let [cx, cy] = centre.map(to_steps);
                let (x, y) = (point[0].saturating_sub(cx), point[1].saturating_sub(cy));
                x.abs() <= rx
                    && y.abs() <= ry
                    && (x * ry).pow(2) + (y * rx).pow(2) <= (rx * ry).pow(2)
            }
            BadgeShape::Line { points, width } => points
                .windows(2)
                .any(|ends| is_near_segment([ends[0], ends[1]], to_steps(width), point)),
        }
    }
}

fn to_steps(length: i8) -> i64 {
    i64::from(length) * i64::from(POINT_STEPS)
}

/// Tests by the parity of the edges that a ray to the right crosses.
fn is_in_polygon(corners: &[BadgePoint], [x, y]: [i64; 2]) -> bool {
    let mut is_inside = false;
    let mut from = corners.last().copied().unwrap_or([0; 2]).map(to_steps);
    for corner in corners {
        let to = corner.map(to_steps);
        if (from[1] > y) != (to[1] > y) {
            let (upper, lower) = if from[1] < to[1] { (from, to) } else { (to, from) };
            let side =
                (lower[0] - upper[0]) * (y - upper[1]) - (x - upper[0]) * (lower[1] - upper[1]);
            is_inside ^= side > 0;
        }
        from = to;
    }
    is_inside
}

/// Returns `true` if a point is within half a width of a segment.
fn is_near_segment(ends: [BadgePoint; 2], width: i64, [x, y]: [i64; 2]) -> bool {
    // Points far outside the square are never inked; this keeps the products small.
    let far = to_steps(i8::MAX) * 4;
    if x.saturating_abs() > far || y.saturating_abs() > far {
        return false;
    }
    let [a, b] = ends.map(|end| end.map(to_steps));
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let (px, py) = (x - a[0], y - a[1]);
    let (along, length2) = (px * dx + py * dy, dx * dx + dy * dy);
    if along <= 0 || length2 == 0 {
        return 4 * (px * px + py * py) <= width * width;
    }
    if along >= length2 {
        let (qx, qy) = (x - b[0], y - b[1]);
        return 4 * (qx * qx + qy * qy) <= width * width;
    }
    let across = px * dy - py * dx;
    4 * across * across <= width * width * length2
}

const fn ink(shape: BadgeShape) -> BadgePart {
    BadgePart { shape, is_hole: false }
}

/// Creates a polygon of ink.
const fn polygon(corners: &'static [BadgePoint]) -> BadgePart {
    ink(BadgeShape::Polygon(corners))
}

/// Creates an ellipse of ink.
const fn oval(x: i8, y: i8, rx: i8, ry: i8) -> BadgePart {
    ink(BadgeShape::Ellipse { centre: [x, y], radii: [rx, ry] })
}

/// Creates a disc of ink.
const fn disc(x: i8, y: i8, radius: i8) -> BadgePart {
    oval(x, y, radius, radius)
}

/// Creates a line of ink.
const fn line(width: i8, points: &'static [BadgePoint]) -> BadgePart {
    ink(BadgeShape::Line { points, width })
}

/// Returns the part as a hole, which removes ink.
const fn cut(part: BadgePart) -> BadgePart {
    BadgePart { is_hole: true, ..part }
}
