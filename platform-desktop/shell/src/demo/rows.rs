//! Roughing in rows over the visible stone: a hand strokes a side back and forth and presses, as people
//! remove stone.

use glam::Vec3;
use paros_core::edit::Pose;
use paros_core::volume::{Axis, Grid, Size};

use super::scripted_hands::{ScriptedHands, pose_pointing};
use super::surface_pass::STROKE_SPEED;
use super::{RIGHT, SIDES, direction_at_azimuth, evenly_spaced};

/// The parameters of a pass over a side. Lengths are in 1/128 of the block's edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct RowPass {
    /// The radius of the ball.
    pub(super) radius: f32,
    /// The distance between rows.
    pub(super) spacing: f32,
    /// The depth to which the ball is pressed into the visible stone.
    pub(super) press: f32,
}

/// A side of the stone, from which a hand looks along an axis.
#[derive(Clone, Copy, Debug)]
struct Side {
    axis: Axis,
    /// The direction into the stone.
    inward: Vec3,
}

/// Strokes the four sides, each turned to the visitor, and the top.
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

/// Strokes a side in rows, back and forth: level rows from the top down, or the top from its back to its
/// front.
fn stroke_side<const N: usize, const K: usize>(
    hands: &mut ScriptedHands<'_, '_, N, K>,
    side: Side,
    pass: RowPass,
) where
    Grid<N>: Size,
{
    for (row, aside) in evenly_spaced(126.0, 2.0, -pass.spacing).enumerate() {
        // In steps of two ticks' distance.
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
            // Each pose sees what the stroke has removed so far.
            if let Some(pose) = pose_on_stone(hands, side, across(at), pass) {
                hands.stroke_through(RIGHT, [pose], STROKE_SPEED * N as f32 / 128.0);
            }
        }
    }
    hands.release_trigger(RIGHT);
    hands.move_hand_to_rest(RIGHT);
}

/// Returns the pose in which the ball presses into the visible stone at a place across a side; `None` if
/// there is no stone, or its surface is so oblique that a person would turn the stone first.
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
    // The point is no lower than the stool allows.
    let point = point.with_y(point.y.max(0.3 * pass.radius));
    Some(pose_pointing(point * (N as f32 / 128.0), side.inward))
}

/// Returns the height of the stone against the view direction, from the grid's origin; `None` if there is
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
