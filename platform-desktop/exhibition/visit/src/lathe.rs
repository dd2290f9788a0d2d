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

/// The same of a waist.
const WAIST: [f32; 9] = [0.2, 0.17, 0.12, 0.085, 0.07, 0.085, 0.12, 0.17, 0.2];

/// Ticks of a stroke down the stone, or up it. In the next turn of the stool strokes lie between those of the one before.
const STROKE_TICKS: u32 = 11;

/// Ticks of a pass of strokes: a turn of the stool.
const STROKED_PASS_TICKS: u32 = TURN_TICKS as u32;

/// How far beside the stone a hand waits that has done its work, in metres.
const AWAY: f32 = 0.35;

/// The side of the stone from which it works, in radians from the visitor to the right.
const AZIMUTH: f32 = 0.9;

/// What a hand does.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub(crate) enum LatheWork {
    /// It turns a vase out of a stone, thread by thread as a lathe does: what fills minutes.
    #[default]
    Turning,
    /// A vase, in strokes down and up the stone while it turns: what is seen to go on in seconds.
    Vase,
    /// A waist in what is there, by such strokes.
    Waist,
    /// It takes off all that it can, by such strokes, down to what hides in the stone.
    Bare {
        /// In so many passes from outside.
        passes: u8,
    },
}

/// The hand at its work.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub(crate) struct LatheHand {
    tick: u32,
    work: LatheWork,
}

impl LatheWork {
    /// Radii that it works down to, as [`PROFILE`] is.
    const fn profile(self) -> [f32; 9] {
        match self {
            LatheWork::Turning | LatheWork::Vase => PROFILE,
            LatheWork::Waist => WAIST,
            LatheWork::Bare { .. } => [0.0; 9],
        }
    }

    /// Passes, and metres between one and the next.
    const fn passes(self) -> (u32, f32) {
        match self {
            LatheWork::Turning => (PASSES, PASS_DEPTH),
            LatheWork::Vase => (PASSES, 0.05),
            LatheWork::Waist => (4, 0.03),
            LatheWork::Bare { passes } => (passes as u32, 0.045),
        }
    }

    /// Ticks of a pass.
    const fn pass_ticks(self) -> u32 {
        match self {
            LatheWork::Turning => ((HEIGHTS[0] - HEIGHTS[1]) / PITCH * TURN_TICKS) as u32,
            LatheWork::Vase | LatheWork::Waist | LatheWork::Bare { .. } => STROKED_PASS_TICKS,
        }
    }

    /// Ticks for which it is shown before another is begun.
    const fn shown_ticks(self) -> u32 {
        match self {
            LatheWork::Turning => SHOWN_TICKS,
            LatheWork::Vase | LatheWork::Waist | LatheWork::Bare { .. } => STROKED_PASS_TICKS / 2,
        }
    }

    /// The part of the way down the stone at a tick of a pass, 0 to 1.
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
    /// A hand before such work.
    pub(crate) const fn new(work: LatheWork) -> Self {
        LatheHand { tick: 0, work }
    }

    /// Ticks after which the work is done.
    pub(crate) const fn work_ticks(&self) -> u32 {
        self.work.passes().0 * self.work.pass_ticks()
    }

    /// Whether the work is done, and has been shown.
    pub(crate) const fn is_done(&self) -> bool {
        self.tick >= self.work_ticks() + self.work.shown_ticks()
    }

    /// Puts the work of the next tick into its input, in place of who may be there.
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
        // In the end it waits above, beside the stone.
        let [part, clear] = match passes.checked_sub(1 + pass) {
            Some(left) => [self.work.part_at(tick % pass_ticks), left as f32 * depth],
            None => [0.0, AWAY],
        };
        let height = HEIGHTS[0] + (HEIGHTS[1] - HEIGHTS[0]) * part;
        let outward = Quat::from_rotation_y(AZIMUTH) * Vec3::Z;
        let axis = STOOL_TOP + Vec3::Y * height;
        let tip = axis
            + outward * (radius_at(&self.work.profile(), height / BOX_SIDE) + clear + BIT_RADIUS);
        // Held a little from above, as hands are.
        let rotation = Quat::from_rotation_y(AZIMUTH) * Quat::from_rotation_x(-0.35);
        let grip = tip + rotation * Vec3::Z * (tool.length_um() as f32 * 1e-6);
        let pose = RawPose::quantise(grip, rotation);
        let trigger = if tick > TICK_RATE / 2 { 255 } else { 0 };
        input.hands[HAND] =
            HandInput { aim: pose, grip: pose, trigger, tracked: true, ..HandInput::default() };
    }
}

/// A profile's radius at a height, 0 to 1, in metres: smooth between its points.
fn radius_at(profile: &[f32; 9], height: f32) -> f32 {
    let along = height.clamp(0.0, 1.0) * (profile.len() - 1) as f32;
    let k = (along as usize).min(profile.len() - 2);
    let part = along - k as f32;
    let ease = 0.5 - 0.5 * (part * 0.5 * TAU).cos();
    profile[k] + (profile[k + 1] - profile[k]) * ease
}
