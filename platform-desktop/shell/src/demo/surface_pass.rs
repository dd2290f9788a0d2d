//! Passes over a face: strokes along the hidden figure, strip by strip, where there is stone to remove.

use paros_core::volume::{Grid, Size};

use super::faces::Face;
use super::scripted_hands::{ScriptedHands, StoneAndMaskDistances, pose_pointing};
use super::{RIGHT, evenly_spaced};

/// The working end of a bit. Lengths are in 1/128 of the block's edge.
#[derive(Clone, Copy, Debug)]
pub(super) enum BitTip {
    /// A ball of this radius.
    Ball(f32),
    /// A box that is twice `half_width` wide, and whose end lies `half_length` beyond its centre.
    Box {
        /// Half the width across the pointing direction.
        half_width: f32,
        /// Half the length along the pointing direction.
        half_length: f32,
    },
}

/// A pass of a bit over a face. Lengths are in 1/128 of the block's edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct SurfacePass {
    /// The bit's end.
    pub(super) tip: BitTip,
    /// The distance between strips.
    pub(super) spacing: f32,
    /// The distance of the bit from the figure; if negative, the bit presses on it.
    pub(super) off: f32,
    /// The least depth of stone that is worth a stroke.
    pub(super) least: f32,
    /// The distance to which strips reach on either side of the face's middle.
    pub(super) half_width: f32,
    /// The distance that the bit moves in a tick.
    pub(super) speed: f32,
}

/// The speed of a person's hand in stone, in 1/128 of the block's edge per tick: 0.55 m/s.
pub(super) const STROKE_SPEED: f32 = 2.17;

/// Depths of the bit at a place of a face, measured inwards from the face's plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Depth {
    /// The depth at which the bit touches the figure, or to which the face is worked.
    pub(super) work: f32,
    /// The depth at which the bit touches stone.
    pub(super) stone: f32,
}

impl Depth {
    /// Returns the depths of a bit that stays `off` the figure.
    fn less(self, off: f32) -> Depth {
        Depth { work: self.work - off, ..self }
    }
}

impl BitTip {
    /// Returns the reach of the bit beyond its centre, at a distance from its axis within its half width.
    fn reach_at(self, from_axis: f32) -> f32 {
        match self {
            BitTip::Ball(radius) => libm::sqrtf((radius * radius - from_axis * from_axis).max(0.0)),
            BitTip::Box { half_length, .. } => half_length,
        }
    }

    /// Returns half its width.
    const fn half_width(self) -> f32 {
        match self {
            BitTip::Ball(radius) => radius,
            BitTip::Box { half_width, .. } => half_width,
        }
    }
}

/// Works a face in strips, back and forth.
pub(super) fn work_face<const N: usize, const K: usize>(
    hands: &mut ScriptedHands<'_, '_, N, K>,
    face: &Face,
    pass: SurfacePass,
) where
    Grid<N>: Size,
{
    let strips = evenly_spaced(-pass.half_width, pass.half_width, pass.spacing);
    for (number, aside) in strips.enumerate() {
        work_strip(hands, face, pass, aside, number % 2 == 1);
    }
    hands.move_hand_to_rest(RIGHT);
}

/// Works the parts of a strip that have stone in the bit's way.
fn work_strip<const N: usize, const K: usize>(
    hands: &mut ScriptedHands<'_, '_, N, K>,
    face: &Face,
    pass: SurfacePass,
    aside: f32,
    is_backward: bool,
) where
    Grid<N>: Size,
{
    // Parts closer than this, in steps, are joined: moving out and in again takes as long.
    const GAP: usize = 10;
    let [first, last] = face.strip;
    let is_work = |place: &(f32, Option<Depth>)| {
        place.1.is_some_and(|depth| depth.stone + pass.least < depth.work)
    };
    let mut places: Vec<(f32, Option<Depth>)> = evenly_spaced(first, last, pass.speed)
        .map(|along| (along, depth_at(hands, face, pass.tip, (along, aside))))
        .map(|(along, depth)| (along, depth.map(|depth| depth.less(pass.off))))
        .collect();
    if is_backward {
        places.reverse();
    }
    let mut rest = &places[..];
    while let Some(begin) = rest.iter().position(is_work) {
        let mut end = begin;
        while let Some(next) = rest[end + 1..].iter().take(GAP).position(is_work) {
            end += 1 + next;
        }
        stroke_part(hands, face, pass, aside, &rest[begin..=end]);
        rest = &rest[end + 1..];
    }
}

/// Moves the bit in from outside, along a part of a strip, and out again.
fn stroke_part<const N: usize, const K: usize>(
    hands: &mut ScriptedHands<'_, '_, N, K>,
    face: &Face,
    pass: SurfacePass,
    aside: f32,
    places: &[(f32, Option<Depth>)],
) where
    Grid<N>: Size,
{
    let unit = N as f32 / 128.0;
    let at = |along: f32, depth: f32| (face.point(along, aside) + face.inward * depth) * unit;
    let way: Vec<(f32, Depth)> =
        places.iter().filter_map(|&(along, depth)| Some((along, depth?))).collect();
    let (Some(&(first, entry)), Some(&(last, _))) = (way.first(), way.last()) else { return };
    let clear = (entry.stone - 3.0).max(0.0);
    hands.move_bit_to(RIGHT, at(first, 0.0), face.inward);
    hands.move_bit_to(RIGHT, at(first, clear), face.inward);
    let poses = way.iter().map(|&(along, depth)| pose_pointing(at(along, depth.work), face.inward));
    hands.stroke_through(RIGHT, poses, pass.speed * unit);
    // The trigger stays down until the bit is out: a bit that is switched off could stick in a curved hole.
    hands.move_bit_to(RIGHT, at(last, 0.0), face.inward);
    hands.release_trigger(RIGHT);
}

/// The points at which the bit's contact is tested, in half widths of the bit.
const LOOKS: [(f32, f32); 13] = [
    (0.0, 0.0),
    (0.5, 0.0),
    (0.0, 0.5),
    (-0.5, 0.0),
    (0.0, -0.5),
    (0.9, 0.0),
    (0.0, 0.9),
    (-0.9, 0.0),
    (0.0, -0.9),
    (0.63, 0.63),
    (-0.63, 0.63),
    (0.63, -0.63),
    (-0.63, -0.63),
];

/// Returns the depths at which a bit's tip touches figure and stone at a place of a face, given along the
/// face and aside; `None` if it meets no stone.
pub(super) fn depth_at<const N: usize, const K: usize>(
    hands: &ScriptedHands<'_, '_, N, K>,
    face: &Face,
    tip: BitTip,
    (along, aside): (f32, f32),
) -> Option<Depth>
where
    Grid<N>: Size,
{
    let unit = N as f32 / 128.0;
    let wide = tip.half_width();
    let mut depth = Depth { work: face.deepest, stone: f32::MAX };
    for (u, v) in LOOKS {
        let shift = (face.along * u + face.aside * v) * wide;
        let reach = tip.reach_at(shift.length());
        let start = (face.point(along, aside) + shift) * unit;
        let StoneAndMaskDistances { stone, mask } =
            hands.cast_ray_to_stone_and_mask(start, face.inward);
        depth.work = mask.map_or(depth.work, |mask| depth.work.min(mask / unit - reach));
        depth.stone = stone.map_or(depth.stone, |stone| depth.stone.min(stone / unit - reach));
    }
    (depth.stone < f32::MAX).then_some(depth)
}
