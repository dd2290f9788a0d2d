//! Visitors without a headset: one that does what people do, one that sends any bytes at all.

use glam::{Quat, Vec3};
use paros_core::frame::{BOX, STOOL};
use paros_core::input::{HandInput, Input, METRE, Mode, Pointer, RawPose, buttons, commands};
use paros_core::pose::Pose;
use paros_core::size::{Grid, Size};
use paros_core::workbench::{ITEMS, Item};
use paros_core::world::World;

/// A small generator of random numbers (xorshift64*, Vigna 2016).
#[derive(Clone, Debug)]
pub struct Dice(u64);

impl Dice {
    /// Seeded by any number.
    pub fn new(seed: u64) -> Self {
        Dice(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    /// 0 to `sides - 1`.
    pub fn roll(&mut self, sides: u64) -> u64 {
        (self.bits() >> 16) % sides
    }

    /// Whether a chance of one in `sides` comes up.
    pub fn one_in(&mut self, sides: u64) -> bool {
        self.roll(sides) == 0
    }

    /// From -1 to 1.
    pub fn unit(&mut self) -> f32 {
        self.roll(1 << 20) as f32 / (1 << 19) as f32 - 1.0
    }

    /// From -1 to 1 along each axis.
    pub fn vector(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit())
    }

    /// Any rotation.
    pub fn rotation(&mut self) -> Quat {
        let q = Quat::from_xyzw(self.unit(), self.unit(), self.unit(), self.unit());
        if q.length_squared() > 0.01 { q.normalize() } else { Quat::IDENTITY }
    }
}

/// One of the visitor's hands.
#[derive(Clone, Debug)]
struct Arm {
    tip: Vec3,
    way: Vec3,
    rotation: Quat,
    trigger: bool,
    lost_for: u64,
}

/// Moves two tools about the stone, pulls triggers, fetches things, turns the stool, loses tracking
/// and presses buttons, at random.
#[derive(Clone, Debug)]
pub struct Visitor {
    dice: Dice,
    arms: [Arm; 2],
    ticks: u32,
    /// Whether commands and buttons are used, and now and then a new session.
    pub restless: bool,
}

impl Visitor {
    /// Whose every motion follows from the seed.
    pub fn new(seed: u64) -> Self {
        let arm = |x: f32| Arm {
            tip: STOOL + Vec3::new(x, 0.5 * BOX, 0.3),
            way: Vec3::ZERO,
            rotation: Quat::IDENTITY,
            trigger: false,
            lost_for: 0,
        };
        Visitor { dice: Dice::new(seed), arms: [arm(-0.2), arm(0.2)], ticks: 0, restless: true }
    }

    /// The next tick's input.
    pub fn act(&mut self) -> Input {
        self.ticks += 1;
        let mut input = Input {
            head: RawPose::new(Vec3::new(0.0, 1.6, 0.0), Quat::IDENTITY),
            hands: [self.hand(0), self.hand(1)],
            pointer: self.pointer(),
            ..Input::default()
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

    fn hand(&mut self, i: usize) -> HandInput {
        let Visitor { dice, arms, restless, .. } = self;
        let arm = &mut arms[i];
        arm.move_on(dice);
        let mut grip = arm.tip - arm.rotation * Vec3::NEG_Z * 0.135;
        let squeeze = dice.one_in(200);
        if squeeze && dice.one_in(2) {
            grip = Item::from_number(dice.roll(ITEMS as u64) as usize).expect("an item").home();
        }
        let mut pose = RawPose::new(grip, arm.rotation);
        if dice.one_in(60) {
            pose.rotation = [[0, 0, 0, 0], [1, -1, 0, 2]][dice.roll(2) as usize];
        }
        let button = [buttons::LOWER, buttons::UPPER, buttons::STICK][dice.roll(3) as usize];
        HandInput {
            aim: pose,
            grip: pose,
            trigger: if arm.trigger { 255 } else { dice.roll(100) as u8 },
            squeeze: if squeeze { 255 } else { 0 },
            stick: [if dice.one_in(30) { dice.unit() * 127.0 } else { 0.0 } as i8, 0],
            buttons: if *restless && dice.one_in(150) { button } else { 0 },
            tracked: arm.lost_for == 0,
        }
    }

    fn pointer(&mut self) -> Pointer {
        let hand = self.dice.roll(2) as u8;
        // The first thing is to fetch some tools.
        let what = if self.ticks < 12 { 0 } else { self.dice.roll(150) };
        match what {
            0 | 1 => Pointer::Take { hand, item: self.dice.roll(ITEMS as u64 + 2) as u8 },
            2 => Pointer::Return { hand },
            3 => Pointer::Turn { by: self.dice.bits() as i16 },
            4..12 => Pointer::Turn { by: self.dice.roll(400) as i16 - 200 },
            _ => Pointer::None,
        }
    }
}

impl Arm {
    fn move_on(&mut self, dice: &mut Dice) {
        let middle = STOOL + Vec3::Y * 0.5 * BOX;
        if dice.one_in(25) {
            // Into the stone or past it, at up to two metres a second.
            let goal = middle + dice.vector() * 0.3 * BOX;
            self.way = (goal - self.tip).normalize_or_zero() * 0.015 * dice.unit().abs();
        }
        self.tip += self.way;
        if dice.one_in(300) || self.tip.distance(middle) > 1.2 * BOX {
            self.tip = middle + dice.vector().normalize_or(Vec3::Y) * 0.8 * BOX;
        }
        let turn = if dice.one_in(80) { 3.0 } else { 0.05 };
        let turn = Quat::from_scaled_axis(dice.vector() * turn);
        self.rotation = (turn * self.rotation).normalize();
        if dice.one_in(if self.trigger { 40 } else { 10 }) {
            self.trigger = !self.trigger;
        }
        self.lost_for = match self.lost_for {
            0 if dice.one_in(90) => 1 + dice.roll(5),
            ticks => ticks.saturating_sub(1),
        };
    }
}

/// Any input there can be, extremes often among it.
pub fn anything(dice: &mut Dice) -> Input {
    let hand = |dice: &mut Dice| HandInput {
        aim: any_pose(dice),
        grip: any_pose(dice),
        trigger: dice.bits() as u8,
        squeeze: dice.bits() as u8,
        stick: [dice.bits() as i8, dice.bits() as i8],
        buttons: if dice.one_in(4) { dice.bits() as u8 } else { 0 },
        tracked: !dice.one_in(5),
    };
    let hands = [hand(dice), hand(dice)];
    let byte = dice.bits() as u8;
    let pointer = match dice.roll(8) {
        0 => Pointer::Take { hand: byte, item: dice.bits() as u8 },
        1 | 2 => Pointer::Take { hand: byte, item: dice.roll(4) as u8 },
        3 => Pointer::Return { hand: byte },
        4 => Pointer::Turn { by: dice.bits() as i16 },
        _ => Pointer::None,
    };
    let start = match dice.roll(400) {
        0 => Mode::FreeForm,
        1 => Mode::Constrained { figure: byte % 6 },
        2 => Mode::Creative,
        3 => Mode::Own,
        _ => Mode::None,
    };
    let commands = if dice.one_in(6) { dice.bits() as u8 } else { 0 };
    let finish = if dice.one_in(200) { commands::FINISH } else { 0 };
    Input {
        head: any_pose(dice),
        hands,
        pointer,
        commands: commands & !commands::FINISH | finish,
        start,
    }
}

fn any_pose(dice: &mut Dice) -> RawPose {
    let near = [STOOL.x, STOOL.y + 0.2, STOOL.z];
    let kind = dice.roll(8);
    let position = near.map(|v| match kind {
        0 => [i32::MIN, i32::MAX, 0][dice.roll(3) as usize],
        1 => dice.bits() as i32,
        2 => dice.roll(40 * METRE as u64) as i32 - 20 * METRE,
        _ => ((v + dice.unit() * 0.4) * METRE as f32) as i32,
    });
    let kind = dice.roll(6);
    let rotation = [0; 4].map(|_: i32| match kind {
        0 => [i16::MIN, i16::MAX, 0, 1][dice.roll(4) as usize],
        1 => dice.roll(80) as i16 - 40,
        _ => dice.bits() as i16,
    });
    RawPose { position, rotation }
}

/// A hand that has the bit of the tool it holds at a pose in the grid.
pub fn at<const N: usize>(world: &World<N>, hand: usize, pose: &Pose) -> HandInput
where
    Grid<N>: Size,
{
    let length = world.held(hand).map_or(0, |(tool, _)| tool.length()) as f32 * 1e-6;
    let (tip, rotation) = world.frame().to_room(pose);
    let grip = RawPose::new(tip - rotation * Vec3::NEG_Z * length, rotation);
    HandInput { aim: grip, grip, tracked: true, ..HandInput::default() }
}
