//! Sawing off the block's corners: a level cut at the foot, then upright cuts. The loose piece falls.

use glam::{Mat3, Quat, Vec3};
use paros_core::edit::Pose;
use paros_core::volume::{Grid, Size};

use super::scripted_hands::ScriptedHands;
use super::{RIGHT, direction_at_azimuth};

/// The blade's radius, and half the width of a corner's cut, in units of 1/128 of the block's edge.
const BLADE: f32 = 19.9;
const HALF_WIDTH: f32 = 40.0;

/// The heights of the cuts: of the level one, and of the blade's middle in each upright one, from the top
/// down.
const FOOT: f32 = 5.0;
const UPRIGHT: [f32; 2] = [48.0, 22.0];

/// The speed of the blade, in 1/128 of the block's edge per tick: 0.36 m/s, at which cutting keeps up at 256.
const SAW_SPEED: f32 = 1.42;

/// Saws off the corner at an azimuth, at a distance of `from_axis` from the block's axis, in 1/128 of the
/// block's edge.
pub(super) fn saw_off_corner<const N: usize, const K: usize>(
    hands: &mut ScriptedHands<'_, '_, N, K>,
    degrees_from_z_to_x: f32,
    from_axis: f32,
) where
    Grid<N>: Size,
{
    let out = direction_at_azimuth(degrees_from_z_to_x);
    let aside = Vec3::Y.cross(out);
    let foot = Vec3::new(64.0, 0.0, 64.0);
    hands.turn_azimuth_to_visitor(degrees_from_z_to_x);
    // The level cut: the blade's middle lies outside the later upright cut.
    let level = blade_rotation(Vec3::Y, -out);
    let row = foot + out * (from_axis + BLADE - 3.0) + Vec3::Y * FOOT;
    saw_along(hands, level, [row - aside * HALF_WIDTH, row + aside * HALF_WIDTH]);
    let upright = blade_rotation(out, -aside);
    let mut way = [-aside * HALF_WIDTH, aside * HALF_WIDTH];
    for height in UPRIGHT {
        let row = foot + out * from_axis + Vec3::Y * height;
        saw_along(hands, upright, way.map(|end| row + end));
        way.reverse();
    }
    hands.move_hand_to_rest(RIGHT);
}

/// Returns the rotation of a blade with a normal, held in a hand that points in a direction across the
/// normal.
fn blade_rotation(normal: Vec3, pointing: Vec3) -> Quat {
    Quat::from_mat3(&Mat3::from_cols(normal, normal.cross(pointing), -pointing))
}

/// Saws from one point to another. Begins and ends clear of the stone. Points are in 1/128 of the block's
/// edge.
fn saw_along<const N: usize, const K: usize>(
    hands: &mut ScriptedHands<'_, '_, N, K>,
    rotation: Quat,
    [from, to]: [Vec3; 2],
) where
    Grid<N>: Size,
{
    let unit = N as f32 / 128.0;
    let way = (to - from).normalize();
    let [clear, end] = [from - way * (0.6 * BLADE), to + way * (0.6 * BLADE)];
    hands.move_bit_to_pose(RIGHT, &Pose { position: clear * unit, rotation });
    hands.stroke_through(RIGHT, [Pose { position: end * unit, rotation }], SAW_SPEED * unit);
    hands.release_trigger(RIGHT);
}
