//! The disc saw at work: pieces cut off fall, however the saw is held; a slot is as wide as the blade; walls
//! and masks stop it.

use std::f32::consts::TAU;
use std::sync::{Mutex, PoisonError};

use glam::{IVec3, Mat3, Quat, Vec3};
use paros_core::session::{BenchItem, SessionMode, Tool, ToolBit};
use paros_core::volume::{BitSet, Grid, Size};
use paros_core::{TickInput, WorldEvent};
use paros_models::cases::sample_cases;
use paros_models::dense::DenseVolume;
use paros_models::scripted_hand::{
    BOX_MM, RIGHT, input_with_bit_at, start_from_stone, take_item, volume_of,
};
use paros_models::world_harness::WorldHarness;

static SMALL: Mutex<WorldHarness<128, 2>> = Mutex::new(WorldHarness::new());
static LARGE: Mutex<WorldHarness<256, 2>> = Mutex::new(WorldHarness::new());

const TICKS_PER_SECOND: f32 = 72.0;
const BLADE_MM: f32 = 70.0;

/// A saw in the right hand, at a stone. Lengths are in millimetres, of the stone's box.
struct Saw<'a, const N: usize>
where
    Grid<N>: Size,
{
    harness: &'a mut WorldHarness<N, 2>,
    /// Number of voxels removed by the island search.
    fallen: u32,
}

/// A straight cut: the blade's centre moves from one place to another, and its plane contains its path and
/// points towards `depth`.
struct Cut {
    from: Vec3,
    to: Vec3,
    depth: Vec3,
}

impl<'a, const N: usize> Saw<'a, N>
where
    Grid<N>: Size,
{
    /// Holds the saw at a stone made of all voxels whose centres satisfy `is_stone`.
    fn take(harness: &'a mut WorldHarness<N, 2>, is_stone: impl Fn(Vec3) -> bool) -> Self {
        start_from_stone(harness, is_stone);
        take_item(harness, RIGHT, BenchItem::Tool(Tool::Rotary));
        take_item(harness, RIGHT, BenchItem::Bit(ToolBit::DiscSaw));
        Saw { harness, fallen: 0 }
    }

    fn step_at(&mut self, place: Vec3, rotation: Quat, trigger: u8) {
        let input = input_with_bit_at(self.harness, place, rotation, trigger);
        self.step(&input);
    }

    fn step(&mut self, input: &TickInput) {
        self.harness.step(input);
        for event in self.harness.world.events() {
            if let WorldEvent::Islands(report) = event {
                self.fallen += report.removed;
            }
        }
    }

    /// Saws at a speed in mm/s, then lifts the blade.
    fn cut(&mut self, Cut { from, to, depth }: &Cut, speed: f32) {
        let (ahead, depth) = ((*to - *from).normalize(), depth.normalize());
        let rotation = Quat::from_mat3(&Mat3::from_cols(depth.cross(ahead), depth, ahead));
        // Comes from above, where the hand was last lifted to.
        (0..4).for_each(|_| self.step_at(*from + Vec3::Y * 250.0, rotation, 0));
        (0..4).for_each(|_| self.step_at(*from, rotation, 0));
        let ticks = (from.distance(*to) / speed * TICKS_PER_SECOND).ceil() as u32;
        for tick in 0..=ticks {
            self.step_at(from.lerp(*to, tick as f32 / ticks as f32), rotation, 255);
        }
        (0..8).for_each(|_| self.step_at(*to, rotation, 0));
        (0..4).for_each(|_| self.step_at(*to + Vec3::Y * 250.0, rotation, 0));
    }

    fn count_stone(&self, is_counted: impl Fn(Vec3) -> bool) -> usize {
        let rows = self.harness.world.volume().rows();
        let voxel = BOX_MM / N as f32;
        let all = (0..N).flat_map(|y| (0..N).map(move |z| (y, z)));
        all.map(|(y, z)| {
            let middle = |x: usize| (Vec3::new(x as f32, y as f32, z as f32) + 0.5) * voxel;
            rows.row(y, z).iter_ones().filter(|&x| is_counted(middle(x))).count()
        })
        .sum()
    }
}

/// The stone of [`check_two_cuts`]: a drum, which looks the same at every rotation of the stool.
const DRUM_RADIUS: f32 = 150.0;
const DRUM_HEIGHT: f32 = 225.0;

/// The hold of the blade for two cuts, from the side and from above.
struct Hold {
    /// The stool's rotation.
    turn: f32,
    /// The blade's inclination from level and from upright.
    tilt: f32,
    is_from_side_first: bool,
    /// The speed in mm/s.
    speed: f32,
}

/// Asserts that two cuts free a piece of the drum's rim 60 mm wide and high.
fn check_two_cuts<const N: usize>(harness: &mut WorldHarness<N, 2>, hold: &Hold)
where
    Grid<N>: Size,
{
    let &Hold { turn, tilt, is_from_side_first, speed } = hold;
    const PIECE: f32 = 60.0;
    let middle = Vec3::new(0.5 * BOX_MM, 0.0, 0.5 * BOX_MM);
    let from_middle = |p: Vec3| (p - middle).with_y(0.0).length();
    let mut saw = Saw::take(harness, |p| p.y < DRUM_HEIGHT && from_middle(p) < DRUM_RADIUS);
    // In the hand's frame, x points outward and z along the path. Both planes are tilted about the path, and
    // so is the path.
    let frame = Quat::from_rotation_y(turn) * Quat::from_rotation_x(0.3 * tilt);
    let place =
        |x: f32, y: f32, z: f32| middle + Vec3::Y * DRUM_HEIGHT + frame * Vec3::new(x, y, z);
    let half_way = DRUM_RADIUS + BLADE_MM;
    let inner = DRUM_RADIUS - PIECE;
    // Each plane contains the line where the planes meet, and reaches beyond it.
    let reach = BLADE_MM - PIECE - 20.0;
    let down = Quat::from_rotation_z(tilt) * Vec3::NEG_Y;
    let upright = |z: f32| place(inner, -PIECE, z) - frame * down * (PIECE + reach);
    let inward = Quat::from_rotation_z(tilt) * Vec3::NEG_X;
    let level = |z: f32| place(inner, -PIECE, z) - frame * inward * (PIECE + reach);
    let from_above = Cut { from: upright(-half_way), to: upright(half_way), depth: frame * down };
    let from_side = Cut { from: level(half_way), to: level(-half_way), depth: frame * inward };
    let [first, second] = match is_from_side_first {
        true => [&from_side, &from_above],
        false => [&from_above, &from_side],
    };
    let what = format!("{N}: turned {turn}, tilted {tilt}, side first {is_from_side_first}");
    saw.cut(first, speed);
    assert!(saw.fallen < 10, "{what}: one cut frees but crumbs");
    saw.cut(second, speed);
    (0..24).for_each(|_| saw.step(&TickInput::default()));
    // Everything clear of both slots has fallen.
    let is_piece = |p: Vec3| {
        let here =
            frame.inverse() * (p - middle - Vec3::Y * DRUM_HEIGHT) - Vec3::new(inner, -PIECE, 0.0);
        let here = Quat::from_rotation_z(-tilt) * here;
        here.x > 0.0 && here.y > 0.0
    };
    let left = saw.count_stone(is_piece);
    assert_eq!(left, 0, "{what}: it hangs");
    let piece_voxels = 600_000.0 / (BOX_MM / N as f32).powi(3);
    let fallen = saw.fallen as f32 / piece_voxels;
    assert!((0.7..1.1).contains(&fallen), "{what}: {fallen} of the piece fell");
}

/// Tests all rotations of the stool with hands ten degrees off. A fourth of the rotations is tested; the
/// nightly run tests all.
fn check_turns<const N: usize>(harness: &Mutex<WorldHarness<N, 2>>, turns: u32)
where
    Grid<N>: Size,
{
    let harness = &mut *harness.lock().unwrap_or_else(PoisonError::into_inner);
    let ten_degrees = 10f32.to_radians();
    for i in sample_cases(0..turns, 4) {
        let turn = TAU * (i as f32 + 0.13) / turns as f32;
        let tilt = [ten_degrees, -ten_degrees, 0.0][i as usize % 3];
        let speed = [300.0, 600.0][i as usize / 3 % 2];
        check_two_cuts(harness, &Hold { turn, tilt, is_from_side_first: true, speed });
        // On a finer grid, at some rotations, two intervals a column can't represent a level slot below a
        // slot from above.
        if N == 128 {
            check_two_cuts(harness, &Hold { turn, tilt, is_from_side_first: false, speed });
        }
    }
    check_two_cuts(harness, &Hold { turn: 0.0, tilt: 0.0, is_from_side_first: true, speed: 300.0 });
}

#[test]
fn two_cuts_free_a_block_at_128() {
    check_turns(&SMALL, 16);
}

#[test]
fn two_cuts_free_a_block_at_256() {
    check_turns(&LARGE, 12);
}

/// Sideways, a wall stops a running blade like any other bit: in a tick it removes less than a voxel for each
/// of its bites, and it never gets through. A blade at rest stops where it touches the wall.
#[test]
fn a_blade_is_held_sideways_by_a_wall() {
    let harness = &mut *SMALL.lock().unwrap_or_else(PoisonError::into_inner);
    for trigger in [0, 255] {
        let mut saw = Saw::take(harness, |p| (200.0..250.0).contains(&p.x) && p.y < 300.0);
        let at = |x: f32| Vec3::new(x, 200.0, 225.0);
        saw.step_at(at(150.0), Quat::IDENTITY, 0);
        saw.step_at(at(190.0), Quat::IDENTITY, trigger);
        // A running blade needs the first two ticks to reach the wall.
        (0..3).for_each(|_| saw.step_at(at(320.0), Quat::IDENTITY, trigger));
        let bit = saw.harness.world.hand_state(RIGHT).frozen_pose.position.x * BOX_MM / 128.0;
        let most = if trigger == 0 { 203.6 } else { 203.6 + 8.0 * 3.6 };
        assert!((195.0..most).contains(&bit), "trigger {trigger}: at {bit} mm");
    }
}

/// A saw that passes over a hidden figure leaves it whole.
#[test]
fn a_saw_never_takes_the_figure() {
    let harness = &mut *SMALL.lock().unwrap_or_else(PoisonError::into_inner);
    let voxel = BOX_MM / 128.0;
    let middle = Vec3::new(225.0, 120.0, 225.0);
    let in_ball = |p: Vec3| p.distance(middle) < 60.0;
    let all = |is_in: &dyn Fn(Vec3) -> bool| {
        DenseVolume::from_fn(128, |at| is_in((IVec3::from_array(at).as_vec3() + 0.5) * voxel))
    };
    let stone = all(&|p| in_ball(p) || p.y < 225.0 && p.x > 100.0);
    let figure = all(&in_ball).closure();
    harness.reset_to_voxels(&stone.union(&figure).closure(), &figure);
    harness
        .step(&TickInput { start: SessionMode::Constrained { figure: 0 }, ..TickInput::default() });
    take_item(harness, RIGHT, BenchItem::Tool(Tool::Rotary));
    take_item(harness, RIGHT, BenchItem::Bit(ToolBit::DiscSaw));
    let mut saw = Saw { harness, fallen: 0 };
    for (x, speed) in [(190.0, 300.0), (225.0, 1000.0), (240.0, 600.0)] {
        let [from, to] = [0.0, 450.0].map(|z| Vec3::new(x, 190.0, z));
        saw.cut(&Cut { from, to, depth: Vec3::new(0.1, -1.0, 0.0).normalize() }, speed);
    }
    let left = volume_of(saw.harness);
    assert!(figure.is_within(&left), "{:?}", figure.difference(&left));
    assert!(left.occupied().count() < stone.occupied().count() - 3000, "nothing was sawn");
}
