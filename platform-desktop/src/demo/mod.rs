//! The demo: a sculptor's session as a script, from the lump to the figure hidden in it.
//!
//! The script sees only what a visitor sees and feels, the volume and the contact, and answers
//! with inputs, so the session is a function of the core: its digests are the same everywhere.

pub mod sculptor;

use glam::Vec3;
use paros_core::input::{Mode, commands};
use paros_core::maps::Axis;
use paros_core::size::{Grid, Size};
use paros_core::tools::{Bit, Tool};
use paros_core::workbench::Item;
use paros_shell::stage::Stage;

use sculptor::Sculptor;
pub use sculptor::Watcher;

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

    /// A few words about it.
    #[must_use]
    pub const fn words(self) -> &'static str {
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

/// Plays the session. `watcher` hears of every tick, `chapter` of every chapter when it is over.
pub fn play<const N: usize>(
    stage: &mut Stage<'_, N>,
    figure: u8,
    watcher: &mut Watcher<'_, N>,
    mut chapter: impl FnMut(Chapter, &paros_core::world::World<N>),
) where
    Grid<N>: Size,
{
    let mut s = Sculptor::new(stage, watcher);
    let mut done = |chapter_done, s: &Sculptor<'_, '_, N>| chapter(chapter_done, s.world());
    s.start(Mode::Constrained { figure });
    done(Chapter::Stone, &s);

    s.fetch(RIGHT, Item::Tool(Tool::Rotary));
    saw_edge(&mut s);
    done(Chapter::Edge, &s);

    s.fetch(RIGHT, Item::Bit(Bit::LargeBall));
    s.mirror(true);
    let rough = Raster { spacing: 9.0, least: 4.0, ..Raster::WHOLE };
    plunge_side(&mut s, 0.0, rough);
    done(Chapter::Front, &s);
    plunge_side(&mut s, 90.0, rough);
    plunge_side(&mut s, 180.0, rough);
    plunge_top(&mut s, rough);
    done(Chapter::Rough, &s);

    s.fetch(RIGHT, Item::Bit(Bit::MediumBall));
    let fine = Raster { spacing: 5.0, least: 2.5, ..Raster::WHOLE };
    // The left side by itself too: the stone was not the same there, and the mirror left crumbs.
    for degrees in [0.0, 45.0, 90.0, 135.0, 180.0, 270.0] {
        plunge_side(&mut s, degrees, fine);
    }
    plunge_top(&mut s, fine);
    s.fetch(RIGHT, Item::Bit(Bit::SmallBall));
    for degrees in [0.0, 90.0, 180.0] {
        draw_strips(&mut s, degrees, 2.5);
    }
    draw_strips(&mut s, 0.0, 1.7);
    plunge_top(&mut s, Raster { spacing: 3.0, least: 1.0, ..Raster::WHOLE });
    done(Chapter::Fine, &s);

    s.fetch(RIGHT, Item::Tool(Tool::Rasp));
    for degrees in [0.0, 90.0, 180.0] {
        draw_strips(&mut s, degrees, 8.0);
    }
    s.mirror(false);
    done(Chapter::Smooth, &s);

    s.fetch(RIGHT, Item::Tool(Tool::FillGun));
    blot(&mut s);
    done(Chapter::Mishap, &s);
    s.command(commands::UNDO);
    done(Chapter::Undone, &s);
    necklace(&mut s);
    s.wait(36);
    s.command(commands::FINISH);
    done(Chapter::Finished, &s);
}

/// Saws the upper right edge of the block off: down beside the figure, then in from the side. What
/// is cut loose falls. The cuts run along an axis, as range maps can hold no others.
fn saw_edge<const N: usize>(s: &mut Sculptor<'_, '_, N>)
where
    Grid<N>: Size,
{
    let unit = N as f32 / 128.0;
    let foot = 76.0 * unit;
    let widest = (foot as usize..N)
        .flat_map(|y| s.world().mask().line(Axis::X, y))
        .map(|column| column.hull().hi())
        .max();
    let beside = widest.map_or(64.0, |x| x as f32) + 8.0 * unit;
    let down = steps(124.0, 76.0, -6.0).map(|height| (beside, height * unit));
    let aside = steps(6.0, 60.0, 6.0).map(|x| (beside + x * unit, foot));
    for (x, y) in down.chain(aside) {
        let from = Vec3::new(x, y, 144.0 * unit);
        let (Some(front), _) = s.probe(from, Vec3::NEG_Z) else { continue };
        let (Some(back), _) = s.probe(from.with_z(-16.0 * unit), Vec3::Z) else { continue };
        let start = from.with_z(from.z - front + 9.0 * unit);
        s.approach(RIGHT, from, Vec3::NEG_Z);
        s.approach(RIGHT, start, Vec3::NEG_Z);
        s.drive(RIGHT, start, Vec3::NEG_Z, 178.0 * unit - front - back);
        s.approach(RIGHT, from, Vec3::NEG_Z);
        s.lift(RIGHT);
    }
    s.rest(RIGHT);
}

/// Where to plunge, in voxels of a block of 128.
#[derive(Clone, Copy)]
struct Raster {
    spacing: f32,
    /// Stone that must cover the figure for a plunge to be worth it.
    least: f32,
    /// The lowest row.
    low: f32,
    /// How far to either side of the axis.
    wide: f32,
}

impl Raster {
    const WHOLE: Raster = Raster { spacing: 1.0, least: 1.0, low: 3.0, wide: 63.0 };

    /// The rows, from the top down.
    fn heights(self) -> impl Iterator<Item = f32> {
        let count = ((127.0 - self.low) / self.spacing) as usize;
        (0..=count).rev().map(move |i| self.low + self.spacing * i as f32)
    }
}

/// Plunges into one side of the block, row by row. The mirror does the other half.
fn plunge_side<const N: usize>(s: &mut Sculptor<'_, '_, N>, degrees: f32, raster: Raster)
where
    Grid<N>: Size,
{
    let unit = N as f32 / 128.0;
    let out = outward(degrees);
    let side = Vec3::Y.cross(out);
    let foot = Vec3::new(64.0, 0.0, 64.0) * unit;
    // Clear of the box by the largest bit.
    let far = if degrees % 90.0 == 0.0 { 74.0 } else { 98.0 };
    s.face(degrees);
    for height in raster.heights() {
        for aside in steps(-raster.wide, raster.wide, raster.spacing) {
            let start = foot + (Vec3::Y * height + side * aside + out * far) * unit;
            if !is_mirrored(start, out, unit) {
                plunge(s, start, -out, far * unit, raster.least * unit);
            }
        }
    }
    s.rest(RIGHT);
}

/// Plunges from above.
fn plunge_top<const N: usize>(s: &mut Sculptor<'_, '_, N>, raster: Raster)
where
    Grid<N>: Size,
{
    let unit = N as f32 / 128.0;
    s.face(0.0);
    for z in steps(8.0, 120.0, raster.spacing) {
        for x in steps(64.0, 120.0, raster.spacing) {
            let start = Vec3::new(x, 140.0, z) * unit;
            plunge(s, start, Vec3::NEG_Y, 138.0 * unit, raster.least * unit);
        }
    }
    s.rest(RIGHT);
}

/// One plunge along `way`, unless there is little to remove; then out again.
fn plunge<const N: usize>(
    s: &mut Sculptor<'_, '_, N>,
    start: Vec3,
    way: Vec3,
    farthest: f32,
    least: f32,
) where
    Grid<N>: Size,
{
    let (Some(stone), mask) = s.probe(start, way) else { return };
    // The bit is let into what is left by its own size; the mask stops it.
    let end = mask.unwrap_or(farthest).min(farthest);
    if end - stone < least || s.ended() {
        return;
    }
    let clear = 0.075 * N as f32;
    let outside = start + way * (stone - clear).max(0.0);
    s.approach(RIGHT, start, way);
    s.approach(RIGHT, outside, way);
    s.drive(RIGHT, outside, way, end - stone + clear);
    // The tool runs until it is out: at rest it could stick in a bent hole.
    s.approach(RIGHT, start, way);
    s.lift(RIGHT);
}

/// A blot of paste on top.
fn blot<const N: usize>(s: &mut Sculptor<'_, '_, N>)
where
    Grid<N>: Size,
{
    let unit = N as f32 / 128.0;
    s.face(0.0);
    let start = Vec3::new(64.0, 140.0, 64.0) * unit;
    let (Some(stone), _) = s.probe(start, Vec3::NEG_Y) else { return };
    let touch = start + Vec3::NEG_Y * (stone - 2.0 * unit);
    s.approach(RIGHT, touch + Vec3::Y * (10.0 * unit), Vec3::NEG_Y);
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
    s.stroke(RIGHT, swirl, Vec3::NEG_Y, 0);
    s.lift(RIGHT);
    s.approach(RIGHT, start, Vec3::NEG_Y);
}

/// Draws the running tool down one side in strips, pressed onto the figure. The mirror does the other
/// half.
fn draw_strips<const N: usize>(s: &mut Sculptor<'_, '_, N>, degrees: f32, spacing: f32)
where
    Grid<N>: Size,
{
    let unit = N as f32 / 128.0;
    let out = outward(degrees);
    let side = Vec3::Y.cross(out);
    let axis = Vec3::new(64.0, 0.0, 64.0) * unit;
    s.face(degrees);
    for aside in steps(-40.0, 40.0, spacing) {
        let start = axis + (side * aside + out * 98.0) * unit;
        if is_mirrored(start, out, unit) {
            continue;
        }
        let press = |y: f32| {
            let (stone, mask) = s.probe(start.with_y(y * unit), -out);
            Some((y * unit, mask.unwrap_or(stone?) + 2.0 * unit))
        };
        let strip: Vec<(f32, f32)> =
            Raster { spacing: 2.0, ..Raster::WHOLE }.heights().filter_map(press).collect();
        let Some(&(top, depth)) = strip.first() else { continue };
        s.approach(RIGHT, start.with_y(top), -out);
        s.approach(RIGHT, start.with_y(top) - out * (depth - 14.0 * unit), -out);
        let points = strip.iter().map(|(y, depth)| start.with_y(*y) - out * *depth);
        s.stroke(RIGHT, points, -out, 5);
        s.approach(RIGHT, start, -out);
        s.lift(RIGHT);
    }
    s.rest(RIGHT);
}

/// Whether a place before the front or the back is beyond the mirror, where the other half is worked
/// along with this one. The sides are one half each.
fn is_mirrored(start: Vec3, out: Vec3, unit: f32) -> bool {
    out.z.abs() > 0.9 && start.x < 62.0 * unit
}

/// Beads of paste round the neck, the stool turning on from each to the next.
fn necklace<const N: usize>(s: &mut Sculptor<'_, '_, N>)
where
    Grid<N>: Size,
{
    let unit = N as f32 / 128.0;
    // Over the edge first: on a straight way down from the blot the head would hold the nozzle.
    s.approach(RIGHT, Vec3::new(64.0, 140.0, 162.0) * unit, Vec3::NEG_Y);
    for degrees in steps(0.0, 340.0, 20.0) {
        s.face(degrees);
        let out = outward(degrees);
        let start = Vec3::new(64.0, 68.0, 64.0) * unit + out * (98.0 * unit);
        let (Some(stone), _) = s.probe(start, -out) else { continue };
        let touch = start - out * (stone - 2.0 * unit);
        s.approach(RIGHT, start, -out);
        s.approach(RIGHT, touch + out * (8.0 * unit), -out);
        s.stroke(RIGHT, (0..6).map(|_| touch), -out, 0);
        s.lift(RIGHT);
        s.approach(RIGHT, start, -out);
    }
    s.rest(RIGHT);
}

/// The way out of the block at so many degrees from +z to +x.
fn outward(degrees: f32) -> Vec3 {
    let radians = degrees.to_radians();
    Vec3::new(libm::sinf(radians), 0.0, libm::cosf(radians))
}

/// From `first` to `last` in steps of `by`, which may be negative.
fn steps(first: f32, last: f32, by: f32) -> impl Iterator<Item = f32> {
    let count = ((last - first) / by).floor() as usize;
    (0..=count).map(move |i| first + by * i as f32)
}
