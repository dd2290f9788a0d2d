//! Simulates a newcomer who searches for hidden figures: a hand without knowledge of them, which strokes the
//! stone row by row from four sides and from above.

use std::sync::{Mutex, PoisonError};

use glam::{Mat3, Quat, Vec3};
use paros_core::session::{BenchItem, SessionMode, Tool, ToolBit};
use paros_core::volume::{Axis, Grid, Size};
use paros_core::{TickInput, WorldEvent};
use paros_models::cases::scaled_cases;
use paros_models::scripted_hand::{BOX_MM, RIGHT, input_with_bit_at, take_item};
use paros_models::world_harness::WorldHarness;
use paros_shell::figures::{HiddenStart, StoneThickness};

static HARNESS_64: Mutex<WorldHarness<64>> = Mutex::new(WorldHarness::new());
static HARNESS_128: Mutex<WorldHarness<128, 2>> = Mutex::new(WorldHarness::new());
static HARNESS_256: Mutex<WorldHarness<256, 2>> = Mutex::new(WorldHarness::new());

const TICKS_PER_SECOND: u32 = 72;
/// Speed of the working hand, in millimetres a tick.
const MM_PER_TICK: f32 = 500.0 / TICKS_PER_SECOND as f32;

/// A side from which the stone is stroked.
#[derive(Clone, Copy)]
struct Side {
    /// The axis along which the hand looks.
    axis: Axis,
    /// `true` if it looks in the axis's positive direction.
    is_from_below: bool,
}

const SIDES: [Side; 5] = [
    Side { axis: Axis::Z, is_from_below: false },
    Side { axis: Axis::X, is_from_below: false },
    Side { axis: Axis::Z, is_from_below: true },
    Side { axis: Axis::X, is_from_below: true },
    Side { axis: Axis::Y, is_from_below: false },
];

/// Parameters for stroking a side. Lengths are in millimetres.
struct Stroke {
    bit: ToolBit,
    /// The bit's radius.
    radius: f32,
    /// The distance between rows.
    spacing: f32,
    /// The depth to which the bit is pressed into the visible stone.
    press: f32,
}

/// The first stroke removes the stone, the second what is left in the hollows. A newcomer presses deep to be
/// sure to touch.
const LARGE: Stroke = Stroke { bit: ToolBit::LargeBall, radius: 24.0, spacing: 36.0, press: 32.0 };
const MEDIUM: Stroke =
    Stroke { bit: ToolBit::MediumBall, radius: 15.0, spacing: 26.0, press: 22.0 };

/// A hand that works for two seconds and pauses for one. Lengths are in millimetres of the stone's box.
struct NaiveHand<'a, const N: usize, const K: usize>
where
    Grid<N>: Size,
{
    harness: &'a mut WorldHarness<N, K>,
    ticks: u32,
    place: Vec3,
    rotation: Quat,
    is_found: bool,
}

impl<const N: usize, const K: usize> NaiveHand<'_, N, K>
where
    Grid<N>: Size,
{
    const VOXEL_MM: f32 = BOX_MM / N as f32;

    fn take(&mut self, item: BenchItem) {
        take_item(self.harness, RIGHT, item);
        // A pause to look at the bench and back.
        (0..TICKS_PER_SECOND).for_each(|_| self.step(0));
    }

    fn step(&mut self, trigger: u8) {
        let input = input_with_bit_at(self.harness, self.place, self.rotation, trigger);
        self.harness.step(&input);
        self.is_found |= self.harness.world.events().contains(&WorldEvent::Found);
        self.ticks += 1;
    }

    /// Moves to a place with the trigger pulled, with pauses.
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

    /// Returns how far the stone reaches toward the hand at a place across a side; `None` if there is no
    /// stone.
    fn height(&self, side: Side, across: [f32; 2]) -> Option<f32> {
        let others = [1, 2].map(|i| (side.axis as usize + i) % 3);
        let mut voxel = [0; 3];
        for (other, at) in others.into_iter().zip(across) {
            voxel[other] = ((at / Self::VOXEL_MM).max(0.0) as usize).min(N - 1);
        }
        let address = side.axis.column_address(voxel);
        let hull = self.harness.world.volume().maps().column(side.axis, address).hull();
        let voxels =
            if side.is_from_below { -(hull.first() as f32) } else { (hull.last() + 1) as f32 };
        (!hull.is_empty()).then_some(voxels * Self::VOXEL_MM)
    }

    /// Returns the bit's place when pressed into the visible stone at a place across a side. Returns `None`
    /// if there is no stone, or if its surface is so oblique that a visitor would turn the stone first.
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
        // The stool limits the depth.
        Some(Vec3::from_array(place).max(Vec3::new(f32::MIN, 0.3 * radius, f32::MIN)))
    }

    /// Strokes a side in rows, back and forth.
    fn stroke_side(&mut self, side: Side, stroke: &Stroke) {
        let rows = (BOX_MM / stroke.spacing) as usize;
        let steps = (BOX_MM / 10.0) as usize;
        for row in 0..=rows {
            for step in 0..=steps {
                let step = if row % 2 == 0 { step } else { steps - step };
                let (along, aside) = (step as f32 * 10.0, row as f32 * stroke.spacing);
                // Level rows, if seen from a side.
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

    /// Saws off the four upright edges of the block: a level cut near the ground and then an upright cut, in
    /// rows of the blade's width.
    fn saw_edges_off(&mut self) {
        const BLADE: f32 = 70.0;
        const FROM_AXIS: f32 = 205.0;
        self.take(BenchItem::Bit(ToolBit::DiscSaw));
        for (x, z) in [(1.0, 1.0), (1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0)] {
            let out = Vec3::new(x, 0.0, z).normalize();
            let aside = Vec3::Y.cross(out);
            let axis = Vec3::new(BOX_MM / 2.0, 0.0, BOX_MM / 2.0);
            let level = axis + out * (FROM_AXIS + BLADE - 8.0) + Vec3::Y * 15.0;
            let upright = [385.0, 265.0, 145.0, 75.0].map(|y| axis + out * FROM_AXIS + Vec3::Y * y);
            self.saw(level, aside, Vec3::Y);
            upright.into_iter().for_each(|middle| self.saw(middle, aside, out));
        }
        self.rotation = Quat::IDENTITY;
    }

    /// Saws through the middle of a row, with the blade's plane of normal `normal`.
    fn saw(&mut self, middle: Vec3, aside: Vec3, normal: Vec3) {
        const HALF_ROW: f32 = 300.0;
        let pointing = -aside;
        self.rotation =
            Quat::from_mat3(&Mat3::from_cols(normal, normal.cross(pointing), -pointing));
        self.place = middle - aside * HALF_ROW;
        self.step(0);
        self.stroke_to(middle + aside * HALF_ROW);
    }
}

/// Returns the seconds until a figure is found in its stone, and the bared percentages after a bit has been
/// all around it.
fn find<const N: usize, const K: usize>(
    harness: &mut WorldHarness<N, K>,
    start: HiddenStart,
) -> (u32, Vec<u32>)
where
    Grid<N>: Size,
{
    harness.reset_to_hidden(start);
    let mode = SessionMode::Constrained { figure: 0 };
    harness.step(&TickInput { start: mode, ..TickInput::default() });
    take_item(harness, RIGHT, BenchItem::Tool(Tool::Rotary));
    let (place, rotation) = (Vec3::new(225.0, 300.0, 600.0), Quat::IDENTITY);
    let mut hand = NaiveHand { harness, ticks: 0, place, rotation, is_found: false };
    let mut strokes = vec![LARGE, MEDIUM, MEDIUM];
    if start.thickness == StoneThickness::Whole {
        hand.saw_edges_off();
        strokes.insert(0, LARGE);
        strokes.push(MEDIUM);
    }
    let mut percents = Vec::new();
    for stroke in strokes {
        hand.take(BenchItem::Bit(stroke.bit));
        for side in SIDES {
            hand.stroke_side(side, &stroke);
        }
        percents.push(hand.harness.world.bared_ends().percent());
    }
    let is_found = hand.is_found;
    let seconds = hand.ticks / TICKS_PER_SECOND;
    println!("{} at {N}: {seconds} s, {percents:?} %, found: {is_found}", start.name());
    (if is_found { seconds } else { u32::MAX }, percents)
}

/// Tests that the hand finds figures in time.
fn find_in_time<const N: usize, const K: usize>(
    harness: &Mutex<WorldHarness<N, K>>,
    starts: impl IntoIterator<Item = HiddenStart>,
    most_seconds: u32,
) where
    Grid<N>: Size,
{
    let mut harness = harness.lock().unwrap_or_else(PoisonError::into_inner);
    let late: Vec<_> = starts
        .into_iter()
        .map(|start| (start.name(), find(&mut harness, start)))
        .filter(|(_, (seconds, _))| *seconds > most_seconds)
        .collect();
    assert!(late.is_empty(), "not within {most_seconds} s at {N}: {late:?}");
}

fn hidden(thickness: StoneThickness) -> impl Iterator<Item = HiddenStart> {
    HiddenStart::ALL.into_iter().filter(move |start| start.thickness == thickness)
}

/// Tests one figure; the nightly run tests all of them.
#[test]
fn a_naive_hand_finds_figures_near_their_surface_in_three_minutes() {
    find_in_time(&HARNESS_128, hidden(StoneThickness::Near).take(scaled_cases(1) as usize), 180);
}

#[test]
#[ignore = "nightly: 84 s"]
fn a_naive_hand_finds_every_figure_of_fine_voxels_in_three_minutes() {
    find_in_time(&HARNESS_256, hidden(StoneThickness::Near), 180);
}

#[test]
fn a_naive_hand_finds_a_figure_of_coarse_voxels_in_the_whole_block_in_eight_minutes() {
    find_in_time(&HARNESS_64, hidden(StoneThickness::Whole).take(1), 480);
}

#[test]
#[ignore = "nightly: minutes"]
fn a_naive_hand_finds_every_figure_in_thicker_stone() {
    find_in_time(&HARNESS_128, hidden(StoneThickness::Half), 240);
    find_in_time(&HARNESS_128, hidden(StoneThickness::Whole), 480);
    find_in_time(&HARNESS_256, hidden(StoneThickness::Whole), 480);
}
