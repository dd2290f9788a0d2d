//! Whether a newcomer finds the hidden figures: a hand that knows nothing of them, and strokes the stone row by row
//! from four sides and from above.

use std::sync::{Mutex, PoisonError};

use glam::Vec3;
use paros_core::edit::Pose;
use paros_core::session::{BenchItem, SessionMode, Tool, ToolBit};
use paros_core::volume::Axis;
use paros_core::{HandInput, TickInput, WorldEvent};
use paros_models::scripted_hand::{RIGHT, input_with_hand, take_item};
use paros_models::world_harness::WorldHarness;
use paros_shell::figures::{Figure, HiddenStart, StoneThickness};

static HARNESS: Mutex<WorldHarness<128, 2>> = Mutex::new(WorldHarness::new());

/// Side of the stone's box in millimetres.
const BOX_MM: f32 = 450.0;
const VOXEL_MM: f32 = BOX_MM / 128.0;
const TICKS_PER_SECOND: u32 = 72;
/// Of the hand while it works.
const MM_PER_TICK: f32 = 500.0 / TICKS_PER_SECOND as f32;

/// A side of the stone from which it is stroked.
#[derive(Clone, Copy)]
struct Side {
    /// Along which the hand looks.
    axis: Axis,
    /// Whether it looks along the axis, not against it.
    is_from_below: bool,
}

const SIDES: [Side; 5] = [
    Side { axis: Axis::Z, is_from_below: false },
    Side { axis: Axis::X, is_from_below: false },
    Side { axis: Axis::Z, is_from_below: true },
    Side { axis: Axis::X, is_from_below: true },
    Side { axis: Axis::Y, is_from_below: false },
];

/// How a side is stroked. Lengths are in millimetres.
struct Stroke {
    bit: ToolBit,
    /// Of the bit.
    radius: f32,
    /// Between rows.
    spacing: f32,
    /// How far the bit is pushed into what is seen.
    press: f32,
}

/// First the stone is taken off, then what is left of it in the hollows.
const LARGE: Stroke = Stroke { bit: ToolBit::LargeBall, radius: 24.0, spacing: 24.0, press: 24.0 };
const MEDIUM: Stroke =
    Stroke { bit: ToolBit::MediumBall, radius: 15.0, spacing: 18.0, press: 20.0 };

/// A hand that works for two seconds and pauses for one. Lengths are in millimetres, of the stone's box.
struct NaiveHand<'a> {
    harness: &'a mut WorldHarness<128, 2>,
    ticks: u32,
    place: Vec3,
    is_found: bool,
}

impl NaiveHand<'_> {
    fn take(&mut self, item: BenchItem) {
        take_item(self.harness, RIGHT, item);
        // To look at the bench and back.
        (0..TICKS_PER_SECOND).for_each(|_| self.step(0));
    }

    fn step(&mut self, trigger: u8) {
        let pose = Pose { position: self.place / VOXEL_MM, ..Pose::ZERO };
        let hand = HandInput { trigger, ..self.harness.world.hand_with_bit_at(RIGHT, &pose) };
        self.harness.step(&input_with_hand(RIGHT, hand));
        self.is_found |= self.harness.world.events().contains(&WorldEvent::Found);
        self.ticks += 1;
    }

    /// Moves on to a place with the trigger pulled, and pauses when it is time to.
    fn stroke_to(&mut self, target: Vec3) {
        while self.place != target && !self.is_found {
            while self.ticks % (3 * TICKS_PER_SECOND) >= 2 * TICKS_PER_SECOND {
                self.step(0);
            }
            let way = target - self.place;
            self.place = if way.length() <= MM_PER_TICK {
                target
            } else {
                self.place + way.normalize() * MM_PER_TICK
            };
            self.step(255);
        }
    }

    /// How far the stone reaches toward the hand at a place across a side; `None` where there is none.
    fn height(&self, side: Side, across: [f32; 2]) -> Option<f32> {
        let others = [1, 2].map(|i| (side.axis as usize + i) % 3);
        let mut voxel = [0; 3];
        for (other, at) in others.into_iter().zip(across) {
            voxel[other] = ((at / VOXEL_MM).max(0.0) as usize).min(127);
        }
        let address = side.axis.column_address(voxel);
        let hull = self.harness.world.volume().maps().column(side.axis, address).hull();
        let voxels =
            if side.is_from_below { -(hull.first() as f32) } else { (hull.last() + 1) as f32 };
        (!hull.is_empty()).then_some(voxels * VOXEL_MM)
    }

    /// Where the bit is pressed into what is seen of the stone at a place across a side; `None` where there is
    /// none, or where it is seen so much aslant that one would turn the stone first.
    fn place_on_stone(&self, side: Side, across: [f32; 2], stroke: &Stroke) -> Option<Vec3> {
        let &Stroke { radius, press, .. } = stroke;
        let reach = 0.7 * radius;
        let around = [(reach, 0.0), (-reach, 0.0), (0.0, reach), (0.0, -reach)];
        let heights = around.map(|(u, v)| self.height(side, [across[0] + u, across[1] + v]));
        let height = self.height(side, across)?;
        let faces = |a: Option<f32>, b: Option<f32>| match (a, b) {
            (Some(a), Some(b)) => (a - b).abs() < 3.0 * reach,
            _ => false,
        };
        if !faces(heights[0], heights[1]) || !faces(heights[2], heights[3]) {
            return None;
        }
        let height = heights.into_iter().flatten().fold(height, f32::max) + radius - press;
        let axis = side.axis as usize;
        let mut place = [0.0; 3];
        place[axis] = if side.is_from_below { -height } else { height };
        (place[(axis + 1) % 3], place[(axis + 2) % 3]) = (across[0], across[1]);
        // No deeper than the stool allows.
        Some(Vec3::from_array(place).max(Vec3::new(f32::MIN, 0.3 * radius, f32::MIN)))
    }

    /// Strokes a side in rows, to and fro.
    fn stroke_side(&mut self, side: Side, stroke: &Stroke) {
        let rows = (BOX_MM / stroke.spacing) as usize;
        let steps = (BOX_MM / 10.0) as usize;
        for row in 0..=rows {
            for step in 0..=steps {
                let step = if row % 2 == 0 { step } else { steps - step };
                let (along, aside) = (step as f32 * 10.0, row as f32 * stroke.spacing);
                // Level rows, seen from a side.
                let across = match side.axis {
                    Axis::X => [aside, along],
                    Axis::Y | Axis::Z => [along, aside],
                };
                if let Some(place) = self.place_on_stone(side, across, stroke) {
                    self.stroke_to(place);
                }
            }
        }
    }
}

/// Seconds until a figure is found, from its stone, and the percents that were bared when a bit had been all around.
fn find(harness: &mut WorldHarness<128, 2>, start: HiddenStart) -> (u32, Vec<u32>) {
    harness.reset_to_hidden(start);
    let mode = SessionMode::Constrained { figure: 0 };
    harness.step(&TickInput { start: mode, ..TickInput::default() });
    take_item(harness, RIGHT, BenchItem::Tool(Tool::Rotary));
    let place = Vec3::new(225.0, 300.0, 600.0);
    let mut hand = NaiveHand { harness, ticks: 0, place, is_found: false };
    let mut percents = Vec::new();
    for stroke in [LARGE, MEDIUM, MEDIUM] {
        hand.take(BenchItem::Bit(stroke.bit));
        for side in SIDES {
            hand.stroke_side(side, &stroke);
        }
        percents.push(hand.harness.world.bared_ends().percent());
    }
    (hand.ticks / TICKS_PER_SECOND, percents)
}

/// A visit has 180 seconds for it. The owl takes 292; of the amphora, whose handles hide its neck from all five sides,
/// 85 % are bared in 366.
#[test]
fn a_naive_hand_finds_a_figure_near_its_surface() {
    let mut harness = HARNESS.lock().unwrap_or_else(PoisonError::into_inner);
    for (figure, most_seconds) in [(Figure::Dolphin, 180), (Figure::Cat, 240)] {
        let (seconds, percents) = find(&mut harness, near(figure));
        println!("{figure:?}: {seconds} s, {percents:?} %");
        assert!(seconds < most_seconds && percents.last() >= Some(&95), "{figure:?}: {percents:?}");
    }
}

#[test]
#[ignore = "a measurement"]
fn how_long_a_naive_hand_takes() {
    let mut harness = HARNESS.lock().unwrap_or_else(PoisonError::into_inner);
    for start in HiddenStart::ALL {
        let (seconds, percents) = find(&mut harness, start);
        println!("{}: {seconds} s, {percents:?} %", start.name());
    }
}

fn near(figure: Figure) -> HiddenStart {
    HiddenStart { figure, thickness: StoneThickness::Near }
}
