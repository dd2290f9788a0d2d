//! Rows over what is seen of the stone: a hand that strokes a side to and fro, pressing, as people take stone off.

use glam::Vec3;
use paros_core::edit::Pose;
use paros_core::volume::{Axis, Grid, Size};

use super::scripted_hands::{ScriptedHands, pose_pointing};
use super::surface_pass::STROKE_SPEED;
use super::{RIGHT, SIDES, direction_at_azimuth, evenly_spaced};

/// How a side is stroked. Lengths are in 1/128 of the block's edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct RowPass {
    /// Of the ball.
    pub(super) radius: f32,
    /// Between rows.
    pub(super) spacing: f32,
    /// How far the ball is pressed into what is seen.
    pub(super) press: f32,
}

/// A side of the stone, from which a hand looks along an axis.
#[derive(Clone, Copy, Debug)]
struct Side {
    axis: Axis,
    /// Into the stone.
    inward: Vec3,
}

/// Strokes the four sides, turned to the visitor one after the other, and the top.
pub(super) fn stroke_all_sides<const N: usize, const K: usize>(
    hands: &mut ScriptedHands<'_, '_, N, K>,
    pass: RowPass,
) where
    Grid<N>: Size,
{
    for degrees in SIDES {
        hands.turn_azimuth_to_visitor(degrees);
        let axis = if degrees % 180.0 == 0.0 { Axis::Z } else { Axis::X };
        stroke_side(hands, Side { axis, inward: -direction_at_azimuth(degrees) }, pass);
    }
    stroke_side(hands, Side { axis: Axis::Y, inward: Vec3::NEG_Y }, pass);
}

/// Strokes a side in rows, to and fro: level ones from the top down, or the top from its back to its front.
fn stroke_side<const N: usize, const K: usize>(
    hands: &mut ScriptedHands<'_, '_, N, K>,
    side: Side,
    pass: RowPass,
) where
    Grid<N>: Size,
{
    for (row, aside) in evenly_spaced(126.0, 2.0, -pass.spacing).enumerate() {
        // Two ticks' way.
        let mut along: Vec<f32> = evenly_spaced(0.0, 128.0, 2.0 * STROKE_SPEED).collect();
        if row % 2 == 1 {
            along.reverse();
        }
        let across = |along: f32| match side.axis {
            Axis::X => Vec3::new(0.0, aside, along),
            Axis::Y => Vec3::new(along, 0.0, 128.0 - aside),
            Axis::Z => Vec3::new(along, aside, 0.0),
        };
        for at in along {
            // What the stroke took is seen at once.
            if let Some(pose) = pose_on_stone(hands, side, across(at), pass) {
                hands.stroke_through(RIGHT, [pose], STROKE_SPEED * N as f32 / 128.0);
            }
        }
    }
    hands.release_trigger(RIGHT);
    hands.move_hand_to_rest(RIGHT);
}

/// Where the ball is pressed into what is seen of the stone at a place across a side; `None` where there is none, or
/// where it is seen so much aslant that one would turn the stone first.
fn pose_on_stone<const N: usize, const K: usize>(
    hands: &ScriptedHands<'_, '_, N, K>,
    side: Side,
    across: Vec3,
    pass: RowPass,
) -> Option<Pose>
where
    Grid<N>: Size,
{
    let reach = 0.7 * pass.radius;
    let axes = [Vec3::X, Vec3::Y, Vec3::Z];
    let [u, v] = [1, 2].map(|i| axes[(side.axis as usize + i) % 3] * reach);
    let around = [u, -u, v, -v].map(|by| height_at(hands, side, across + by));
    let height = height_at(hands, side, across)?;
    let faces = |pair: &[Option<f32>]| match *pair {
        [Some(a), Some(b)] => (a - b).abs() < 3.0 * reach,
        _ => false,
    };
    if !around.chunks(2).all(faces) {
        return None;
    }
    let height = around.into_iter().flatten().fold(height, f32::max) + pass.radius - pass.press;
    let point = across - side.inward * height;
    // No deeper than the stool allows.
    let point = point.with_y(point.y.max(0.3 * pass.radius));
    Some(pose_pointing(point * (N as f32 / 128.0), side.inward))
}

/// How far the stone reaches against the way in which the hand looks, from the grid's origin; `None` where there is
/// none.
fn height_at<const N: usize, const K: usize>(
    hands: &ScriptedHands<'_, '_, N, K>,
    side: Side,
    across: Vec3,
) -> Option<f32>
where
    Grid<N>: Size,
{
    let unit = N as f32 / 128.0;
    let voxel = across.to_array().map(|at| ((at * unit).max(0.0) as usize).min(N - 1));
    let address = side.axis.column_address(voxel);
    let hull = hands.world().volume().maps().column(side.axis, address).hull();
    let is_from_above = side.inward.element_sum() < 0.0;
    let voxels = if is_from_above { (hull.last() + 1) as f32 } else { -(hull.first() as f32) };
    (!hull.is_empty()).then_some(voxels / unit)
}
