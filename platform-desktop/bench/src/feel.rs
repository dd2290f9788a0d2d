//! `bench feel`: the part of a slow groove that a quick hand cuts, and the material removed in a second.
//!
//! A hand approaches a flat face with its trigger pulled, presses its bit 10 mm into it, and moves on at a
//! constant speed. At the end of its path it releases the trigger at once. The material that its bit removes,
//! or a nozzle adds, is given as a fraction of the material on the same path at 0.03 m/s.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, TAU};

use glam::{Quat, Vec3};
use paros_core::edit::{Pose, SUBUNITS_PER_VOXEL};
use paros_core::internals::{BOX_SIDE, BitAction, GridBit, GridShape, SizeRange};
use paros_core::limits::INTERVALS;
use paros_core::session::{BenchItem, BitSize, PointerCommand, SessionMode, TICK_RATE, ToolBit};
use paros_core::volume::{BitSet, Grid, Size};
use paros_core::{HandInput, RangeMaps, StartVolumes, TickInput, World};
use paros_shell::statics::{Resident, ResidentBitGrid};
use paros_shell::tick_runner::TickRunner;

use super::row::ReportRow;

/// Speeds of a hand at work, in m/s.
const SPEEDS: [f32; 3] = [0.3, 0.6, 1.0];
/// Speed of the slow groove, in m/s.
const SLOW_SPEED: f32 = 0.03;

/// Depth to which a bit is pressed into the face, in metres.
const PRESSED: f32 = 0.010;
/// Height above the face at which the hand starts, and its descent in a tick, in metres.
const APPROACH: f32 = 0.003;
const DESCENT: f32 = 0.001;
/// Ticks for the bit to reach its hand, before the path begins and after it has ended.
const SETTLING_TICKS: usize = 48;

/// Radius of the measured circle, in metres, and its duration in seconds.
const CIRCLE_RADIUS: f32 = 0.08;
const CIRCLE_SECONDS: f32 = 0.8;

/// Returns the rows of a grid size.
pub(super) fn measure_rows<const N: usize>() -> Vec<ReportRow>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    let mut stone = Grid::<N>::lock_range_maps();
    let mut bits = Grid::<N>::lock_bit_grid();
    bits.clear();
    for (y, z) in (0..N / 2).flat_map(|y| (0..N).map(move |z| (y, z))) {
        *bits.row_mut(y, z) = <Grid<N> as Size>::Row::span(0, N - 1);
    }
    bits.write_closure(&mut stone);
    drop(bits);
    let world = &mut Grid::<N>::lock_world().world;
    let mut sculptor = Sculptor { world, stone: &stone, size: BitSize::NATURAL };
    let mut rows = Vec::new();
    for bit in ToolBit::ALL {
        let line = match bit.spec().action {
            // The pitching chisel makes one blow in eight ticks, of one tick.
            _ if bit == ToolBit::PitchingChisel => continue,
            BitAction::Carve => "groove",
            BitAction::Fill => "bead",
            BitAction::Smooth | BitAction::Flatten => continue,
        };
        for size in sizes_measured(bit) {
            rows.extend(sculptor.measure_lines(bit, size, line));
        }
    }
    sculptor.size = BitSize::NATURAL;
    for bit in [ToolBit::SmallBall, ToolBit::MediumBall, ToolBit::LargeBall, ToolBit::RoughingBall]
    {
        rows.extend(sculptor.measure_circle(bit));
    }
    rows.push(sculptor.measure_roughing());
    rows
}

/// The voxels of a grid, as bit rows by y and z.
type Voxels<const N: usize> = Vec<<Grid<N> as Size>::Row>;

/// A hand in a world with a flat face.
struct Sculptor<'a, const N: usize>
where
    Grid<N>: Size,
{
    world: &'a mut World<N, INTERVALS>,
    stone: &'a RangeMaps<N, INTERVALS>,
    /// Size of the bits that the hand takes.
    size: BitSize,
}

/// The voxels that a hand removed or added on its path.
struct Cut<const N: usize>
where
    Grid<N>: Size,
{
    voxels: Voxels<N>,
    /// Duration of the path itself.
    seconds: f32,
}

impl<const N: usize> Cut<N>
where
    Grid<N>: Size,
{
    fn count(&self) -> u32 {
        self.voxels.iter().map(|row| row.count_ones()).sum()
    }

    /// Counts the voxels that the other cut changes too.
    fn count_shared(&self, other: &Self) -> u32 {
        self.voxels.iter().zip(&other.voxels).map(|(a, b)| (*a & *b).count_ones()).sum()
    }
}

impl<const N: usize> Sculptor<'_, N>
where
    Grid<N>: Size,
{
    /// Measures straight lines over half of the face.
    fn measure_lines(&mut self, bit: ToolBit, size: BitSize, line: &str) -> Vec<ReportRow> {
        self.size = size;
        let name = match size {
            BitSize::NATURAL => String::from(bit.spec().name),
            size => format!("{} at {} %", bit.spec().name, size.percent()),
        };
        let length = 0.5 * BOX_SIDE;
        let straight = |metres: f32| Vec3::new(0.0, 0.0, 0.5 * length - metres);
        let slow = self.cut_way(bit, PRESSED, length, SLOW_SPEED, straight).count();
        let row = |speed: f32| {
            let cut = self.cut_way(bit, PRESSED, length, speed, straight).count();
            let against = format!("the slow {line}; {speed:.1} m/s");
            ReportRow {
                ratio: Some(f64::from(cut) / f64::from(slow)),
                ..ReportRow::new("feel", &name, N, against)
            }
        };
        SPEEDS.map(row).into()
    }

    fn measure_circle(&mut self, bit: ToolBit) -> [ReportRow; 2] {
        let length = TAU * CIRCLE_RADIUS;
        let circle = |metres: f32| {
            let (sine, cosine) = (metres / CIRCLE_RADIUS).sin_cos();
            Vec3::new(cosine, 0.0, sine) * CIRCLE_RADIUS
        };
        let slow = self.cut_way(bit, PRESSED, length, SLOW_SPEED, circle);
        let quick = self.cut_way(bit, PRESSED, length, length / CIRCLE_SECONDS, circle);
        let (all, shared) = (f64::from(slow.count()), f64::from(quick.count_shared(&slow)));
        let name = bit.spec().name;
        let row = |against: &str, ratio: f64| ReportRow {
            ratio: Some(ratio),
            ..ReportRow::new("feel", name, N, format!("{against}; in {CIRCLE_SECONDS} s"))
        };
        [
            row("the slow circle", shared / all),
            row(
                "voxels outside the slow circle, to those in it",
                (f64::from(quick.count()) - shared) / all,
            ),
        ]
    }

    /// Measures lines side by side, a ball's diameter apart, with the ball pressed in by half its size.
    fn measure_roughing(&mut self) -> ReportRow {
        const LINES: usize = 4;
        let (bit, radius, speed) = (ToolBit::RoughingBall, 0.040, 0.6);
        let (line, step) = (0.7 * BOX_SIDE, 2.0 * radius);
        let length = line * LINES as f32 + step * (LINES - 1) as f32;
        let raster = |metres: f32| {
            let lines = (metres / (line + step)).floor();
            let along = (metres - lines * (line + step)).min(line);
            let aside = lines * step + (metres - lines * (line + step) - along);
            let along = if (lines as usize).is_multiple_of(2) { along } else { line - along };
            Vec3::new(aside - 0.5 * step * (LINES - 1) as f32, 0.0, 0.5 * line - along)
        };
        let cut = self.cut_way(bit, radius, length, speed, raster);
        ReportRow {
            voxels_per_second: Some(f64::from(cut.count()) / f64::from(cut.seconds)),
            ..ReportRow::new("feel", bit.spec().name, N, format!("a raster at {speed} m/s"))
        }
    }

    /// Cuts along a path of `length` metres at `speed` m/s, after pressing the bit `pressed` metres into the
    /// face at its start. Returns the voxels of the start volume that the bit removes or adds. `place` maps
    /// the distance moved to the hand's position relative to the face's middle, in metres.
    fn cut_way(
        &mut self,
        bit: ToolBit,
        pressed: f32,
        length: f32,
        speed: f32,
        place: impl Fn(f32) -> Vec3,
    ) -> Cut<N> {
        self.start_with_bit(bit);
        let voxels_per_metre = N as f32 / BOX_SIDE;
        let grid_bit = bit.spec_at(self.size).to_grid_bit(1e6 / voxels_per_metre);
        let rotation = grip_of(bit);
        let reach = reach_of(&grid_bit, rotation);
        let pose = |metres: f32, pressed: f32| {
            let above = Vec3::Y * (reach - pressed * voxels_per_metre);
            // Avoid the voxels' planes of symmetry.
            let face = Vec3::splat(N as f32 / 2.0) + Vec3::X * 0.3;
            Pose { position: face + place(metres) * voxels_per_metre + above, rotation }
        };
        self.step(&pose(0.0, -APPROACH), false);
        let descent = ((APPROACH + pressed) / DESCENT).ceil() as usize;
        for tick in 1..=descent + SETTLING_TICKS {
            let now = (DESCENT * tick as f32 - APPROACH).min(pressed);
            self.step(&pose(0.0, now), true);
        }
        let before = self.occupied();
        let ticks = (length / speed * TICK_RATE as f32).round();
        for tick in 1..=ticks as usize {
            self.step(&pose(length * tick as f32 / ticks, pressed), true);
        }
        for _ in 0..SETTLING_TICKS {
            self.step(&pose(length, pressed), false);
        }
        let after = self.occupied();
        let voxels = before.iter().zip(&after).map(|(before, after)| *before ^ *after).collect();
        Cut { voxels, seconds: ticks / TICK_RATE as f32 }
    }

    /// Starts a session with the bit in the right hand.
    fn start_with_bit(&mut self, bit: ToolBit) {
        self.run_tick(&TickInput { start: SessionMode::Own, ..TickInput::default() });
        for item in [BenchItem::Tool(bit.spec().tool), BenchItem::Bit(bit)] {
            let pointer = PointerCommand::Take { hand: RIGHT as u8, item: item.number() as u8 };
            self.run_tick(&TickInput { pointer, ..TickInput::default() });
        }
        let pointer = PointerCommand::Resize { hand: RIGHT as u8, by: self.size.steps() };
        self.run_tick(&TickInput { pointer, ..TickInput::default() });
    }

    fn step(&mut self, bit_pose: &Pose, is_trigger_down: bool) {
        let trigger = if is_trigger_down { u8::MAX } else { 0 };
        let hand = HandInput { trigger, ..self.world.hand_with_bit_at(RIGHT, bit_pose) };
        let mut input = TickInput::default();
        input.hands[RIGHT] = hand;
        self.run_tick(&input);
    }

    fn run_tick(&mut self, input: &TickInput) {
        let stone = self.stone;
        let starts = StartVolumes { lump: stone, figures: &[], creative: stone, own: Some(stone) };
        TickRunner::new(self.world, starts).run_tick(input);
    }

    fn occupied(&self) -> Voxels<N> {
        let rows = self.world.volume().rows();
        (0..N * N).map(|i| rows.row(i / N, i % N)).collect()
    }
}

/// The hand that works; the other is not tracked.
const RIGHT: usize = 1;

/// Returns the sizes to measure: the table's, the smallest and the largest of the bit.
fn sizes_measured(bit: ToolBit) -> Vec<BitSize> {
    let SizeRange { smallest, largest } = bit.spec().sizes;
    let mut steps = vec![smallest, 0, largest];
    steps.dedup();
    steps.into_iter().filter_map(|steps| BitSize::of_bit(bit, steps)).collect()
}

/// Returns the rotation of a bit on a face whose normal is y, for a path along -z: a cylinder lies across the
/// path, a grinder on its disc, a chisel is pushed ahead.
fn grip_of(bit: ToolBit) -> Quat {
    match bit {
        ToolBit::Cylinder => Quat::from_rotation_y(FRAC_PI_2),
        ToolBit::Grinder => Quat::from_rotation_x(-FRAC_PI_2),
        ToolBit::PointChisel | ToolBit::FlatChisel | ToolBit::PitchingChisel => {
            Quat::from_rotation_x(-FRAC_PI_4)
        }
        _ => Quat::IDENTITY,
    }
}

/// Returns the distance from a bit's centre down to its lowest point, in voxels.
fn reach_of(bit: &GridBit, grip: Quat) -> f32 {
    let subunits = match bit.shape {
        GridShape::Ball(radius) => radius as f32,
        GridShape::Box(half) => (grip.inverse() * Vec3::Y).abs().dot(half.as_vec3()),
        GridShape::Disc { radius, .. } => radius as f32,
    };
    subunits / SUBUNITS_PER_VOXEL as f32
}
