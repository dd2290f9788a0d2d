//! Model of the stool's rotation: by sticks, by hands on its rim, and by the pointer.

use glam::{Quat, Vec3};
use paros_core::TickInput;
use paros_core::internals::{STOOL_RADIUS, STOOL_TOP};
use paros_core::session::{PointerCommand, RawPose, TICK_RATE};

use crate::step::StepModel;
use crate::step::hand_input::HandPresses;

/// Greatest distance from the rim at which a hand grabs it, in metres.
const REACH: f32 = 0.12;

/// Least distance from the axis at which a hand has a bearing, in metres.
const LEAST_RADIUS: f32 = 0.05;

/// Returns `true` if a hand's grip is at the horizontal rim.
pub(super) fn is_at_rim(grip: Vec3) -> bool {
    let outward = ((grip.x - STOOL_TOP.x).powi(2) + (grip.z - STOOL_TOP.z).powi(2)).sqrt();
    (outward - STOOL_RADIUS).hypot(grip.y - STOOL_TOP.y) < REACH
}

/// Returns the angle by which a hand's path leads round the axis, in 65,536ths of a turn, counter-clockwise
/// from above.
pub(super) fn turn_of_way(from: Vec3, to: Vec3) -> i32 {
    let [before, after] = [from, to].map(|at| at - STOOL_TOP);
    if [before, after].iter().any(|at| at.x.hypot(at.z) < LEAST_RADIUS) {
        return 0;
    }
    let turned = [before, after].map(|at| {
        let part = f64::from(-at.z).atan2(f64::from(at.x)) / core::f64::consts::TAU;
        (part * 65_536.0).round() as i32
    });
    (turned[1] - turned[0] + 32_768).rem_euclid(65_536) - 32_768
}

/// Adds a hold of the rim to a hand's input: the hand returns its tool in tick 0 and then moves round the
/// rim, squeezed, by `by` 65,536ths of a turn a tick, `above` centimetres above it.
pub(super) fn add_hold(input: &mut TickInput, hand: usize, by: i16, above: i8, tick: u8) {
    let held = &mut input.hands[hand];
    let turned = f32::from(by) * f32::from(tick) / 65_536.0 * core::f32::consts::TAU;
    let (sine, cosine) = turned.sin_cos();
    let outward = Vec3::new(cosine, 0.0, -sine) * STOOL_RADIUS;
    let place = STOOL_TOP + outward + Vec3::Y * f32::from(above) * 0.01;
    held.grip = RawPose::quantise(place, Quat::IDENTITY);
    (held.aim, held.trigger) = (held.grip, 0);
    match tick {
        0 => input.pointer = PointerCommand::Return { hand: hand as u8 },
        _ => held.squeeze = 255,
    }
}

impl<const K: usize> StepModel<K> {
    /// Turns the stool. Each tracked hand's stick turns it at most a quarter turn a second; the mean of the
    /// paths of the hands that hold it, at most a quarter turn; the pointer turns it as well.
    pub(super) fn turn_stool(&mut self, input: &TickInput, presses: &[HandPresses; 2]) {
        let mut turn = 0;
        for (hand, state) in input.hands.iter().zip(&self.hands) {
            let push = i32::from(hand.stick[0]);
            if state.tracked && push.abs() > 30 {
                turn += push * 16_384 / (127 * TICK_RATE as i32);
            }
        }
        let ways = (0..2).filter(|&hand| self.hands[hand].holds_stool);
        let ways: Vec<i32> = ways.map(|hand| presses[hand].rim_turn).collect();
        if !ways.is_empty() {
            let mean = ways.iter().sum::<i32>() / ways.len() as i32;
            turn += mean.clamp(-227, 227);
        }
        if let PointerCommand::Turn { by } = input.pointer {
            turn += i32::from(by);
        }
        self.stool = (i32::from(self.stool) + turn).rem_euclid(65_536) as u16;
    }
}
