//! The demo: a scripted session from the lump to the figure hidden in it.
//!
//! The script reads the world, its volume and contacts, and answers with tick inputs. It has no other
//! state and no clock, so its digests are the same on every machine.

pub mod scripted_hands;

use crate::tick_runner::TickRunner;
use glam::Vec3;
use paros_core::{Axis, BenchItem, Grid, SessionMode, Size, Tool, ToolBit, commands};

use scripted_hands::ScriptedHands;
pub use scripted_hands::TickWatcher;

/// A stage of the session, for pictures and the report.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Chapter {
    /// The lump as it came.
    Stone,
    /// An edge has been sawn off and fell.
    Edge,
    /// The front has been roughed out.
    Front,
    /// The large burr is done.
    Rough,
    /// The medium burr is done.
    Fine,
    /// The rasp took the ridges.
    Smooth,
    /// Paste went where it shouldn't.
    Mishap,
    /// That was undone.
    Undone,
    /// Beads of paste lie round the neck; finished.
    Finished,
}

impl Chapter {
    /// All of them, in order.
    pub const ALL: [Chapter; 9] = [
        Chapter::Stone,
        Chapter::Edge,
        Chapter::Front,
        Chapter::Rough,
        Chapter::Fine,
        Chapter::Smooth,
        Chapter::Mishap,
        Chapter::Undone,
        Chapter::Finished,
    ];

    /// What has just been done, for the report.
    #[must_use]
    pub const fn announcement(self) -> &'static str {
        match self {
            Chapter::Stone => "the stone",
            Chapter::Edge => "an edge sawn off",
            Chapter::Front => "the front roughed out",
            Chapter::Rough => "roughed out",
            Chapter::Fine => "worked finer",
            Chapter::Smooth => "rasped smooth",
            Chapter::Mishap => "paste on the head",
            Chapter::Undone => "undone",
            Chapter::Finished => "a string of beads round the neck",
        }
    }
}

/// The right hand does the work; the left turns the stool.
const RIGHT: usize = 1;

/// Plays the session. Calls `watcher` after every tick and `chapter` at the end of every chapter.
/// `figure` is the number of the hidden figure.
pub fn play_demo<const N: usize>(
    stage: &mut TickRunner<'_, N>,
    figure: u8,
    watcher: &mut TickWatcher<'_, N>,
    mut chapter: impl FnMut(Chapter, &paros_core::World<N>),
) where
    Grid<N>: Size,
{
    let mut s = ScriptedHands::new(stage, watcher);
    let mut done = |chapter_done, s: &ScriptedHands<'_, '_, N>| chapter(chapter_done, s.world());
    s.start_session(SessionMode::Constrained { figure });
    done(Chapter::Stone, &s);

    s.fetch_item(RIGHT, BenchItem::Tool(Tool::Rotary));
    saw_off_edge(&mut s);
    done(Chapter::Edge, &s);

    s.fetch_item(RIGHT, BenchItem::Bit(ToolBit::LargeBall));
    s.set_mirror(true);
    let rough = PlungeRaster { spacing: 9.0, least: 4.0, ..PlungeRaster::WHOLE };
    plunge_side(&mut s, 0.0, rough);
    done(Chapter::Front, &s);
    plunge_side(&mut s, 90.0, rough);
    plunge_side(&mut s, 180.0, rough);
    plunge_top(&mut s, rough);
    done(Chapter::Rough, &s);

    s.fetch_item(RIGHT, BenchItem::Bit(ToolBit::MediumBall));
    let fine = PlungeRaster { spacing: 5.0, least: 2.5, ..PlungeRaster::WHOLE };
    // The left side by itself too: the stone was not the same there, and the mirror left crumbs.
    for degrees in [0.0, 45.0, 90.0, 135.0, 180.0, 270.0] {
        plunge_side(&mut s, degrees, fine);
    }
    plunge_top(&mut s, fine);
    s.fetch_item(RIGHT, BenchItem::Bit(ToolBit::SmallBall));
    for degrees in [0.0, 90.0, 180.0] {
        draw_strips(&mut s, degrees, 2.5);
    }
    draw_strips(&mut s, 0.0, 1.7);
    plunge_top(&mut s, PlungeRaster { spacing: 3.0, least: 1.0, ..PlungeRaster::WHOLE });
    done(Chapter::Fine, &s);

    s.fetch_item(RIGHT, BenchItem::Tool(Tool::Rasp));
    for degrees in [0.0, 90.0, 180.0] {
        draw_strips(&mut s, degrees, 8.0);
    }
    s.set_mirror(false);
    done(Chapter::Smooth, &s);

    s.fetch_item(RIGHT, BenchItem::Tool(Tool::FillGun));
    place_paste_blot(&mut s);
    done(Chapter::Mishap, &s);
    s.send_command(commands::UNDO);
    done(Chapter::Undone, &s);
    place_necklace(&mut s);
    s.wait_ticks(36);
    s.send_command(commands::FINISH);
    done(Chapter::Finished, &s);
}

/// Saws the upper right edge of the block off: down beside the figure, then in from the side. What
/// is cut loose falls. The cuts run along an axis, as range maps can hold no others.
fn saw_off_edge<const N: usize>(s: &mut ScriptedHands<'_, '_, N>)
where
    Grid<N>: Size,
{
    let unit = N as f32 / 128.0;
    let foot = 76.0 * unit;
    let widest = (foot as usize..N)
        .flat_map(|y| s.world().mask().line(Axis::X, y))
        .map(|column| column.hull().last())
        .max();
    let beside = widest.map_or(64.0, |x| x as f32) + 8.0 * unit;
    let down = evenly_spaced(124.0, 76.0, -6.0).map(|height| (beside, height * unit));
    let aside = evenly_spaced(6.0, 60.0, 6.0).map(|x| (beside + x * unit, foot));
    for (x, y) in down.chain(aside) {
        let from = Vec3::new(x, y, 144.0 * unit);
        let (Some(front), _) = s.cast_ray(from, Vec3::NEG_Z) else { continue };
        let (Some(back), _) = s.cast_ray(from.with_z(-16.0 * unit), Vec3::Z) else { continue };
        let start = from.with_z(from.z - front + 9.0 * unit);
        s.move_bit_to(RIGHT, from, Vec3::NEG_Z);
        s.move_bit_to(RIGHT, start, Vec3::NEG_Z);
        s.drive_bit(RIGHT, start, Vec3::NEG_Z, 178.0 * unit - front - back);
        s.move_bit_to(RIGHT, from, Vec3::NEG_Z);
        s.release_trigger(RIGHT);
    }
    s.rest_hand(RIGHT);
}

/// The grid of points at which the bit is plunged into a side, in voxels of a block of 128.
#[derive(Clone, Copy)]
struct PlungeRaster {
    spacing: f32,
    /// The least depth of stone over the figure at which a plunge is made.
    least: f32,
    /// Height of the lowest row.
    low: f32,
    /// Half the width, to either side of the block's axis.
    wide: f32,
}

impl PlungeRaster {
    const WHOLE: PlungeRaster = PlungeRaster { spacing: 1.0, least: 1.0, low: 3.0, wide: 63.0 };

    /// The heights of the rows, from the top down.
    fn row_heights(self) -> impl Iterator<Item = f32> {
        let count = ((127.0 - self.low) / self.spacing) as usize;
        (0..=count).rev().map(move |i| self.low + self.spacing * i as f32)
    }
}

/// Plunges the bit into one side of the block, row by row. Symmetry does the other half.
fn plunge_side<const N: usize>(s: &mut ScriptedHands<'_, '_, N>, degrees: f32, raster: PlungeRaster)
where
    Grid<N>: Size,
{
    let unit = N as f32 / 128.0;
    let out = outward_normal(degrees);
    let side = Vec3::Y.cross(out);
    let foot = Vec3::new(64.0, 0.0, 64.0) * unit;
    // Clear of the box by the largest bit.
    let far = if degrees % 90.0 == 0.0 { 74.0 } else { 98.0 };
    s.turn_side_to_visitor(degrees);
    for height in raster.row_heights() {
        for aside in evenly_spaced(-raster.wide, raster.wide, raster.spacing) {
            let start = foot + (Vec3::Y * height + side * aside + out * far) * unit;
            if !is_mirrored(start, out, unit) {
                plunge_bit(s, start, -out, far * unit, raster.least * unit);
            }
        }
    }
    s.rest_hand(RIGHT);
}

/// Plunges the bit into the top. Symmetry does the other half.
fn plunge_top<const N: usize>(s: &mut ScriptedHands<'_, '_, N>, raster: PlungeRaster)
where
    Grid<N>: Size,
{
    let unit = N as f32 / 128.0;
    s.turn_side_to_visitor(0.0);
    for z in evenly_spaced(8.0, 120.0, raster.spacing) {
        for x in evenly_spaced(64.0, 120.0, raster.spacing) {
            let start = Vec3::new(x, 140.0, z) * unit;
            plunge_bit(s, start, Vec3::NEG_Y, 138.0 * unit, raster.least * unit);
        }
    }
    s.rest_hand(RIGHT);
}

/// Plunges the bit along `direction` and back out. Does nothing where less than `least` voxels of stone lie
/// before the mask or `farthest`.
fn plunge_bit<const N: usize>(
    s: &mut ScriptedHands<'_, '_, N>,
    start: Vec3,
    direction: Vec3,
    farthest: f32,
    least: f32,
) where
    Grid<N>: Size,
{
    let (Some(stone), mask) = s.cast_ray(start, direction) else { return };
    // The bit is let into what is left by its own size; the mask stops it.
    let end = mask.unwrap_or(farthest).min(farthest);
    if end - stone < least || s.has_ended() {
        return;
    }
    let clear = 0.075 * N as f32;
    let outside = start + direction * (stone - clear).max(0.0);
    s.move_bit_to(RIGHT, start, direction);
    s.move_bit_to(RIGHT, outside, direction);
    s.drive_bit(RIGHT, outside, direction, end - stone + clear);
    // The trigger stays down until the bit is out: switched off, it could stick in a bent hole.
    s.move_bit_to(RIGHT, start, direction);
    s.release_trigger(RIGHT);
}

/// Draws a spiral of paste on top.
fn place_paste_blot<const N: usize>(s: &mut ScriptedHands<'_, '_, N>)
where
    Grid<N>: Size,
{
    let unit = N as f32 / 128.0;
    s.turn_side_to_visitor(0.0);
    let start = Vec3::new(64.0, 140.0, 64.0) * unit;
    let (Some(stone), _) = s.cast_ray(start, Vec3::NEG_Y) else { return };
    let touch = start + Vec3::NEG_Y * (stone - 2.0 * unit);
    s.move_bit_to(RIGHT, touch + Vec3::Y * (10.0 * unit), Vec3::NEG_Y);
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
    s.stroke_through(RIGHT, swirl, Vec3::NEG_Y, 0);
    s.release_trigger(RIGHT);
    s.move_bit_to(RIGHT, start, Vec3::NEG_Y);
}

/// Moves the running tool down one side in vertical strips, pressed onto the figure. Symmetry does the
/// other half.
fn draw_strips<const N: usize>(s: &mut ScriptedHands<'_, '_, N>, degrees: f32, spacing: f32)
where
    Grid<N>: Size,
{
    let unit = N as f32 / 128.0;
    let out = outward_normal(degrees);
    let side = Vec3::Y.cross(out);
    let axis = Vec3::new(64.0, 0.0, 64.0) * unit;
    s.turn_side_to_visitor(degrees);
    for aside in evenly_spaced(-40.0, 40.0, spacing) {
        let start = axis + (side * aside + out * 98.0) * unit;
        if is_mirrored(start, out, unit) {
            continue;
        }
        let press = |y: f32| {
            let (stone, mask) = s.cast_ray(start.with_y(y * unit), -out);
            Some((y * unit, mask.unwrap_or(stone?) + 2.0 * unit))
        };
        let strip: Vec<(f32, f32)> = PlungeRaster { spacing: 2.0, ..PlungeRaster::WHOLE }
            .row_heights()
            .filter_map(press)
            .collect();
        let Some(&(top, depth)) = strip.first() else { continue };
        s.move_bit_to(RIGHT, start.with_y(top), -out);
        s.move_bit_to(RIGHT, start.with_y(top) - out * (depth - 14.0 * unit), -out);
        let points = strip.iter().map(|(y, depth)| start.with_y(*y) - out * *depth);
        s.stroke_through(RIGHT, points, -out, 5);
        s.move_bit_to(RIGHT, start, -out);
        s.release_trigger(RIGHT);
    }
    s.rest_hand(RIGHT);
}

/// Whether a point before the front or the back lies in the half that symmetry works. The left and
/// right sides lie in one half each.
fn is_mirrored(start: Vec3, out: Vec3, unit: f32) -> bool {
    out.z.abs() > 0.9 && start.x < 62.0 * unit
}

/// Places beads of paste round the neck, 20 degrees of the stool apart.
fn place_necklace<const N: usize>(s: &mut ScriptedHands<'_, '_, N>)
where
    Grid<N>: Size,
{
    let unit = N as f32 / 128.0;
    // Over the edge first: on a straight way down from the blot the head would hold the nozzle.
    s.move_bit_to(RIGHT, Vec3::new(64.0, 140.0, 162.0) * unit, Vec3::NEG_Y);
    for degrees in evenly_spaced(0.0, 340.0, 20.0) {
        s.turn_side_to_visitor(degrees);
        let out = outward_normal(degrees);
        let start = Vec3::new(64.0, 68.0, 64.0) * unit + out * (98.0 * unit);
        let (Some(stone), _) = s.cast_ray(start, -out) else { continue };
        let touch = start - out * (stone - 2.0 * unit);
        s.move_bit_to(RIGHT, start, -out);
        s.move_bit_to(RIGHT, touch + out * (8.0 * unit), -out);
        s.stroke_through(RIGHT, (0..6).map(|_| touch), -out, 0);
        s.release_trigger(RIGHT);
        s.move_bit_to(RIGHT, start, -out);
    }
    s.rest_hand(RIGHT);
}

/// The horizontal unit vector at an angle in degrees from +z towards +x.
fn outward_normal(degrees: f32) -> Vec3 {
    let radians = degrees.to_radians();
    Vec3::new(libm::sinf(radians), 0.0, libm::cosf(radians))
}

/// The numbers from `first` to `last`, inclusive, in steps of `by`, which may be negative.
fn evenly_spaced(first: f32, last: f32, by: f32) -> impl Iterator<Item = f32> {
    let count = ((last - first) / by).floor() as usize;
    (0..=count).map(move |i| first + by * i as f32)
}
