//! Signs: tick, cross, plus, back, undo, turn, clock, hourglass, warning, battery, recentre, lock, put back.

use super::{BadgePoint, IconRow, cut, disc, line, polygon};

/// A closed ring of a radius of 25 around the middle.
const RING: &[BadgePoint] = &[
    [57, 32],
    [54, 45],
    [45, 54],
    [32, 57],
    [19, 54],
    [10, 45],
    [7, 32],
    [10, 19],
    [19, 10],
    [32, 7],
    [45, 10],
    [54, 19],
    [57, 32],
];

/// The signs, in the order of their variants.
pub(super) const SIGNS: &[IconRow] = &[
    ("Tick", "A tick: done, or yes.", &[line(9, &[[9, 34], [25, 50], [55, 16]])]),
    (
        "Cross",
        "A cross: no, or away.",
        &[line(9, &[[14, 14], [50, 50]]), line(9, &[[50, 14], [14, 50]])],
    ),
    ("Plus", "A plus: more.", &[line(9, &[[32, 12], [32, 52]]), line(9, &[[12, 32], [52, 32]])]),
    ("Back", "An angle to the left: back.", &[line(9, &[[40, 10], [18, 32], [40, 54]])]),
    (
        "Undo",
        "An arrow that turns back.",
        &[
            line(7, &[[16, 22], [40, 22], [50, 26], [55, 36], [50, 46], [40, 50], [20, 50]]),
            polygon(&[[3, 22], [23, 6], [23, 38]]),
        ],
    ),
    (
        "Turn",
        "An arrow around: turn, or again.",
        &[
            line(
                7,
                &[
                    [54, 40],
                    [46, 51],
                    [32, 56],
                    [19, 52],
                    [10, 42],
                    [8, 30],
                    [13, 18],
                    [23, 10],
                    [35, 9],
                ],
            ),
            polygon(&[[34, -3], [54, 12], [33, 24]]),
        ],
    ),
    ("Clock", "A clock.", &[line(6, RING), line(5, &[[32, 17], [32, 33], [43, 39]])]),
    (
        "Hourglass",
        "An hourglass.",
        &[
            line(6, &[[12, 6], [52, 6]]),
            line(6, &[[12, 58], [52, 58]]),
            polygon(&[
                [16, 8],
                [48, 8],
                [48, 16],
                [36, 32],
                [48, 48],
                [48, 56],
                [16, 56],
                [16, 48],
                [28, 32],
                [16, 16],
            ]),
            cut(polygon(&[[22, 11], [42, 11], [42, 15], [39, 19], [25, 19], [22, 15]])),
            cut(polygon(&[[32, 36], [41, 48], [23, 48]])),
        ],
    ),
    (
        "Warning",
        "A warning triangle.",
        &[
            polygon(&[[32, 5], [62, 58], [2, 58]]),
            cut(line(6, &[[32, 24], [32, 39]])),
            cut(disc(32, 49, 4)),
        ],
    ),
    (
        "Battery",
        "A battery that is charged.",
        &[
            polygon(&[[3, 17], [55, 17], [55, 47], [3, 47]]),
            cut(polygon(&[[8, 22], [50, 22], [50, 42], [8, 42]])),
            polygon(&[[57, 26], [62, 26], [62, 38], [57, 38]]),
            polygon(&[[32, 20], [17, 34], [27, 34], [25, 44], [41, 30], [31, 30]]),
        ],
    ),
    (
        "Recentre",
        "A ring with a cross of hairs.",
        &[
            disc(32, 32, 21),
            cut(disc(32, 32, 15)),
            line(5, &[[32, 4], [32, 20]]),
            line(5, &[[32, 44], [32, 60]]),
            line(5, &[[4, 32], [20, 32]]),
            line(5, &[[44, 32], [60, 32]]),
            disc(32, 32, 4),
        ],
    ),
    (
        "Lock",
        "A lock: for the staff.",
        &[
            line(6, &[[19, 30], [19, 18], [24, 9], [32, 6], [40, 9], [45, 18], [45, 30]]),
            polygon(&[[10, 29], [54, 29], [54, 61], [10, 61]]),
            cut(disc(32, 42, 5)),
            cut(line(4, &[[32, 42], [32, 52]])),
        ],
    ),
    (
        "PutBack",
        "An arrow into a tray.",
        &[
            line(8, &[[32, 5], [32, 32]]),
            polygon(&[[16, 29], [48, 29], [32, 48]]),
            line(6, &[[6, 40], [6, 59], [58, 59], [58, 40]]),
        ],
    ),
];
