//! The owl demo: it is sawn, roughed and chiselled out of the block down to the figure's own surface; then it
//! gets a cord of paste.

use glam::Vec3;
use paros_core::edit::Pose;
use paros_core::session::{BenchItem, Tool, ToolBit, commands};
use paros_core::volume::{Grid, Size};

use super::faces::Face;
use super::rows::{RowPass, stroke_all_sides};
use super::saw::saw_off_corner;
use super::scripted_hands::{ScriptedHands, pose_pointing};
use super::surface_pass::{BitTip, STROKE_SPEED, SurfacePass, depth_at, work_face};
use super::{Chapter, RIGHT, SIDES};
use crate::figures::{Figure, HiddenStart, StoneThickness};

/// The start: the owl in stone of half thickness.
const STONE: HiddenStart = HiddenStart { figure: Figure::Owl, thickness: StoneThickness::Half };

/// The azimuths of the block's corners.
const CORNERS: [f32; 4] = [45.0, 135.0, 225.0, 315.0];

/// The distance from the block's axis at which its corners are sawn off, in 1/128 of its edge: clear of the
/// owl.
const CORNER_CUT: f32 = 52.0;

/// The roughing pass, which removes most of the stone.
const ROUGH: RowPass = RowPass { radius: 11.4, spacing: 17.0, press: 10.0 };

/// The pass down to the owl, which presses deep.
const LARGE: RowPass = RowPass { radius: 6.8, spacing: 10.2, press: 9.1 };

/// The pass over what the large ball left in the hollows.
const MEDIUM: RowPass = RowPass { radius: 4.27, spacing: 8.5, press: 6.8 };

/// The chisel's pass over the breast's feathers.
const CHISEL: SurfacePass = SurfacePass {
    tip: BitTip::Box { half_width: 2.0, half_length: 5.7 },
    spacing: 5.0,
    off: -0.4,
    least: 0.8,
    half_width: 25.0,
    speed: 1.1,
};

/// The pass over what the medium ball left.
const SMALL: SurfacePass = SurfacePass {
    tip: BitTip::Ball(2.56),
    spacing: 5.0,
    off: -0.4,
    least: 0.6,
    half_width: 49.0,
    speed: STROKE_SPEED,
};

/// Carves the hidden owl out of the block.
pub(super) fn carve_owl<const N: usize, const K: usize>(
    hands: &mut ScriptedHands<'_, '_, N, K>,
    mut done: impl FnMut(Chapter, &ScriptedHands<'_, '_, N, K>),
) where
    Grid<N>: Size,
{
    hands.start_session(STONE.mode());
    done(Chapter::Stone, hands);
    hands.fetch_item(RIGHT, BenchItem::Tool(Tool::Rotary));
    hands.fetch_item(RIGHT, BenchItem::Bit(ToolBit::DiscSaw));
    for degrees in CORNERS {
        saw_off_corner(hands, degrees, CORNER_CUT);
    }
    done(Chapter::Sawn, hands);

    rough_out(hands, &mut done);
    work_finer(hands, &mut done);

    hands.fetch_item(RIGHT, BenchItem::Tool(Tool::FillGun));
    place_paste_spiral(hands);
    done(Chapter::Mishap, hands);
    hands.send_commands(commands::UNDO);
    done(Chapter::Undone, hands);
    lay_cord(hands);
    done(Chapter::Cord, hands);
    rasp_cord(hands);
    hands.wait_ticks(36);
    hands.send_commands(commands::FINISH);
    done(Chapter::Finished, hands);
}

/// Removes the stone down to the owl, on all sides.
fn rough_out<const N: usize, const K: usize>(
    hands: &mut ScriptedHands<'_, '_, N, K>,
    done: &mut impl FnMut(Chapter, &ScriptedHands<'_, '_, N, K>),
) where
    Grid<N>: Size,
{
    hands.fetch_item(RIGHT, BenchItem::Bit(ToolBit::RoughingBall));
    stroke_all_sides(hands, ROUGH);
    done(Chapter::Rough, hands);
    hands.fetch_item(RIGHT, BenchItem::Bit(ToolBit::LargeBall));
    stroke_all_sides(hands, LARGE);
    done(Chapter::Bared, hands);
}

/// Works out the owl's hollows.
fn work_finer<const N: usize, const K: usize>(
    hands: &mut ScriptedHands<'_, '_, N, K>,
    done: &mut impl FnMut(Chapter, &ScriptedHands<'_, '_, N, K>),
) where
    Grid<N>: Size,
{
    hands.fetch_item(RIGHT, BenchItem::Bit(ToolBit::MediumBall));
    stroke_all_sides(hands, MEDIUM);
    hands.fetch_item(RIGHT, BenchItem::Tool(Tool::Impact));
    hands.turn_azimuth_to_visitor(0.0);
    work_face(hands, &Face::side(0.0), CHISEL);
    hands.fetch_item(RIGHT, BenchItem::Tool(Tool::Rotary));
    hands.fetch_item(RIGHT, BenchItem::Bit(ToolBit::SmallBall));
    for degrees in SIDES.into_iter().chain(CORNERS) {
        hands.turn_azimuth_to_visitor(degrees);
        work_face(hands, &Face::side(degrees), SMALL);
    }
    work_face(hands, &Face::top(), SMALL);
    done(Chapter::Fine, hands);
}

/// Lays a cord of paste round the neck, as the stool turns under the gun.
fn lay_cord<const N: usize, const K: usize>(hands: &mut ScriptedHands<'_, '_, N, K>)
where
    Grid<N>: Size,
{
    let unit = N as f32 / 128.0;
    // Moves out over the edge first: on the straight path down from the spiral the head would catch the
    // nozzle.
    hands.move_bit_to(RIGHT, Vec3::new(64.0, 140.0, 162.0) * unit, Vec3::NEG_Y);
    hands.resize_bit(RIGHT, NOZZLE_STEPS);
    hands.turn_azimuth_to_visitor(0.0);
    hold_to_neck(hands, 255, 0.2);
    hands.move_hand_to_rest(RIGHT);
}

/// Smooths the cord.
fn rasp_cord<const N: usize, const K: usize>(hands: &mut ScriptedHands<'_, '_, N, K>)
where
    Grid<N>: Size,
{
    hands.fetch_item(RIGHT, BenchItem::Tool(Tool::Rasp));
    hands.turn_azimuth_to_visitor(0.0);
    hold_to_neck(hands, 150, 6.0);
    hands.move_hand_to_rest(RIGHT);
}

/// The height of the cord's middle, in 1/128 of the block's edge.
const NECK: f32 = 65.0;

/// The paste's nozzle, two steps smaller than its first size, so that it fits on the shoulders, under the
/// beak.
const NOZZLE: BitTip = BitTip::Ball(2.42);
const NOZZLE_STEPS: i8 = -2;

/// Holds a running tool to the neck while the stool turns once, at a distance at which a nozzle leaves `gap`,
/// in 1/128 of the block's edge.
fn hold_to_neck<const N: usize, const K: usize>(
    hands: &mut ScriptedHands<'_, '_, N, K>,
    trigger: u8,
    gap: f32,
) where
    Grid<N>: Size,
{
    let unit = N as f32 / 128.0;
    let pose_at = |hands: &ScriptedHands<'_, '_, N, K>, degrees: f32| -> Option<Pose> {
        let face = Face::side(degrees);
        let depth = depth_at(hands, &face, NOZZLE, (-NECK, 0.0))?;
        let point = face.point(-NECK, 0.0) + face.inward * (depth.work - gap);
        Some(pose_pointing(point * unit, face.inward))
    };
    if let Some(pose) = pose_at(hands, 0.0) {
        hands.move_bit_to(RIGHT, pose.position + Vec3::Z * (40.0 * unit), Vec3::NEG_Z);
        hands.move_bit_to_pose(RIGHT, &pose);
        hands.turn_once_under_tool(RIGHT, trigger, pose_at);
        hands.release_trigger(RIGHT);
        let front = Face::side(0.0).point(-NECK, 0.0) * unit;
        hands.move_bit_to(RIGHT, front, Vec3::NEG_Z);
    }
}

/// Draws a spiral of paste on top.
fn place_paste_spiral<const N: usize, const K: usize>(hands: &mut ScriptedHands<'_, '_, N, K>)
where
    Grid<N>: Size,
{
    let unit = N as f32 / 128.0;
    hands.turn_azimuth_to_visitor(0.0);
    let start = Vec3::new(64.0, 140.0, 64.0) * unit;
    let Some(stone) = hands.cast_ray_to_stone_and_mask(start, Vec3::NEG_Y).stone else { return };
    let touch = start + Vec3::NEG_Y * (stone - 2.0 * unit);
    hands.move_bit_to(RIGHT, touch + Vec3::Y * (10.0 * unit), Vec3::NEG_Y);
    let swirl = (0..90).map(|i| {
        let angle = 0.25 * i as f32;
        let radius = (2.0 + 0.08 * i as f32) * unit;
        touch
            + Vec3::new(
                libm::sinf(angle) * radius,
                0.06 * i as f32 * unit,
                libm::cosf(angle) * radius,
            )
    });
    let poses = swirl.map(|point| pose_pointing(point, Vec3::NEG_Y));
    hands.stroke_through(RIGHT, poses, STROKE_SPEED * unit);
    hands.release_trigger(RIGHT);
    hands.move_bit_to(RIGHT, start, Vec3::NEG_Y);
}
