//! A world in which a hand draws a stroke.

use std::fmt;

use glam::Vec3;
use paros_core::edit::Pose;
use paros_core::internals::{BrushBounds, BrushPiece};
use paros_core::session::{BenchItem, SessionMode, ToolBit};
use paros_core::volume::{BitGrid, Grid, Size};
use paros_core::{HandInput, TickInput};
use paros_models::scripted_hand::{RIGHT, input_with_hand, take_item};
use paros_models::world_harness::WorldHarness;

use super::figures::{ChangedVoxels, StrokeFigures};
use super::stone::{BOX_MM, Stone, grip_of, reach_of};

/// Ticks after the hand is down in which a bit may still catch up, and the number of measured ticks after
/// them.
const SETTLING_TICKS: u32 = 16;
pub(crate) const MEASURED_TICKS: u32 = 40;

/// The height from which the hand comes down, and its descent a tick, in millimetres.
const APPROACH_MM: f32 = 3.0;
const DESCENT_MM: f32 = 1.0;

/// A stroke to draw.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Stroke {
    pub(crate) bit: ToolBit,
    pub(crate) stone: Stone,
    pub(crate) is_rough: bool,
    pub(crate) pressed_mm: f32,
    /// The hand's speed along the stone, in millimetres a tick.
    pub(crate) speed_mm: f32,
}

impl fmt::Display for Stroke {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Stroke { bit, stone, is_rough, pressed_mm, speed_mm } = self;
        let rough = if *is_rough { ", rough" } else { "" };
        write!(f, "{bit:?} on {stone:?}{rough}, {pressed_mm} mm, {:.3} m/s", speed_mm * 0.072)
    }
}

/// A world with the stone that its sessions start from.
pub(crate) struct Scene<const N: usize>
where
    Grid<N>: Size,
{
    harness: WorldHarness<N, 2>,
    stone: Option<(Stone, bool)>,
    changed: ChangedVoxels<N>,
    /// The voxels that the bit swept, and those at the bit's places in its hand.
    swept: BitGrid<N>,
    asked: BitGrid<N>,
}

impl<const N: usize> Scene<N>
where
    Grid<N>: Size,
{
    pub(crate) const fn new() -> Self {
        Scene {
            harness: WorldHarness::new(),
            stone: None,
            changed: ChangedVoxels::new(),
            swept: BitGrid::new(),
            asked: BitGrid::new(),
        }
    }

    /// Starts a session from the stroke's stone, with its bit in the right hand.
    fn start(&mut self, Stroke { bit, stone, is_rough, .. }: Stroke) {
        if self.stone != Some((stone, is_rough)) {
            self.harness.start_from_voxels(|voxel| stone.contains(N, voxel, is_rough));
            self.stone = Some((stone, is_rough));
        } else {
            self.harness.step(&TickInput { start: SessionMode::Own, ..TickInput::default() });
        }
        take_item(&mut self.harness, RIGHT, BenchItem::Tool(bit.spec().tool));
        take_item(&mut self.harness, RIGHT, BenchItem::Bit(bit));
        let held = self.harness.world.held_tool(RIGHT);
        assert_eq!(held, Some((bit.spec().tool, bit)));
        self.swept.clear();
        self.asked.clear();
        self.changed.before.copy_from(self.harness.world.volume().rows());
    }

    /// Draws a stroke and returns its measurements.
    pub(crate) fn draw(&mut self, stroke: Stroke) -> StrokeFigures {
        self.start(stroke);
        let Stroke { bit, stone, pressed_mm, speed_mm, .. } = stroke;
        let (grip, side) = (grip_of(bit), N as f32);
        let voxels = |mm: f32| mm * side / BOX_MM;
        let grid_bit = bit.to_grid_bit(BOX_MM * 1e3 / side);
        let reach = reach_of(&grid_bit, grip);
        let down = ((APPROACH_MM + pressed_mm) / DESCENT_MM).ceil() as u32;
        let (first, last) = (down + SETTLING_TICKS, down + SETTLING_TICKS + MEASURED_TICKS);
        let pose_at = |tick: u32| {
            let along = voxels(speed_mm) * (tick.min(last) as f32 - 0.5 * last as f32);
            let pressed = pressed_mm.min(DESCENT_MM * tick as f32 - APPROACH_MM);
            let Pose { position, rotation } = stone.surface_at(side, along);
            let out = rotation * Vec3::Y * (reach - voxels(pressed));
            Pose { position: position + out, rotation: rotation * grip }
        };
        self.step(&pose_at(0), false);
        let mut figures = StrokeFigures::default();
        let mut places = Vec::new();
        // The hand rests at the end of its path until the tool has bitten once more.
        for tick in 1..last + u32::from(bit.spec().bite_period) {
            let last_raw = self.harness.world.hand_state(RIGHT).raw_pose;
            let before = self.step(&pose_at(tick), true);
            let hand = self.harness.world.hand_state(RIGHT);
            let (frozen, raw) = (hand.frozen_pose, hand.raw_pose);
            // A bit that follows its hand takes the hand's own path, or slides beside it.
            for (from, to) in [(before, frozen), (last_raw, raw)] {
                let brush = grid_bit.swept_brush(&from, &to);
                brush.pieces().for_each(|piece| insert_piece(&mut self.swept, &piece));
            }
            if (first..last).contains(&tick) {
                insert_piece(&mut self.asked, &grid_bit.piece_at(&raw));
                places.push(grid_bit.piece_at(&raw));
                figures.measure_lag(&frozen, &raw, grip, BOX_MM / side);
                figures.stood += u32::from(frozen.position == before.position);
            }
        }
        let now = self.harness.world.volume().rows();
        self.changed.set_now(now);
        self.changed.count(bit.spec().action, &self.swept, &self.asked, now, &mut figures);
        figures.bare = places.iter().filter(|piece| !self.changed.overlaps(piece)).count() as u32;
        figures.parts = self.changed.count_parts();
        figures
    }

    pub(crate) fn check_invariants(&mut self) {
        self.harness.check_invariants();
    }

    /// Runs a tick with the hand at a pose. Returns the bit's pose before the tick.
    fn step(&mut self, pose: &Pose, trigger_down: bool) -> Pose {
        let at = self.harness.world.hand_with_bit_at(RIGHT, pose);
        let trigger = if trigger_down { 255 } else { 0 };
        let before = self.harness.world.hand_state(RIGHT).frozen_pose;
        self.harness.step(&input_with_hand(RIGHT, HandInput { trigger, ..at }));
        before
    }
}

/// Adds a piece's voxels.
fn insert_piece<const N: usize>(grid: &mut BitGrid<N>, piece: &BrushPiece)
where
    Grid<N>: Size,
{
    let Some(BrushBounds { lo, hi }) = piece.bounds(N) else {
        return;
    };
    for (y, z) in (lo[1]..=hi[1]).flat_map(|y| (lo[2]..=hi[2]).map(move |z| (y, z))) {
        if let Some(range) = piece.x_range(y, z, N) {
            *grid.row_mut(y, z) |= range.to_row();
        }
    }
}
