//! The interface's icons, in the vector form of the badges' pictograms: 64 units a side, y down.

mod signs;
mod things;

use paros_core::badge::{BadgePart, BadgePoint, BadgeShape, Pictogram};

/// An icon: the name of its variant, its description, its parts.
pub(crate) struct IconShape {
    pub(crate) name: &'static str,
    pub(crate) shows: &'static str,
    pub(crate) parts: Vec<BadgePart>,
}

/// The name of an icon's variant, its description, its parts.
type IconRow = (&'static str, &'static str, &'static [BadgePart]);

/// Returns all icons, in the order of the generated `Icon`.
pub(crate) fn all_icons() -> Vec<IconShape> {
    let icon = |name, shows, parts: &[BadgePart]| IconShape { name, shows, parts: parts.to_vec() };
    let mut all = vec![
        icon("RightHand", "A right hand, from its back.", things::RIGHT_HAND),
        IconShape {
            name: "LeftHand",
            shows: "A left hand, from its back.",
            parts: mirrored(things::RIGHT_HAND),
        },
        IconShape {
            name: "Next",
            shows: "An angle to the right: on.",
            parts: mirrored(&[line(9, &[[40, 10], [18, 32], [40, 54]])]),
        },
        icon("Owl", "An owl.", pictogram(0)),
        icon("Cat", "A cat.", pictogram(1)),
        icon("Toy", "The friendly nobody of the creative mode.", pictogram(63)),
    ];
    let mut hands_off = things::RIGHT_HAND.to_vec();
    hands_off.extend([cut(line(13, &[[8, 60], [58, 6]])), line(5, &[[8, 60], [58, 6]])]);
    all.push(IconShape { name: "HandsOff", shows: "A hand, crossed out.", parts: hands_off });
    all.extend(
        signs::SIGNS
            .iter()
            .chain(things::THINGS)
            .map(|(name, shows, parts)| icon(name, shows, parts)),
    );
    all
}

fn pictogram(number: u8) -> &'static [BadgePart] {
    Pictogram::new(number).expect("there are 64").parts()
}

/// Returns the mirror image, left for right.
fn mirrored(parts: &[BadgePart]) -> Vec<BadgePart> {
    let point = |[x, y]: BadgePoint| [64 - x, y];
    let points = |all: &[BadgePoint]| -> &'static [BadgePoint] {
        all.iter().copied().map(point).collect::<Vec<_>>().leak()
    };
    let shape = |shape: BadgeShape| match shape {
        BadgeShape::Polygon(all) => BadgeShape::Polygon(points(all)),
        BadgeShape::Ellipse { centre, radii } => {
            BadgeShape::Ellipse { centre: point(centre), radii }
        }
        BadgeShape::Line { points: all, width } => BadgeShape::Line { points: points(all), width },
    };
    parts.iter().map(|part| BadgePart { shape: shape(part.shape), ..*part }).collect()
}

const fn polygon(corners: &'static [BadgePoint]) -> BadgePart {
    BadgePart { shape: BadgeShape::Polygon(corners), is_hole: false }
}

const fn oval(x: i8, y: i8, rx: i8, ry: i8) -> BadgePart {
    BadgePart { shape: BadgeShape::Ellipse { centre: [x, y], radii: [rx, ry] }, is_hole: false }
}

const fn disc(x: i8, y: i8, radius: i8) -> BadgePart {
    oval(x, y, radius, radius)
}

const fn line(width: i8, points: &'static [BadgePoint]) -> BadgePart {
    BadgePart { shape: BadgeShape::Line { points, width }, is_hole: false }
}

const fn cut(part: BadgePart) -> BadgePart {
    BadgePart { is_hole: true, ..part }
}
