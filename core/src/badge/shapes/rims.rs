//! The rims of the eight colours, along the upper edge of the square: bar, dots, dashes, zigzag, two bars,
//! teeth, comb, dashes and dots.

use super::{BadgePart, disc, line, polygon};

/// The rims, in the order of the colours' numbers.
pub(super) const RIMS: [&[BadgePart]; 8] =
    [BAR, DOTS, DASHES, ZIGZAG, TWO_BARS, TEETH, COMB, DASHES_AND_DOTS];

const BAR: &[BadgePart] = &[polygon(&[[0, 0], [64, 0], [64, 5], [0, 5]])];

const DOTS: &[BadgePart] = &[
    disc(3, 3, 2),
    disc(11, 3, 2),
    disc(20, 3, 2),
    disc(28, 3, 2),
    disc(36, 3, 2),
    disc(44, 3, 2),
    disc(53, 3, 2),
    disc(61, 3, 2),
];

const DASHES: &[BadgePart] = &[
    polygon(&[[0, 0], [9, 0], [9, 5], [0, 5]]),
    polygon(&[[18, 0], [28, 0], [28, 5], [18, 5]]),
    polygon(&[[36, 0], [46, 0], [46, 5], [36, 5]]),
    polygon(&[[55, 0], [64, 0], [64, 5], [55, 5]]),
];

const ZIGZAG: &[BadgePart] = &[line(
    2,
    &[
        [1, 1],
        [5, 5],
        [9, 1],
        [13, 5],
        [17, 1],
        [21, 5],
        [25, 1],
        [29, 5],
        [32, 1],
        [35, 5],
        [39, 1],
        [43, 5],
        [47, 1],
        [51, 5],
        [55, 1],
        [59, 5],
        [63, 1],
    ],
)];

const TWO_BARS: &[BadgePart] =
    &[polygon(&[[0, 0], [64, 0], [64, 2], [0, 2]]), polygon(&[[4, 4], [60, 4], [60, 6], [4, 6]])];

const TEETH: &[BadgePart] = &[
    polygon(&[[0, 0], [12, 0], [6, 6]]),
    polygon(&[[13, 0], [25, 0], [19, 6]]),
    polygon(&[[26, 0], [38, 0], [32, 6]]),
    polygon(&[[39, 0], [51, 0], [45, 6]]),
    polygon(&[[52, 0], [64, 0], [58, 6]]),
];

const COMB: &[BadgePart] = &[
    polygon(&[[0, 0], [64, 0], [64, 1], [0, 1]]),
    line(2, &[[7, 1], [7, 6]]),
    line(2, &[[17, 1], [17, 6]]),
    line(2, &[[27, 1], [27, 6]]),
    line(2, &[[37, 1], [37, 6]]),
    line(2, &[[47, 1], [47, 6]]),
    line(2, &[[57, 1], [57, 6]]),
];

const DASHES_AND_DOTS: &[BadgePart] = &[
    polygon(&[[0, 0], [6, 0], [6, 5], [0, 5]]),
    disc(14, 3, 2),
    polygon(&[[22, 0], [42, 0], [42, 5], [22, 5]]),
    disc(50, 3, 2),
    polygon(&[[58, 0], [64, 0], [64, 5], [58, 5]]),
];
