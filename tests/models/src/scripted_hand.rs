//! Scripted input: single actions of a hand, for tests of one scenario.

use glam::{Quat, Vec3};
use paros_core::edit::Pose;
use paros_core::session::{BenchItem, PointerCommand, RawPose};
use paros_core::volume::{Grid, Size};
use paros_core::{HandInput, TickInput, WorldEvent};

use crate::dense::DenseVolume;
use crate::world_harness::WorldHarness;

/// The left hand.
pub const LEFT: usize = 0;
/// The right hand.
pub const RIGHT: usize = 1;

/// Returns the input of a tracked hand at a position of the room, pointing along -z, with nothing pressed.
pub fn hand_input_at(room_position: Vec3) -> HandInput {
    let pose = RawPose::quantise(room_position, Quat::IDENTITY);
    HandInput { aim: pose, grip: pose, tracked: true, ..HandInput::default() }
}

/// Returns a tick's input with one hand; the other hand isn't tracked.
pub fn input_with_hand(hand: usize, input: HandInput) -> TickInput {
    let mut all = TickInput::default();
    all.hands[hand] = input;
    all
}

/// Runs two ticks: a squeeze at a position of the room, and its release. Returns the squeeze's events.
pub fn squeeze_and_release<const N: usize, const K: usize>(
    harness: &mut WorldHarness<N, K>,
    hand: usize,
    room_position: Vec3,
) -> Vec<WorldEvent>
where
    Grid<N>: Size,
{
    harness
        .step(&input_with_hand(hand, HandInput { squeeze: 255, ..hand_input_at(room_position) }));
    let events = harness.world.events().to_vec();
    harness.step(&input_with_hand(hand, hand_input_at(room_position)));
    events
}

/// Runs a tick in which the pointer puts an item into a hand.
pub fn take_item<const N: usize, const K: usize>(
    harness: &mut WorldHarness<N, K>,
    hand: usize,
    item: BenchItem,
) where
    Grid<N>: Size,
{
    let pointer = PointerCommand::Take { hand: hand as u8, item: item.number() as u8 };
    harness.step(&TickInput { pointer, ..TickInput::default() });
}

/// Side of the stone's box in millimetres.
pub const BOX_MM: f32 = 450.0;

/// Starts a session from the voxels whose centres satisfy `is_stone`, in millimetres of the stone's box.
pub fn start_from_stone<const N: usize, const K: usize>(
    harness: &mut WorldHarness<N, K>,
    is_stone: impl Fn(Vec3) -> bool,
) where
    Grid<N>: Size,
{
    let voxel = BOX_MM / N as f32;
    harness.start_from_voxels(|place| {
        is_stone((Vec3::from_array(place.map(|i| i as f32)) + 0.5) * voxel)
    });
}

/// Returns the input of a tick with the right hand's bit at a place in millimetres of the stone's box.
pub fn input_with_bit_at<const N: usize, const K: usize>(
    harness: &WorldHarness<N, K>,
    place_mm: Vec3,
    rotation: Quat,
    trigger: u8,
) -> TickInput
where
    Grid<N>: Size,
{
    let pose = Pose { position: place_mm * (N as f32 / BOX_MM), rotation };
    input_with_bit(harness, RIGHT, &pose, trigger)
}

/// Returns the input of a tick with a hand's bit at a pose of the grid.
fn input_with_bit<const N: usize, const K: usize>(
    harness: &WorldHarness<N, K>,
    hand: usize,
    pose: &Pose,
    trigger: u8,
) -> TickInput
where
    Grid<N>: Size,
{
    input_with_hand(hand, HandInput { trigger, ..harness.world.hand_with_bit_at(hand, pose) })
}

/// Runs a tick with the held bit at a position of the grid, and the trigger pulled or not.
pub fn step_with_bit_at<const N: usize, const K: usize>(
    harness: &mut WorldHarness<N, K>,
    hand: usize,
    grid_position: Vec3,
    trigger_down: bool,
) where
    Grid<N>: Size,
{
    let pose = Pose { position: grid_position, rotation: Quat::IDENTITY };
    let input = input_with_bit(harness, hand, &pose, if trigger_down { 255 } else { 0 });
    harness.step(&input);
}

/// Runs a stroke of `ticks` ticks between two positions of the grid with the trigger pulled, then lifts the
/// bit by 40 voxels.
pub fn run_stroke<const N: usize, const K: usize>(
    harness: &mut WorldHarness<N, K>,
    hand: usize,
    grid_start: Vec3,
    grid_end: Vec3,
    ticks: u32,
) where
    Grid<N>: Size,
{
    step_with_bit_at(harness, hand, grid_start, false);
    for i in 1..=ticks {
        step_with_bit_at(harness, hand, grid_start.lerp(grid_end, i as f32 / ticks as f32), true);
    }
    step_with_bit_at(harness, hand, grid_end, false);
    step_with_bit_at(harness, hand, grid_end + Vec3::Y * 40.0, false);
}

/// Starts a session from a floor of stone with a thickness in voxels.
pub fn start_from_floor<const N: usize, const K: usize>(
    harness: &mut WorldHarness<N, K>,
    thickness: usize,
) where
    Grid<N>: Size,
{
    harness.start_from_voxels(|[_, y, _]| y < thickness);
}

/// Returns the world's volume as the model's set of voxels.
pub fn volume_of<const N: usize, const K: usize>(harness: &WorldHarness<N, K>) -> DenseVolume
where
    Grid<N>: Size,
{
    DenseVolume::from_bits(harness.world.volume().rows())
}
