//! The demos: scripted sessions, from the lump to the figure hidden in it, and to a lantern.
//!
//! The script reads the world, its volume and contacts, and answers with tick inputs. It has no other
//! state and no clock, so its digests are the same on every machine.

mod lantern;
mod script;
pub mod scripted_hands;

use crate::tick_runner::TickRunner;
use glam::Vec3;
use paros_core::session::{BenchItem, SessionMode, Tool, ToolBit, commands};
use paros_core::volume::{Axis, Column, Grid, Size};

pub use script::{Chapter, DemoScript};
pub use scripted_hands::TickWatcher;
use scripted_hands::{ScriptedHands, StoneAndMaskDistances};

/// The owl's index among the hidden figures.
const OWL: u8 = 0;

/// The right hand does the work; the left turns the stool.
const RIGHT: usize = 1;

/// Plays a session. Calls `watcher` after every tick and `after_chapter` at the end of every chapter.
pub fn play_demo<const N: usize, const K: usize>(
    script: DemoScript,
    runner: &mut TickRunner<'_, N, K>,
    watcher: &mut TickWatcher<'_, N, K>,
    mut after_chapter: impl FnMut(Chapter, &paros_core::World<N, K>),
) where
    Grid<N>: Size,
{
    let mut hands = ScriptedHands::new(runner, watcher);
    let done = |chapter, hands: &ScriptedHands<'_, '_, N, K>| after_chapter(chapter, hands.world());
    match script {
        DemoScript::Owl => carve_owl(&mut hands, done),
        DemoScript::Lantern => lantern::carve_lantern(&mut hands, done),
    }
}

/// Carves the hidden owl out of the lump.
fn carve_owl<const N: usize, const K: usize>(
    hands: &mut ScriptedHands<'_, '_, N, K>,
    mut done: impl FnMut(Chapter, &ScriptedHands<'_, '_, N, K>),
) where
    Grid<N>: Size,
{
    hands.start_session(SessionMode::Constrained { figure: OWL });
    done(Chapter::Stone, hands);

    hands.fetch_item(RIGHT, BenchItem::Tool(Tool::Rotary));
    saw_off_edge(hands);
    done(Chapter::Edge, hands);

    hands.fetch_item(RIGHT, BenchItem::Bit(ToolBit::LargeBall));
    hands.set_mirror(true);
    let rough = PlungeRaster { spacing: 9.0, min_depth: 4.0, ..PlungeRaster::WHOLE };
    plunge_side(hands, 0.0, rough);
    done(Chapter::Front, hands);
    plunge_side(hands, 90.0, rough);
    plunge_side(hands, 180.0, rough);
    plunge_top(hands, rough);
    done(Chapter::Rough, hands);

    hands.fetch_item(RIGHT, BenchItem::Bit(ToolBit::MediumBall));
    let fine = PlungeRaster { spacing: 5.0, min_depth: 2.5, ..PlungeRaster::WHOLE };
    // The left side by itself too: the stone was not the same there, and the mirror left crumbs.
    for degrees in [0.0, 45.0, 90.0, 135.0, 180.0, 270.0] {
        plunge_side(hands, degrees, fine);
    }
    plunge_top(hands, fine);
    hands.fetch_item(RIGHT, BenchItem::Bit(ToolBit::SmallBall));
    for degrees in [0.0, 90.0, 180.0] {
        work_side_in_strips(hands, degrees, 2.5, 52.0);
    }
    work_side_in_strips(hands, 0.0, 1.7, 52.0);
    plunge_top(hands, PlungeRaster { spacing: 3.0, min_depth: 1.0, ..PlungeRaster::WHOLE });
    pick_crumbs(hands);
    done(Chapter::Fine, hands);

    hands.fetch_item(RIGHT, BenchItem::Tool(Tool::Rasp));
    for degrees in [0.0, 90.0, 180.0] {
        // Not the rim of the foot, where it would leave crumbs.
        work_side_in_strips(hands, degrees, 8.0, 40.0);
    }
    hands.set_mirror(false);
    done(Chapter::Smooth, hands);

    hands.fetch_item(RIGHT, BenchItem::Tool(Tool::FillGun));
    place_paste_spiral(hands);
    done(Chapter::Mishap, hands);
    hands.send_commands(commands::UNDO);
    done(Chapter::Undone, hands);
    place_ring_of_beads(hands);
    hands.wait_ticks(36);
    hands.send_commands(commands::FINISH);
    done(Chapter::Finished, hands);
}

/// Saws the upper right edge of the block off: down beside the figure, then in from the side. What
/// is cut loose falls.
fn saw_off_edge<const N: usize, const K: usize>(hands: &mut ScriptedHands<'_, '_, N, K>)
where
    Grid<N>: Size,
{
    let unit = N as f32 / 128.0;
    let foot = 76.0 * unit;
    let widest = (foot as usize..N)
        .flat_map(|y| hands.world().mask().line(Axis::X, y))
        .map(|column| column.hull().last())
        .max();
    let beside = widest.map_or(64.0, |x| x as f32) + 8.0 * unit;
    let down = evenly_spaced(124.0, 76.0, -6.0).map(|height| (beside, height * unit));
    let aside = evenly_spaced(6.0, 60.0, 6.0).map(|x| (beside + x * unit, foot));
    for (x, y) in down.chain(aside) {
        let from = Vec3::new(x, y, 144.0 * unit);
        let Some(front) = hands.cast_ray_to_stone_and_mask(from, Vec3::NEG_Z).stone else {
            continue;
        };
        let Some(back) = hands.cast_ray_to_stone_and_mask(from.with_z(-16.0 * unit), Vec3::Z).stone
        else {
            continue;
        };
        let start = from.with_z(from.z - front + 9.0 * unit);
        hands.move_bit_to(RIGHT, from, Vec3::NEG_Z);
        hands.move_bit_to(RIGHT, start, Vec3::NEG_Z);
        hands.drive_bit(RIGHT, start, Vec3::NEG_Z, 178.0 * unit - front - back);
        hands.move_bit_to(RIGHT, from, Vec3::NEG_Z);
        hands.release_trigger(RIGHT);
    }
    hands.move_hand_to_rest(RIGHT);
}

/// The grid of points at which the bit is plunged into a side, in voxels of a block of 128.
#[derive(Clone, Copy)]
struct PlungeRaster {
    spacing: f32,
    /// The least depth of stone over the figure at which a plunge is made.
    min_depth: f32,
    /// Height of the lowest row.
    low: f32,
    /// Half the width, to either side of the block's axis.
    wide: f32,
}

impl PlungeRaster {
    const WHOLE: PlungeRaster = PlungeRaster { spacing: 1.0, min_depth: 1.0, low: 3.0, wide: 63.0 };

    /// The heights of the rows, from the top down.
    fn row_heights_from_top(self) -> impl Iterator<Item = f32> {
        let count = ((127.0 - self.low) / self.spacing) as usize;
        (0..=count).rev().map(move |i| self.low + self.spacing * i as f32)
    }
}

/// Plunges the bit into one side of the block, row by row. Symmetry does the other half.
fn plunge_side<const N: usize, const K: usize>(
    hands: &mut ScriptedHands<'_, '_, N, K>,
    degrees_from_z_to_x: f32,
    raster: PlungeRaster,
) where
    Grid<N>: Size,
{
    let unit = N as f32 / 128.0;
    let out = direction_at_azimuth(degrees_from_z_to_x);
    let side = Vec3::Y.cross(out);
    let foot = Vec3::new(64.0, 0.0, 64.0) * unit;
    // Clear of the box by the largest bit.
    let far = if degrees_from_z_to_x % 90.0 == 0.0 { 74.0 } else { 98.0 };
    hands.turn_azimuth_to_visitor(degrees_from_z_to_x);
    for height in raster.row_heights_from_top() {
        for aside in evenly_spaced(-raster.wide, raster.wide, raster.spacing) {
            let start = foot + (Vec3::Y * height + side * aside + out * far) * unit;
            if !is_in_mirrored_half(start, out, unit) {
                plunge_bit(hands, start, -out, far * unit, raster.min_depth * unit);
            }
        }
    }
    hands.move_hand_to_rest(RIGHT);
}

/// Plunges the bit into the top. Symmetry does the other half.
fn plunge_top<const N: usize, const K: usize>(
    hands: &mut ScriptedHands<'_, '_, N, K>,
    raster: PlungeRaster,
) where
    Grid<N>: Size,
{
    let unit = N as f32 / 128.0;
    hands.turn_azimuth_to_visitor(0.0);
    for z in evenly_spaced(8.0, 120.0, raster.spacing) {
        for x in evenly_spaced(64.0, 120.0, raster.spacing) {
            let start = Vec3::new(x, 140.0, z) * unit;
            plunge_bit(hands, start, Vec3::NEG_Y, 138.0 * unit, raster.min_depth * unit);
        }
    }
    hands.move_hand_to_rest(RIGHT);
}

/// Plunges the bit into what stands on the ground by itself, between the plunges, away from the figure.
fn pick_crumbs<const N: usize, const K: usize>(hands: &mut ScriptedHands<'_, '_, N, K>)
where
    Grid<N>: Size,
{
    let (unit, reach) = (N as f32 / 128.0, N / 32);
    for (z, x) in (0..N * N).map(|i| (i / N, i % N)) {
        let near = |i: usize| i.saturating_sub(reach)..(i + reach).min(N);
        let is_figure = |z: usize| {
            hands.world().mask().line(Axis::Y, z)[near(x)].iter().any(|c| *c != Column::EMPTY)
        };
        if hands.world().volume().maps().contains([x, 0, z]) && !near(z).any(is_figure) {
            let start = Vec3::new(x as f32 + 0.5, 140.0 * unit, z as f32 + 0.5);
            plunge_bit(hands, start, Vec3::NEG_Y, 140.0 * unit, 0.0);
        }
    }
    hands.move_hand_to_rest(RIGHT);
}

/// Plunges the bit along `direction` and back out. Does nothing where less than `min_depth_voxels`
/// of stone lie before the mask or `max_travel_voxels`.
fn plunge_bit<const N: usize, const K: usize>(
    hands: &mut ScriptedHands<'_, '_, N, K>,
    start_voxels: Vec3,
    direction: Vec3,
    max_travel_voxels: f32,
    min_depth_voxels: f32,
) where
    Grid<N>: Size,
{
    let StoneAndMaskDistances { stone: Some(stone), mask } =
        hands.cast_ray_to_stone_and_mask(start_voxels, direction)
    else {
        return;
    };
    // The bit is let into what is left by its own size; the mask stops it.
    let end = mask.unwrap_or(max_travel_voxels).min(max_travel_voxels);
    if end - stone < min_depth_voxels || hands.has_ended() {
        return;
    }
    let clear = 0.075 * N as f32;
    let outside = start_voxels + direction * (stone - clear).max(0.0);
    hands.move_bit_to(RIGHT, start_voxels, direction);
    hands.move_bit_to(RIGHT, outside, direction);
    hands.drive_bit(RIGHT, outside, direction, end - stone + clear);
    // The trigger stays down until the bit is out: switched off, it could stick in a bent hole.
    hands.move_bit_to(RIGHT, start_voxels, direction);
    hands.release_trigger(RIGHT);
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
    hands.stroke_through(RIGHT, swirl, Vec3::NEG_Y, 0);
    hands.release_trigger(RIGHT);
    hands.move_bit_to(RIGHT, start, Vec3::NEG_Y);
}

/// Moves the running tool down one side in vertical strips, pressed onto the figure. Symmetry does the
/// other half.
fn work_side_in_strips<const N: usize, const K: usize>(
    hands: &mut ScriptedHands<'_, '_, N, K>,
    degrees_from_z_to_x: f32,
    spacing_units: f32,
    half_width_units: f32,
) where
    Grid<N>: Size,
{
    let unit = N as f32 / 128.0;
    let out = direction_at_azimuth(degrees_from_z_to_x);
    let side = Vec3::Y.cross(out);
    let axis = Vec3::new(64.0, 0.0, 64.0) * unit;
    hands.turn_azimuth_to_visitor(degrees_from_z_to_x);
    for aside in evenly_spaced(-half_width_units, half_width_units, spacing_units) {
        let start = axis + (side * aside + out * 98.0) * unit;
        if is_in_mirrored_half(start, out, unit) {
            continue;
        }
        let press = |y: f32| {
            let StoneAndMaskDistances { stone, mask } =
                hands.cast_ray_to_stone_and_mask(start.with_y(y * unit), -out);
            Some((y * unit, mask.unwrap_or(stone?) + 2.0 * unit))
        };
        let strip: Vec<(f32, f32)> = PlungeRaster { spacing: 2.0, ..PlungeRaster::WHOLE }
            .row_heights_from_top()
            .filter_map(press)
            .collect();
        let Some(&(top, depth)) = strip.first() else { continue };
        hands.move_bit_to(RIGHT, start.with_y(top), -out);
        hands.move_bit_to(RIGHT, start.with_y(top) - out * (depth - 14.0 * unit), -out);
        let points = strip.iter().map(|(y, depth)| start.with_y(*y) - out * *depth);
        hands.stroke_through(RIGHT, points, -out, 5);
        hands.move_bit_to(RIGHT, start, -out);
        hands.release_trigger(RIGHT);
    }
    hands.move_hand_to_rest(RIGHT);
}

/// Whether a point before the front or the back lies in the half that symmetry works. The left and
/// right sides lie in one half each.
fn is_in_mirrored_half(start: Vec3, outward: Vec3, unit_voxels: f32) -> bool {
    outward.z.abs() > 0.9 && start.x < 62.0 * unit_voxels
}

/// Places beads of paste round the neck, 20 degrees of the stool apart.
fn place_ring_of_beads<const N: usize, const K: usize>(hands: &mut ScriptedHands<'_, '_, N, K>)
where
    Grid<N>: Size,
{
    let unit = N as f32 / 128.0;
    // Over the edge first: on a straight way down from the spiral the head would hold the nozzle.
    hands.move_bit_to(RIGHT, Vec3::new(64.0, 140.0, 162.0) * unit, Vec3::NEG_Y);
    for degrees in evenly_spaced(0.0, 340.0, 20.0) {
        hands.turn_azimuth_to_visitor(degrees);
        let out = direction_at_azimuth(degrees);
        let start = Vec3::new(64.0, 68.0, 64.0) * unit + out * (98.0 * unit);
        let Some(stone) = hands.cast_ray_to_stone_and_mask(start, -out).stone else { continue };
        let touch = start - out * (stone - 2.0 * unit);
        hands.move_bit_to(RIGHT, start, -out);
        // Set on before it is pulled: paste is laid on all of the way.
        hands.move_bit_to(RIGHT, touch, -out);
        hands.stroke_through(RIGHT, (0..6).map(|_| touch), -out, 0);
        hands.release_trigger(RIGHT);
        hands.move_bit_to(RIGHT, start, -out);
    }
    hands.move_hand_to_rest(RIGHT);
}

/// The horizontal unit vector at an angle in degrees from +z towards +x.
fn direction_at_azimuth(degrees_from_z_to_x: f32) -> Vec3 {
    let radians = degrees_from_z_to_x.to_radians();
    Vec3::new(libm::sinf(radians), 0.0, libm::cosf(radians))
}

/// The numbers from `first` to `last_inclusive` in steps of `step`, which may be negative.
fn evenly_spaced(first: f32, last_inclusive: f32, step: f32) -> impl Iterator<Item = f32> {
    let count = ((last_inclusive - first) / step).floor() as usize;
    (0..=count).map(move |i| first + step * i as f32)
}
