//! Model of the badge's shapes in floating point, by other definitions: angles around a point, and the
//! nearest point of a segment. Also simulates how colours look to eyes that lack one kind of cone.

use paros_core::badge::{BadgePart, BadgePoint, BadgeShape};

type Point = [f64; 2];

/// Returns `true` if the parts ink a point of the unit square, in 64ths of its side; `None` within a
/// thousandth of an edge.
pub fn is_inked(parts: &[BadgePart], point: Point) -> Option<bool> {
    let mut inked = false;
    for part in parts {
        let depth = depth_in(&part.shape, point);
        if depth.abs() < 1e-3 {
            return None;
        }
        if depth > 0.0 {
            inked = !part.is_hole;
        }
    }
    Some(inked)
}

/// Returns the approximate signed distance to the edge, positive inside.
fn depth_in(shape: &BadgeShape, point: Point) -> f64 {
    match *shape {
        BadgeShape::Polygon(corners) => {
            let to_edge = distance_to_line(corners, point)
                .min(distance_to_line(&[corners[corners.len() - 1], corners[0]], point));
            if angle_around(corners, point).abs() > 3.0 { to_edge } else { -to_edge }
        }
        BadgeShape::Ellipse { centre, radii } => {
            let scaled = |k: usize| (point[k] - f64::from(centre[k])) / f64::from(radii[k]);
            (1.0 - scaled(0).hypot(scaled(1))) * f64::from(radii[0].min(radii[1]))
        }
        BadgeShape::Line { points, width } => {
            f64::from(width) / 2.0 - distance_to_line(points, point)
        }
    }
}

/// Returns the sum of the angles under which the edges are seen: a full turn from inside.
fn angle_around(corners: &[BadgePoint], point: Point) -> f64 {
    let direction = |corner: BadgePoint| {
        let corner = corner.map(f64::from);
        (corner[1] - point[1]).atan2(corner[0] - point[0])
    };
    let next = corners.iter().cycle().skip(1);
    let turns = corners.iter().zip(next).map(|(a, b)| {
        let turn = direction(*b) - direction(*a);
        turn - std::f64::consts::TAU * (turn / std::f64::consts::TAU).round()
    });
    turns.sum()
}

fn distance_to_line(points: &[BadgePoint], point: Point) -> f64 {
    let distances = points.windows(2).map(|ends| {
        let [a, b] = [ends[0].map(f64::from), ends[1].map(f64::from)];
        let way = [b[0] - a[0], b[1] - a[1]];
        let along = (point[0] - a[0]) * way[0] + (point[1] - a[1]) * way[1];
        let t = (along / (way[0] * way[0] + way[1] * way[1])).clamp(0.0, 1.0);
        (a[0] + t * way[0] - point[0]).hypot(a[1] + t * way[1] - point[1])
    });
    distances.fold(f64::INFINITY, f64::min)
}

/// Types of colour vision, with one kind of cone missing or none: matrices of Machado, Oliveira and Fernandes
/// (2009) on linear RGB.
pub const KINDS_OF_SIGHT: [(&str, [[f64; 3]; 3]); 4] = [
    ("all cones", [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
    (
        "no long cones",
        [
            [0.152_286, 1.052_583, -0.204_868],
            [0.114_503, 0.786_281, 0.099_216],
            [-0.003_882, -0.048_116, 1.051_998],
        ],
    ),
    (
        "no middle cones",
        [
            [0.367_322, 0.860_646, -0.227_968],
            [0.280_085, 0.672_501, 0.047_413],
            [-0.011_820, 0.042_940, 0.968_881],
        ],
    ),
    (
        "no short cones",
        [
            [1.255_528, -0.076_749, -0.178_779],
            [-0.078_411, 0.930_809, 0.147_602],
            [0.004_733, 0.691_367, 0.303_900],
        ],
    ),
];

/// Converts an sRGB colour to linear RGB.
pub fn to_linear(srgb: [u8; 3]) -> [f64; 3] {
    srgb.map(|c| {
        let c = f64::from(c) / 255.0;
        if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
    })
}

/// Returns the difference of two colours in linear RGB as their distance in CIELAB, where 2 is just
/// noticeable.
pub fn colour_difference(a: [f64; 3], b: [f64; 3]) -> f64 {
    let (a, b) = (to_lab(a), to_lab(b));
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// Returns the product of a matrix and a vector.
pub fn transform(matrix: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row.iter().zip(v).map(|(m, v)| m * v).sum())
}

fn to_lab(linear: [f64; 3]) -> [f64; 3] {
    const TO_XYZ: [[f64; 3]; 3] = [
        [0.4339, 0.3762, 0.1899], // by the white point
        [0.2126, 0.7152, 0.0722],
        [0.0177, 0.1095, 0.8728],
    ];
    let [x, y, z] = transform(&TO_XYZ, linear.map(|c| c.clamp(0.0, 1.0)))
        .map(|t| if t > 0.008_856 { t.cbrt() } else { 7.787 * t + 16.0 / 116.0 });
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}
