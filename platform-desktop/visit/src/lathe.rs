//! What the studio does while nobody is there: the stone turns, and a hand turns a vase out of it.
//!
//! A function of the ticks since it began and of the tool that the world has put into the hand; so a trace holds what
//! was done, as of any visitor.

use core::f32::consts::TAU;

use glam::{Quat, Vec3};
use paros_core::internals::{BOX_SIDE, STOOL_TOP};
use paros_core::session::{BenchItem, PointerCommand, RawPose, TICK_RATE, Tool, ToolBit};
use paros_core::volume::{Grid, Size};
use paros_core::{HandInput, TickInput, World};

/// The hand that works: the right one.
const HAND: usize = 1;

/// Of the bit, a roughing ball of its natural size, in metres.
const BIT_RADIUS: f32 = 0.04;

/// Turn of the stool in a tick, in 65,536ths of a turn: at the block's corners that is half a metre a second.
const TURN: i16 = 340;

/// Ticks of a turn.
const TURN_TICKS: f32 = 65_536.0 / TURN as f32;

/// Metres that the bit comes down in a turn: less than the bit is wide, so that no ridge stays.
const PITCH: f32 = 0.026;

/// Metres between one pass and the next.
const PASS_DEPTH: f32 = 0.036;

/// Passes: the last one is on the vase itself.
const PASSES: u32 = 4;

/// Ticks for which the vase is shown before another is begun.
const SHOWN_TICKS: u32 = 8 * TICK_RATE;

/// Heights above the stool at which a pass begins and ends, in metres.
const HEIGHTS: [f32; 2] = [BOX_SIDE, 0.03];

/// Radii of the vase from its foot to its lip, in metres, at even heights.
const PROFILE: [f32; 9] = [0.085, 0.11, 0.15, 0.172, 0.17, 0.14, 0.095, 0.075, 0.1];

/// The side of the stone from which it works, in radians from the visitor to the right.
const AZIMUTH: f32 = 0.9;

/// The hand at its work.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct LatheHand {
    tick: u32,
}

impl LatheHand {
    /// Ticks of a pass.
    fn pass_ticks() -> u32 {
        ((HEIGHTS[0] - HEIGHTS[1]) / PITCH * TURN_TICKS) as u32
    }

    /// Ticks after which the vase is done.
    pub(crate) fn work_ticks() -> u32 {
        PASSES * Self::pass_ticks()
    }

    /// Whether the vase is done, and has been shown.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.tick >= Self::work_ticks() + SHOWN_TICKS
    }

    /// Puts the work of the next tick into its input, in place of who may be there.
    pub fn fill_input<const N: usize, const K: usize>(
        &mut self,
        world: &World<N, K>,
        input: &mut TickInput,
    ) where
        Grid<N>: Size,
    {
        let tick = self.tick;
        self.tick += 1;
        input.hands = [HandInput::default(); 2];
        input.commands = 0;
        let take =
            |item: BenchItem| PointerCommand::Take { hand: HAND as u8, item: item.number() as u8 };
        input.pointer = match tick {
            0 => take(BenchItem::Tool(Tool::Rotary)),
            1 => take(BenchItem::Bit(ToolBit::RoughingBall)),
            _ => PointerCommand::Turn { by: TURN },
        };
        let pass = tick / Self::pass_ticks();
        if pass >= PASSES {
            return;
        }
        let Some((tool, _)) = world.held_tool(HAND) else { return };
        let part = (tick % Self::pass_ticks()) as f32 / Self::pass_ticks() as f32;
        let height = HEIGHTS[0] + (HEIGHTS[1] - HEIGHTS[0]) * part;
        let clear = (PASSES - 1 - pass) as f32 * PASS_DEPTH;
        let outward = Quat::from_rotation_y(AZIMUTH) * Vec3::Z;
        let axis = STOOL_TOP + Vec3::Y * height;
        let tip = axis + outward * (profile_at(height / BOX_SIDE) + clear + BIT_RADIUS);
        // Held a little from above, as hands are.
        let rotation = Quat::from_rotation_y(AZIMUTH) * Quat::from_rotation_x(-0.35);
        let grip = tip + rotation * Vec3::Z * (tool.length_um() as f32 * 1e-6);
        let pose = RawPose::quantise(grip, rotation);
        let trigger = if tick > TICK_RATE / 2 { 255 } else { 0 };
        input.hands[HAND] =
            HandInput { aim: pose, grip: pose, trigger, tracked: true, ..HandInput::default() };
    }
}

/// The vase's radius at a height, 0 to 1, in metres: smooth between the profile's points.
fn profile_at(height: f32) -> f32 {
    let along = height.clamp(0.0, 1.0) * (PROFILE.len() - 1) as f32;
    let k = (along as usize).min(PROFILE.len() - 2);
    let part = along - k as f32;
    let ease = 0.5 - 0.5 * (part * 0.5 * TAU).cos();
    PROFILE[k] + (PROFILE[k + 1] - PROFILE[k]) * ease
}
