//! A steadied hand: a string draws the running bit behind the hand, so that a trembling hand cuts a smooth
//! groove.

use std::f32::consts::TAU;
use std::sync::{Mutex, MutexGuard, PoisonError};

use glam::Vec3;
use paros_core::TickInput;
use paros_core::internals::BOX_SIDE;
use paros_core::session::{BenchItem, PointerCommand, SessionMode, TICK_RATE, Tool};
use paros_models::dense::DenseVolume;
use paros_models::save_layout::save_to_vec;
use paros_models::scripted_hand::{
    RIGHT, start_from_floor, step_with_bit_at, take_item, volume_of,
};
use paros_models::world_harness::WorldHarness;

const N: usize = 256;
type Harness = WorldHarness<N, 2>;

/// A millimetre in voxels.
const MM: f32 = N as f32 / (BOX_SIDE * 1e3);
const FACE: f32 = N as f32 / 2.0;
const MIDDLE: f32 = N as f32 / 2.0 + 0.3;

/// Starts with half the stone, and the medium ball in the right hand, which is steadied by a string.
fn start(string_mm: u8) -> MutexGuard<'static, Harness> {
    static WORLD: Mutex<Harness> = Mutex::new(WorldHarness::new());
    let mut harness = WORLD.lock().unwrap_or_else(PoisonError::into_inner);
    start_from_floor(&mut harness, N / 2);
    take_item(&mut harness, RIGHT, BenchItem::Tool(Tool::Rotary));
    steady(&mut harness, string_mm);
    harness
}

fn steady(harness: &mut Harness, string_mm: u8) {
    let pointer = PointerCommand::Steady { string_mm };
    harness.step(&TickInput { pointer, ..TickInput::default() });
}

/// Draws a groove half a ball deep along z at 0.2 m/s with a hand that trembles across it. Returns the voxels
/// cut.
fn cut_trembling(string_mm: u8, amplitude_mm: f32) -> DenseVolume {
    let harness = &mut *start(string_mm);
    let before = volume_of(harness);
    let speed = 200.0 * MM / TICK_RATE as f32;
    for tick in 0..110 {
        // The hand is on the line when the trigger is pulled, which removes the string's slack.
        let seconds = (tick as f32 - 1.0) / TICK_RATE as f32;
        let trembles = (TAU * 8.0 * seconds).sin() * amplitude_mm * MM;
        let at = Vec3::new(MIDDLE + trembles, FACE, 25.0 + speed * tick as f32);
        step_with_bit_at(harness, RIGHT, at, tick > 0);
    }
    let last = 25.0 + speed * 109.0;
    (0..20).for_each(|_| step_with_bit_at(harness, RIGHT, Vec3::new(MIDDLE, FACE, last), true));
    before.difference(&volume_of(harness))
}

/// Returns the peak-to-peak wobble of the groove's centre line on the face, in millimetres.
fn wobble_mm(cut: &DenseVolume) -> f32 {
    let middles = (70..150).map(|z| {
        let open = (0..N as i32).filter(|&x| cut.contains([x, N as i32 / 2 - 1, z]));
        let (sum, count) = open.fold((0, 0), |(sum, count), x| (sum + x, count + 1));
        sum as f32 / count as f32
    });
    let (least, most) =
        middles.fold((f32::MAX, f32::MIN), |(lo, hi), middle| (lo.min(middle), hi.max(middle)));
    (most - least) / MM
}

#[test]
fn a_trembling_hand_on_a_string_cuts_a_groove_that_wobbles_a_quarter_as_much() {
    let (free, steadied) = (cut_trembling(0, 3.0), cut_trembling(20, 3.0));
    let wobbles = [&free, &steadied].map(wobble_mm);
    println!("wobbles {wobbles:?} mm");
    assert!(wobbles[0] > 4.0 && wobbles[1] <= wobbles[0] / 4.0, "{wobbles:?}");
    // No voxel beside the groove is cut: none is farther from the line than the ball's radius and a quarter
    // of the amplitude.
    let most = (15.0 + 3.0 / 4.0) * MM;
    for voxel in steadied.occupied() {
        let aside = (voxel[0] as f32 + 0.5 - MIDDLE).abs();
        assert!(aside < most, "{voxel:?} is {} mm from the line", aside / MM);
    }
    // The bit follows the hand except for the string's length: 109 ticks at 0.2 m/s.
    let ends = |cut: &DenseVolume| cut.occupied().map(|at| at[2]).max().unwrap_or(0);
    let short = (ends(&free) - ends(&steadied)) as f32 / MM;
    assert!((18.0..22.0).contains(&short), "{short} mm shorter");
}

/// A slack string keeps the bit in place, and releasing the trigger moves it back to the hand.
#[test]
fn the_bit_stays_while_the_string_is_slack_and_is_the_hands_when_it_is_released() {
    let harness = &mut *start(10);
    let at = |mm: f32| Vec3::new(MIDDLE + mm * MM, FACE + 40.0, MIDDLE);
    let bit_mm =
        |harness: &Harness| (harness.world.hand_state(RIGHT).raw_pose.position.x - MIDDLE) / MM;
    let step_to = |harness: &mut Harness, mm: f32, pulled: bool, expected: f32| {
        step_with_bit_at(harness, RIGHT, at(mm), pulled);
        let found = bit_mm(harness);
        assert!((found - expected).abs() < 0.1, "{found} mm with the hand at {mm}, not {expected}");
    };
    step_to(harness, 0.0, false, 0.0);
    step_to(harness, 8.0, false, 8.0);
    step_to(harness, 0.0, true, 0.0);
    step_to(harness, 9.0, true, 0.0);
    step_to(harness, -9.0, true, 0.0);
    step_to(harness, 14.0, true, 4.0);
    step_to(harness, 5.0, true, 4.0);
    step_to(harness, 5.0, false, 5.0);
    step_to(harness, 12.0, true, 12.0);
    let push_out = harness.world.push_out_metres(RIGHT);
    assert!(push_out.length() < 1e-4, "{push_out}");
    step_to(harness, 22.0, true, 12.0);
    let push_out = harness.world.push_out_metres(RIGHT).length();
    assert!((push_out - 0.010).abs() < 2e-4, "it is drawn where it is: {push_out}");
}

#[test]
fn a_string_is_saved_no_longer_than_it_may_be_and_gone_with_the_next_start() {
    let harness = &mut *start(0);
    let before = harness.world.digest();
    let saved = save_to_vec(&harness.world);
    steady(harness, 255);
    assert_eq!(harness.world.string_mm(), 40);
    let steadied = save_to_vec(&harness.world);
    harness.world.load(&saved).expect("a save");
    assert_eq!((harness.world.string_mm(), harness.world.digest()), (0, before));
    harness.world.load(&steadied).expect("a save");
    assert_eq!(harness.world.string_mm(), 40);
    harness.step(&TickInput { start: SessionMode::Own, ..TickInput::default() });
    assert_eq!(harness.world.string_mm(), 0);
}
