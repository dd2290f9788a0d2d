//! The float (a plasterer's tool) at work: it removes stone above its plane, fills pits below, and doesn't
//! build over edges.

use std::f32::consts::{PI, TAU};
use std::sync::{Mutex, PoisonError};

use glam::{Quat, Vec3};
use paros_core::TickInput;
use paros_core::session::{BenchItem, Tool, ToolBit, commands};
use paros_core::volume::{Grid, Size};
use paros_models::scripted_hand::{
    BOX_MM, RIGHT, input_with_bit_at, start_from_stone, take_item, volume_of,
};
use paros_models::world_harness::WorldHarness;

static SMALL: Mutex<WorldHarness<128, 2>> = Mutex::new(WorldHarness::new());
static LARGE: Mutex<WorldHarness<256, 2>> = Mutex::new(WorldHarness::new());

/// Half the float's thickness, in millimetres.
const FACE_MM: f32 = 7.0;

/// The height of the worked plane, equal to the top of flat stone: between two layers of voxels at 128.
const PLANE_MM: f32 = 64.0 * BOX_MM / 128.0;

/// A float in the right hand, working a stone. Lengths are in millimetres of the stone's box.
struct Float<'a, const N: usize>(&'a mut WorldHarness<N, 2>)
where
    Grid<N>: Size;

impl<'a, const N: usize> Float<'a, N>
where
    Grid<N>: Size,
{
    /// Holds the float at a stone made of all voxels whose centres satisfy `is_stone`.
    fn take(harness: &'a mut WorldHarness<N, 2>, is_stone: impl Fn(Vec3) -> bool) -> Self {
        start_from_stone(harness, is_stone);
        take_item(harness, RIGHT, BenchItem::Tool(Tool::Rasp));
        take_item(harness, RIGHT, BenchItem::Bit(ToolBit::Float));
        Float(harness)
    }

    fn step_at(&mut self, place: Vec3, rotation: Quat, trigger: u8) {
        let input = input_with_bit_at(self.0, place, rotation, trigger);
        self.0.step(&input);
    }

    /// Lays the float on the plane, pulls the trigger, and rubs once over the square of half-side `half`
    /// about `middle`, row by row. `pose` maps a place in the plane to the hand's pose in that tick.
    fn rub(&mut self, middle: [f32; 2], half: f32, pose: impl Fn(Vec3) -> (Vec3, Quat)) {
        let [x, z] = middle;
        let at = |dx: f32, dz: f32| Vec3::new(x + dx, PLANE_MM + FACE_MM, z + dz);
        (0..3).for_each(|_| self.step_at(at(-half, -half) + Vec3::Y * 60.0, Quat::IDENTITY, 0));
        (0..2).for_each(|_| self.step_at(at(-half, -half), Quat::IDENTITY, 255));
        let rows = (half / 8.0).ceil() as i32;
        for row in -rows..=rows {
            for i in -18..=18 {
                let along = half * i as f32 / 18.0 * if row % 2 == 0 { 1.0 } else { -1.0 };
                let (place, rotation) = pose(at(along, half * row as f32 / rows as f32));
                self.step_at(place, rotation, 255);
            }
        }
        (0..3).for_each(|_| self.step_at(at(half, half), Quat::IDENTITY, 0));
        (0..3).for_each(|_| self.step_at(at(half, half) + Vec3::Y * 80.0, Quat::IDENTITY, 0));
    }

    /// Returns the height of a column's stone above the plane, in millimetres.
    fn height_at(&self, x: f32, z: f32) -> f32 {
        let [x, z] = [x, z].map(|at| (at * N as f32 / BOX_MM) as usize);
        let rows = self.0.world.volume().rows();
        let top = (0..N).rev().find(|&y| rows.contains([x, y, z]));
        top.map_or(0.0, |top| (top + 1) as f32 * BOX_MM / N as f32) - PLANE_MM
    }

    /// Returns the lowest and the highest column within `half` of a place.
    fn heights_about(&self, [x, z]: [f32; 2], half: f32) -> [f32; 2] {
        let steps = -20..=20;
        let places = steps.clone().flat_map(|i| steps.clone().map(move |j| [i, j]));
        places.fold([f32::MAX, f32::MIN], |[lo, hi], step| {
            let [dx, dz] = step.map(|i| half * i as f32 / 20.0);
            let height = self.height_at(x + dx, z + dz);
            [lo.min(height), hi.max(height)]
        })
    }
}

const IN_PLANE: fn(Vec3) -> (Vec3, Quat) = |place| (place, Quat::IDENTITY);

/// Returns `true` inside rough stone, with bumps up to 7 mm high, and pits as deep and up to 40 mm wide.
fn is_rough_stone(at: Vec3) -> bool {
    let wave = |v: f32| (v * TAU / 60.0).sin();
    at.y < PLANE_MM + 7.0 * wave(at.x) * wave(at.z)
}

fn check_flat<const N: usize>(
    harness: &Mutex<WorldHarness<N, 2>>,
    pose: impl Fn(Vec3) -> (Vec3, Quat),
) where
    Grid<N>: Size,
{
    let mut harness = harness.lock().unwrap_or_else(PoisonError::into_inner);
    let mut float = Float::take(&mut harness, is_rough_stone);
    let middle = [225.0, 225.0];
    let before = float.heights_about(middle, 40.0);
    float.rub(middle, 50.0, pose);
    let after = float.heights_about(middle, 40.0);
    let voxel = BOX_MM / N as f32;
    println!("{N}: {before:?} mm, then {after:?}");
    assert!(before[0] < -4.0 && before[1] > 4.0, "{before:?}");
    assert!(after[0] >= -0.51 * voxel && after[1] <= 0.51 * voxel, "{N}: {after:?}");
}

#[test]
fn bumps_go_and_pits_fill_to_the_plane() {
    check_flat(&SMALL, IN_PLANE);
    check_flat(&LARGE, IN_PLANE);
}

/// The plane stays as it was at the trigger's pull, whatever the hand does while it rubs.
#[test]
fn the_plane_stays_as_it_was_at_the_pull() {
    let unsteady = |place: Vec3| {
        let turn = 0.15 * (place.x * 0.11).sin();
        let aside = Vec3::Y * (3.0 * (place.x * 0.07).cos());
        (place + aside, Quat::from_rotation_z(turn) * Quat::from_rotation_x(-turn))
    };
    check_flat(&SMALL, unsteady);
}

/// Nothing is laid over a block's edge, beside a falling slope, or in a gap without a floor.
#[test]
fn it_builds_on_no_edge() {
    let mut harness = LARGE.lock().unwrap_or_else(PoisonError::into_inner);
    let is_gap = |at: Vec3| (at.x - 225.0).abs() < 6.0 && at.y > 100.0;
    let is_block = |at: Vec3| at.y < PLANE_MM && at.x < 260.0 && !is_gap(at);
    let mut float = Float::take(&mut harness, is_block);
    let before = volume_of(float.0);
    float.rub([250.0, 225.0], 40.0, IN_PLANE);
    let after = volume_of(float.0);
    assert_eq!(after.difference(&before).count(), 0, "was laid on an edge or over a gap");
    // The top layer lies within the plane.
    assert_eq!(before.difference(&after).count(), 0, "was taken off");
    let is_ball = |at: Vec3| at.distance(Vec3::new(225.0, PLANE_MM - 139.0, 225.0)) < 140.0;
    let mut float = Float::take(&mut harness, is_ball);
    let before = volume_of(float.0);
    float.rub([225.0, 225.0], 40.0, IN_PLANE);
    let laid = volume_of(float.0).difference(&before).count();
    assert!(laid < 40, "{laid} voxels were laid on a ball");
}

/// A float that touches the stone with its other face works that face's plane; its mirror image works the
/// mirrored plane.
#[test]
fn either_face_works_and_its_image_alike() {
    let mut harness = SMALL.lock().unwrap_or_else(PoisonError::into_inner);
    let mut rub = |x: f32, tilt: f32, turn: f32| {
        let mut float = Float::take(&mut harness, is_mirrored_stone);
        float.0.step(&TickInput { commands: commands::SYMMETRY, ..TickInput::default() });
        let before = volume_of(float.0);
        float.rub_tilted(x, tilt, turn);
        let after = volume_of(float.0);
        assert!(after == after.mirrored_in_x(), "{x}, {turn}");
        let removed = before.difference(&after).count();
        assert!(removed > 200 && removed < 6000, "{removed} at {x}, {turn}");
        after
    };
    let lower = rub(110.0, 0.1, 0.0);
    let turned_over = rub(110.0, 0.1, PI);
    let upper = rub(BOX_MM - 110.0, -0.1, 0.0);
    for (name, other) in [("turned over", turned_over), ("in the upper half", upper)] {
        let unlike = lower.difference(&other).count() + other.difference(&lower).count();
        assert!(unlike < 40, "{unlike} voxels are not alike {name}");
    }
}

/// Returns `true` inside wavy stone that is symmetric about the middle.
fn is_mirrored_stone(at: Vec3) -> bool {
    let x = (at.x - 0.5 * BOX_MM).abs();
    at.y < PLANE_MM + 4.0 * (x * 0.2).sin()
}

impl<const N: usize> Float<'_, N>
where
    Grid<N>: Size,
{
    /// Rubs along z with the face inclined across the path.
    fn rub_tilted(&mut self, x: f32, tilt: f32, turn: f32) {
        let tilt = Quat::from_rotation_z(tilt + turn);
        let at = |z: f32| Vec3::new(x, PLANE_MM + FACE_MM - 1.0, z);
        (0..3).for_each(|_| self.step_at(at(150.0) + Vec3::Y * 60.0, tilt, 0));
        for i in 0..60 {
            self.step_at(at(150.0 + 2.0 * i as f32), tilt, 255);
        }
        (0..3).for_each(|_| self.step_at(at(270.0), tilt, 0));
    }
}
