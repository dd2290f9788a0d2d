//! Generators of input: a random walk that sculpts like a person, and arbitrary input for fuzzing.

use glam::{Quat, Vec3};
use paros_core::internals::{BENCH_ITEMS, BOX_SIDE, STOOL_TOP, UNITS_PER_METRE};
use paros_core::session::{BenchItem, PointerCommand, RawPose, SessionMode, buttons, commands};
use paros_core::visit::{
    PanelAction, PlanSetting, Presence, StaffCommand, VisitCommand, VisitInput,
};
use paros_core::{HandInput, TickInput};

/// A pseudo-random number generator: xorshift64* (Vigna 2016).
#[derive(Clone, Debug)]
pub struct RandomSource(u64);

impl RandomSource {
    /// Creates a generator from any seed.
    pub fn new(seed: u64) -> Self {
        RandomSource(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    /// Returns the next 64 bits.
    pub fn next_bits(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    /// Returns a number from 0 to `end - 1`.
    pub fn below(&mut self, end: u64) -> u64 {
        (self.next_bits() >> 16) % end
    }

    /// Returns `true` with probability 1 / `sides`.
    pub fn one_in(&mut self, sides: u64) -> bool {
        self.below(sides) == 0
    }

    /// Returns a number from -1 to 1.
    pub fn uniform_signed(&mut self) -> f32 {
        self.below(1 << 20) as f32 / (1 << 19) as f32 - 1.0
    }

    /// Returns a vector with components from -1 to 1.
    pub fn uniform_in_cube(&mut self) -> Vec3 {
        Vec3::new(self.uniform_signed(), self.uniform_signed(), self.uniform_signed())
    }

    /// Returns a random rotation, not uniformly distributed.
    pub fn arbitrary_rotation(&mut self) -> Quat {
        let q = Quat::from_xyzw(
            self.uniform_signed(),
            self.uniform_signed(),
            self.uniform_signed(),
            self.uniform_signed(),
        );
        if q.length_squared() > 0.01 { q.normalize() } else { Quat::IDENTITY }
    }
}

/// The motion of one hand.
#[derive(Clone, Debug)]
struct ArmState {
    tip: Vec3,
    velocity: Vec3,
    rotation: Quat,
    trigger: bool,
    lost_ticks: u64,
}

/// A random visitor: moves two tools about the stone, pulls triggers, takes items, turns the stool, loses
/// tracking and presses buttons.
#[derive(Clone, Debug)]
pub struct RandomVisitor {
    dice: RandomSource,
    arms: [ArmState; 2],
    ticks: u32,
    /// `true` if the visitor uses commands and buttons.
    pub restless: bool,
}

impl RandomVisitor {
    /// Creates a visitor whose inputs depend only on the seed.
    pub fn new(seed: u64) -> Self {
        let arm = |x: f32| ArmState {
            tip: STOOL_TOP + Vec3::new(x, 0.5 * BOX_SIDE, 0.3),
            velocity: Vec3::ZERO,
            rotation: Quat::IDENTITY,
            trigger: false,
            lost_ticks: 0,
        };
        RandomVisitor {
            dice: RandomSource::new(seed),
            arms: [arm(-0.2), arm(0.2)],
            ticks: 0,
            restless: true,
        }
    }

    /// Returns the next tick's input.
    pub fn next_input(&mut self) -> TickInput {
        self.ticks += 1;
        let mut input = TickInput {
            head: RawPose::quantise(Vec3::new(0.0, 1.6, 0.0), Quat::IDENTITY),
            hands: [self.hand_input(0), self.hand_input(1)],
            pointer: self.pointer_action(),
            ..TickInput::default()
        };
        if self.restless {
            for (command, sides) in
                [(commands::UNDO, 90), (commands::REDO, 150), (commands::SYMMETRY, 200)]
            {
                input.commands |= if self.dice.one_in(sides) { command } else { 0 };
            }
        }
        input
    }

    fn hand_input(&mut self, hand: usize) -> HandInput {
        let RandomVisitor { dice, arms, restless, .. } = self;
        let arm = &mut arms[hand];
        arm.advance_motion(dice);
        let mut grip = arm.tip - arm.rotation * Vec3::NEG_Z * 0.135;
        let squeeze = dice.one_in(200);
        if squeeze && dice.one_in(2) {
            grip = BenchItem::from_number(dice.below(BENCH_ITEMS as u64) as usize)
                .expect("an item")
                .home_position();
        }
        let mut pose = RawPose::quantise(grip, arm.rotation);
        if dice.one_in(60) {
            pose.rotation = [[0, 0, 0, 0], [1, -1, 0, 2]][dice.below(2) as usize];
        }
        let button = [buttons::LOWER, buttons::UPPER, buttons::STICK][dice.below(3) as usize];
        HandInput {
            aim: pose,
            grip: pose,
            trigger: if arm.trigger { 255 } else { dice.below(100) as u8 },
            squeeze: if squeeze { 255 } else { 0 },
            stick: [if dice.one_in(30) { dice.uniform_signed() * 127.0 } else { 0.0 } as i8, 0],
            buttons: if *restless && dice.one_in(150) { button } else { 0 },
            tracked: arm.lost_ticks == 0,
        }
    }

    fn pointer_action(&mut self) -> PointerCommand {
        let hand = self.dice.below(2) as u8;
        // The first ticks take tools.
        let what = if self.ticks < 12 { 0 } else { self.dice.below(150) };
        match what {
            0 | 1 => {
                PointerCommand::Take { hand, item: self.dice.below(BENCH_ITEMS as u64 + 2) as u8 }
            }
            2 => PointerCommand::Return { hand },
            3 => PointerCommand::Turn { by: self.dice.next_bits() as i16 },
            4..12 => PointerCommand::Turn { by: self.dice.below(400) as i16 - 200 },
            12 => PointerCommand::Resize { hand, by: 1 },
            13 => PointerCommand::Resize { hand, by: -1 },
            14 => PointerCommand::Steady { string_mm: 15 * hand },
            _ => PointerCommand::None,
        }
    }
}

impl ArmState {
    /// Advances the hand's random walk by a tick.
    fn advance_motion(&mut self, dice: &mut RandomSource) {
        let middle = STOOL_TOP + Vec3::Y * 0.5 * BOX_SIDE;
        if dice.one_in(25) {
            // A goal in the stone or beyond it, at up to two metres a second.
            let goal = middle + dice.uniform_in_cube() * 0.3 * BOX_SIDE;
            self.velocity =
                (goal - self.tip).normalize_or_zero() * 0.015 * dice.uniform_signed().abs();
        }
        self.tip += self.velocity;
        if dice.one_in(300) || self.tip.distance(middle) > 1.2 * BOX_SIDE {
            self.tip = middle + dice.uniform_in_cube().normalize_or(Vec3::Y) * 0.8 * BOX_SIDE;
        }
        let turn = if dice.one_in(80) { 3.0 } else { 0.05 };
        let turn = Quat::from_scaled_axis(dice.uniform_in_cube() * turn);
        self.rotation = (turn * self.rotation).normalize();
        if dice.one_in(if self.trigger { 40 } else { 10 }) {
            self.trigger = !self.trigger;
        }
        self.lost_ticks = match self.lost_ticks {
            0 if dice.one_in(90) => 1 + dice.below(5),
            ticks => ticks.saturating_sub(1),
        };
    }
}

/// Returns an arbitrary input: any values of every field, often extreme ones.
pub fn arbitrary_input(dice: &mut RandomSource) -> TickInput {
    let hand = |dice: &mut RandomSource| HandInput {
        aim: arbitrary_pose(dice),
        grip: arbitrary_pose(dice),
        trigger: dice.next_bits() as u8,
        squeeze: dice.next_bits() as u8,
        stick: [dice.next_bits() as i8, dice.next_bits() as i8],
        buttons: if dice.one_in(4) { dice.next_bits() as u8 } else { 0 },
        tracked: !dice.one_in(5),
    };
    let hands = [hand(dice), hand(dice)];
    let byte = dice.next_bits() as u8;
    let pointer = match dice.below(8) {
        0 => PointerCommand::Take { hand: byte, item: dice.next_bits() as u8 },
        1 | 2 => PointerCommand::Take { hand: byte, item: dice.below(4) as u8 },
        3 => PointerCommand::Return { hand: byte },
        4 => PointerCommand::Turn { by: dice.next_bits() as i16 },
        5 => PointerCommand::Resize { hand: byte, by: dice.next_bits() as i8 },
        6 => PointerCommand::Steady { string_mm: byte },
        _ => PointerCommand::None,
    };
    let start = match dice.below(400) {
        0 => SessionMode::FreeForm,
        1 => SessionMode::Constrained { figure: byte % 6 },
        2 => SessionMode::Creative,
        3 => SessionMode::Own,
        _ => SessionMode::None,
    };
    let commands = if dice.one_in(6) { dice.next_bits() as u8 } else { 0 };
    let finish = if dice.one_in(200) { commands::FINISH } else { 0 };
    TickInput {
        head: arbitrary_pose(dice),
        hands,
        pointer,
        commands: commands & !commands::FINISH | finish,
        start,
        visit: arbitrary_visit(dice),
    }
}

/// Returns any presence and use, and occasionally a command of a visit, such as times of a few seconds.
fn arbitrary_visit(dice: &mut RandomSource) -> VisitInput {
    let presence = [Presence::Unknown, Presence::Worn, Presence::Off][dice.below(3) as usize];
    let start = [SessionMode::FreeForm, SessionMode::Constrained { figure: dice.below(3) as u8 }];
    let action = [
        PanelAction::Confirm,
        PanelAction::Language(dice.below(4) as u8),
        PanelAction::Start(start[dice.below(2) as usize]),
        PanelAction::Skip { all: dice.one_in(2) },
        PanelAction::Finish,
        PanelAction::PutBack,
    ][dice.below(6) as usize];
    let staff = [StaffCommand::Extend, StaffCommand::End, StaffCommand::Reset];
    let setting = PlanSetting::ALL[dice.below(PlanSetting::ALL.len() as u64) as usize];
    // Visits are seldom opened, otherwise little would be edited.
    let command = match dice.below(40) {
        0 if dice.one_in(20) => VisitCommand::Open,
        1 => VisitCommand::Close,
        2 => VisitCommand::Set { setting, value: dice.below(3) as u16 },
        3 => VisitCommand::SetStart(start[dice.below(2) as usize]),
        4..8 => VisitCommand::Press(action),
        8 => VisitCommand::Staff(staff[dice.below(3) as usize]),
        9 => VisitCommand::Away { seconds: dice.below(90) as u16 },
        10 => VisitCommand::Exported,
        11 => VisitCommand::Badge { number: dice.below(1 << 27) as u32 },
        _ => VisitCommand::None,
    };
    VisitInput { presence, is_used: dice.one_in(2), command }
}

/// Returns an arbitrary raw pose: extreme, anywhere, far from the stone or near it.
fn arbitrary_pose(dice: &mut RandomSource) -> RawPose {
    let near = [STOOL_TOP.x, STOOL_TOP.y + 0.2, STOOL_TOP.z];
    let kind = dice.below(8);
    let position = near.map(|v| match kind {
        0 => [i32::MIN, i32::MAX, 0][dice.below(3) as usize],
        1 => dice.next_bits() as i32,
        2 => dice.below(40 * UNITS_PER_METRE as u64) as i32 - 20 * UNITS_PER_METRE,
        _ => ((v + dice.uniform_signed() * 0.4) * UNITS_PER_METRE as f32) as i32,
    });
    let kind = dice.below(6);
    let rotation = [0; 4].map(|_: i32| match kind {
        0 => [i16::MIN, i16::MAX, 0, 1][dice.below(4) as usize],
        1 => dice.below(80) as i16 - 40,
        _ => dice.next_bits() as i16,
    });
    RawPose { position, rotation }
}
