//! The demonstration of the attract phase: the stone turns, and a hand carves a vase out of it.
//!
//! The hand depends only on the number of ticks and on the tool that the world has put into it. A trace
//! therefore records its work like that of any visitor.

use core::f32::consts::TAU;

use glam::{Quat, Vec3};
use paros_core::internals::{BOX_SIDE, STOOL_TOP};
use paros_core::session::{BenchItem, PointerCommand, RawPose, TICK_RATE, Tool, ToolBit};
use paros_core::volume::{Grid, Size};
use paros_core::{HandInput, TickInput, World};

/// The hand that works: the right hand.
const HAND: usize = 1;

/// Radius of the bit in metres: a roughing ball of its natural size.
const BIT_RADIUS: f32 = 0.04;

/// Turn of the stool in a tick, in 65,536ths of a turn: half a metre a second at the block's corners.
const TURN: i16 = 340;

/// Ticks of a full turn.
const TURN_TICKS: f32 = 65_536.0 / TURN as f32;

/// Descent of the bit in a turn, in metres: less than the bit's width, so that no ridge remains.
const PITCH: f32 = 0.026;

/// Distance between one pass and the next, in metres.
const PASS_DEPTH: f32 = 0.036;

/// Number of passes. The last one is on the vase itself.
const PASSES: u32 = 4;

/// Ticks for which the vase is shown before the next one is begun.
const SHOWN_TICKS: u32 = 8 * TICK_RATE;

/// Heights above the stool at which a pass begins and ends, in metres.
const HEIGHTS: [f32; 2] = [BOX_SIDE, 0.03];

/// Radii of the vase from its foot to its lip, in metres, at even heights.
const PROFILE: [f32; 9] = [0.085, 0.11, 0.15, 0.172, 0.17, 0.14, 0.095, 0.075, 0.1];

/// Radii of a waist, in the form of [`PROFILE`].
const WAIST: [f32; 9] = [0.2, 0.17, 0.12, 0.085, 0.07, 0.085, 0.12, 0.17, 0.2];

/// Ticks of a stroke down or up the stone. In the stool's next turn, strokes lie between the former ones.
const STROKE_TICKS: u32 = 11;

/// Ticks of a pass of strokes: a turn of the stool.
const STROKED_PASS_TICKS: u32 = TURN_TICKS as u32;

/// Distance from the stone at which the hand waits after its work, in metres.
const AWAY: f32 = 0.35;

/// The side of the stone on which the hand works, in radians from the visitor to the right.
const AZIMUTH: f32 = 0.9;

/// The work of the hand.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub(crate) enum LatheWork {
    /// Turns a vase out of a stone along a helix, as on a lathe. Takes minutes.
    #[default]
    Turning,
    /// Carves a vase in strokes down and up the stone while it turns. Takes seconds.
    Vase,
    /// Carves a waist into the stone, in such strokes.
    Waist,
    /// Removes all stone that it can, in such strokes, down to the hidden figure.
    Bare {
        /// Number of passes from outside.
        passes: u8,
    },
}

/// The hand of the demonstration.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub(crate) struct LatheHand {
    tick: u32,
    work: LatheWork,
}

impl LatheWork {
    /// Returns the radii down to which the work carves, in the form of [`PROFILE`].
    const fn profile(self) -> [f32; 9] {
        match self {
            LatheWork::Turning | LatheWork::Vase => PROFILE,
            LatheWork::Waist => WAIST,
            LatheWork::Bare { .. } => [0.0; 9],
        }
    }

    /// Returns the number of passes, and the distance between two passes in metres.
    const fn passes(self) -> (u32, f32) {
        match self {
            LatheWork::Turning => (PASSES, PASS_DEPTH),
            LatheWork::Vase => (PASSES, 0.05),
            LatheWork::Waist => (4, 0.03),
            LatheWork::Bare { passes } => (passes as u32, 0.045),
        }
    }

    /// Returns the ticks of a pass.
    const fn pass_ticks(self) -> u32 {
        match self {
            LatheWork::Turning => ((HEIGHTS[0] - HEIGHTS[1]) / PITCH * TURN_TICKS) as u32,
            LatheWork::Vase | LatheWork::Waist | LatheWork::Bare { .. } => STROKED_PASS_TICKS,
        }
    }

    /// Returns the ticks for which the result is shown before the next work is begun.
    const fn shown_ticks(self) -> u32 {
        match self {
            LatheWork::Turning => SHOWN_TICKS,
            LatheWork::Vase | LatheWork::Waist | LatheWork::Bare { .. } => STROKED_PASS_TICKS / 2,
        }
    }

    /// Returns how far down the stone the bit is at a tick of a pass, 0 to 1.
    fn part_at(self, tick: u32) -> f32 {
        match self {
            LatheWork::Turning => tick as f32 / self.pass_ticks() as f32,
            LatheWork::Vase | LatheWork::Waist | LatheWork::Bare { .. } => {
                let at = tick % (2 * STROKE_TICKS);
                at.min(2 * STROKE_TICKS - at) as f32 / STROKE_TICKS as f32
            }
        }
    }
}

impl LatheHand {
    /// Makes a hand that begins this work.
    pub(crate) const fn new(work: LatheWork) -> Self {
        LatheHand { tick: 0, work }
    }

    /// Returns the ticks after which the work is done.
    pub(crate) const fn work_ticks(&self) -> u32 {
        self.work.passes().0 * self.work.pass_ticks()
    }

    /// Returns `true` if the work is done, and was shown.
    pub(crate) const fn is_done(&self) -> bool {
        self.tick >= self.work_ticks() + self.work.shown_ticks()
    }

    /// Replaces the hands in the next tick's input by the working hand.
    pub(crate) fn fill_input<const N: usize, const K: usize>(
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
        let ((passes, depth), pass_ticks) = (self.work.passes(), self.work.pass_ticks());
        let pass = tick / pass_ticks;
        if pass >= passes && self.work == LatheWork::Turning {
            return;
        }
        let Some((tool, _)) = world.held_tool(HAND) else { return };
        // At the end the hand waits above, beside the stone.
        let [part, clear] = match passes.checked_sub(1 + pass) {
            Some(left) => [self.work.part_at(tick % pass_ticks), left as f32 * depth],
            None => [0.0, AWAY],
        };
        let height = HEIGHTS[0] + (HEIGHTS[1] - HEIGHTS[0]) * part;
        let outward = Quat::from_rotation_y(AZIMUTH) * Vec3::Z;
        let axis = STOOL_TOP + Vec3::Y * height;
        let tip = axis
            + outward * (radius_at(&self.work.profile(), height / BOX_SIDE) + clear + BIT_RADIUS);
        // Tilted down a little, as hands hold tools.
        let rotation = Quat::from_rotation_y(AZIMUTH) * Quat::from_rotation_x(-0.35);
        let grip = tip + rotation * Vec3::Z * (tool.length_um() as f32 * 1e-6);
        let pose = RawPose::quantise(grip, rotation);
        let trigger = if tick > TICK_RATE / 2 { 255 } else { 0 };
        input.hands[HAND] =
            HandInput { aim: pose, grip: pose, trigger, tracked: true, ..HandInput::default() };
    }
}

/// Returns the radius of a profile in metres at a height, 0 to 1: smooth between its points.
fn radius_at(profile: &[f32; 9], height: f32) -> f32 {
    let along = height.clamp(0.0, 1.0) * (profile.len() - 1) as f32;
    let k = (along as usize).min(profile.len() - 2);
    let part = along - k as f32;
    let ease = 0.5 - 0.5 * (part * 0.5 * TAU).cos();
    profile[k] + (profile[k + 1] - profile[k]) * ease
}
