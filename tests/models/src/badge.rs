//! Model of the badge's code by its definition: polynomials as lists of coefficients with long division, and
//! the badges at one mistake by enumeration.

use paros_core::badge::{Badge, BadgeColour, Pictogram};

/// The polynomial x^6 + x + 1, the constant first.
const MODULUS: [u8; 7] = [1, 1, 0, 0, 0, 0, 1];

/// Returns the product in GF(64): the product of two polynomials over GF(2), reduced by long division.
pub fn multiply(a: u8, b: u8) -> u8 {
    let coefficients = |bits: u8| (0..6).map(move |i| bits >> i & 1);
    let mut product = [0; 11];
    for (i, x) in coefficients(a).enumerate() {
        for (j, y) in coefficients(b).enumerate() {
            product[i + j] ^= x & y;
        }
    }
    for top in (6..11).rev() {
        if product[top] == 1 {
            (0..7).for_each(|i| product[top - 6 + i] ^= MODULUS[i]);
        }
    }
    assert_eq!(product[6..], [0; 5]);
    (0..6).map(|i| product[i] << i).sum()
}

/// Returns the check sum by its definition; zero for a valid badge.
pub fn sum_check(badge: &Badge) -> u8 {
    let weights = badge.pictograms.iter().zip([1, 2, 4, 8]);
    weights.fold(badge.colour as u8, |sum, (p, weight)| sum ^ multiply(weight, p.number() as u8))
}

/// Returns all badges that differ by one mistake: another pictogram, another colour, or two swapped
/// neighbours. Excludes the badge itself.
pub fn list_mistakes(badge: &Badge) -> Vec<Badge> {
    let mut wrong = Vec::new();
    for place in 0..4 {
        for pictogram in Pictogram::all() {
            let mut pictograms = badge.pictograms;
            pictograms[place] = pictogram;
            wrong.push(Badge { pictograms, ..*badge });
        }
    }
    wrong.extend(BadgeColour::ALL.map(|colour| Badge { colour, ..*badge }));
    for place in 0..3 {
        let mut pictograms = badge.pictograms;
        pictograms.swap(place, place + 1);
        wrong.push(Badge { pictograms, ..*badge });
    }
    wrong.retain(|other| other != badge);
    wrong
}

/// Returns the number of places at which two badges have the same pictogram.
pub fn count_shared(a: &Badge, b: &Badge) -> usize {
    a.pictograms.iter().zip(b.pictograms).filter(|(p, q)| **p == *q).count()
}
