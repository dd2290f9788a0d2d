//! Badges as SVG, from the same shapes that headsets draw.

use std::fmt::Write as _;

use maud::{Markup, PreEscaped, html};
use paros_core::badge::{
    Badge, BadgeColour, BadgePart, BadgeShape, Language, Pictogram, write_words,
};

/// Draws a badge and its words, the same on all pages: a square as the headset shows it, with the pictograms
/// in two rows. The pattern of the rim stands for the colour, for people who can't see it.
pub(crate) fn draw_badge(badge: &Badge, language: Language) -> Markup {
    let (ground, ink) = (hex(badge.colour.ground()), hex(badge.colour.ink()));
    let words = words_of(badge, language);
    html! {
        figure class="badge" {
            svg viewBox="0 0 176 176" role="img" aria-label=(words) {
                rect width="176" height="176" rx="4" fill=(ground) {}
                g transform="translate(4 4) scale(2.625)" { (PreEscaped(draw_rim(badge.colour))) }
                @for (k, pictogram) in badge.pictograms.iter().enumerate() {
                    g transform=(format!("translate({} {}) scale(.875)", 29 + 62 * (k % 2), 29 + 62 * (k / 2))) {
                        (PreEscaped(draw_parts(pictogram.parts(), &ink, &ground)))
                    }
                }
            }
            figcaption aria-hidden="true" { (words) }
        }
    }
}

fn words_of(badge: &Badge, language: Language) -> String {
    let mut words = String::new();
    // Writing to a String doesn't fail.
    let _ = write_words(&mut words, badge, language);
    words
}

/// Draws a pictogram in black on white.
pub(crate) fn draw_pictogram(pictogram: Pictogram) -> Markup {
    let parts = draw_parts(pictogram.parts(), "#000000", "#ffffff");
    html! { svg viewBox="0 0 64 64" aria-hidden="true" { (PreEscaped(parts)) } }
}

/// Draws a square of a colour with its rim.
pub(crate) fn draw_colour(colour: BadgeColour) -> Markup {
    html! {
        svg viewBox="-4 -4 72 72" aria-hidden="true" {
            rect x="-3" y="-3" width="70" height="70" rx="8" fill=(hex(colour.ground())) stroke="#000000" {}
            (PreEscaped(draw_rim(colour)))
        }
    }
}

/// Draws a colour's rim around the unit square: its upper edge, and three rotations of it.
fn draw_rim(colour: BadgeColour) -> String {
    let edge = draw_parts(colour.rim(), &hex(colour.ink()), &hex(colour.ground()));
    let turned = |turn| format!("<g transform=\"rotate({} 32 32)\">{edge}</g>", 90 * turn);
    (0..4).map(turned).collect()
}

/// Draws shapes one over the other; holes have the ground's colour. The SVG contains only the program's own
/// numbers.
fn draw_parts(parts: &[BadgePart], ink: &str, ground: &str) -> String {
    let mut svg = String::new();
    for BadgePart { shape, is_hole } in parts {
        let colour = if *is_hole { ground } else { ink };
        let _ = match shape {
            BadgeShape::Polygon(points) => {
                write!(svg, "<polygon fill=\"{colour}\" points=\"{}\"/>", join(points))
            }
            BadgeShape::Ellipse { centre: [x, y], radii: [rx, ry] } => {
                write!(
                    svg,
                    "<ellipse fill=\"{colour}\" cx=\"{x}\" cy=\"{y}\" rx=\"{rx}\" ry=\"{ry}\"/>"
                )
            }
            BadgeShape::Line { points, width } => write!(
                svg,
                "<polyline fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\" \
                 stroke-linecap=\"round\" stroke-linejoin=\"round\" points=\"{}\"/>",
                join(points)
            ),
        };
    }
    svg
}

fn join(points: &[[i8; 2]]) -> String {
    let points: Vec<String> = points.iter().map(|[x, y]| format!("{x},{y}")).collect();
    points.join(" ")
}

fn hex([red, green, blue]: [u8; 3]) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}
