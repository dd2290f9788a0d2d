//! Visitors whose actions cost the most work in a tick.

use std::array;

use glam::{EulerRot, Quat, Vec3};
use paros_core::edit::Pose;
use paros_core::session::{BenchItem, PointerCommand, SessionMode, ToolBit, commands};
use paros_core::volume::{Grid, Size};
use paros_core::{HandInput, TickInput, World};

use crate::random_visitor::RandomSource;

/// An expensive action of a hand.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum HardWork {
    /// The bit crosses the stone from one side to the other and back, one crossing a tick.
    Storm,
    /// The bit makes half a turn a tick.
    Turns,
    /// The bit is in a trench that a fill has narrowed, as deep as possible.
    Deep,
    /// The bit moves back and forth through the stone at a metre a second, half immersed.
    Rough,
    /// The bit's blade stands across x and is pushed along x at a metre a second while turning slightly: it
    /// makes as many bites as possible, and its blade lies in most rows.
    Sideways,
}

impl HardWork {
    /// Returns the pose of a hand's bit in a tick, in a grid of `side` voxels with stone up to `floor`.
    #[must_use]
    pub fn pose_at(self, hand: usize, side: f32, floor: f32, tick: u32) -> Pose {
        let odd = tick % 2 == 1;
        let across = if odd { 0.9 } else { 0.1 };
        let z = side * if hand == 0 { 0.15 } else { 0.85 };
        let turned = Quat::from_rotation_x(3.0) * Quat::from_rotation_y(0.7);
        let (position, rotation) = match self {
            HardWork::Storm => (Vec3::new(side * across, floor, z), Quat::from_rotation_x(0.3)),
            HardWork::Turns if odd => (Vec3::new(side * 0.3, floor, z), turned),
            HardWork::Turns => (Vec3::new(side * 0.3, floor, z), Quat::IDENTITY),
            HardWork::Deep => {
                (Vec3::new(side * 0.3 + 0.2 * tick as f32, floor - 0.03 * side, z), turned)
            }
            HardWork::Rough => {
                // 13.9 mm of the box's 450 mm a tick, with the blade upright across x.
                let gone = (tick as f32 * 0.0309) % 1.4;
                let z = side * (0.15 + (0.7 - gone).abs());
                let x = side * (0.3 + 0.4 * hand as f32 + 0.002 * tick as f32);
                (Vec3::new(x, floor, z), Quat::from_rotation_y(0.05))
            }
            HardWork::Sideways => {
                let gone = (tick as f32 * 0.0309) % 1.4;
                let x = side * (0.15 + (0.7 - gone).abs());
                let turned = 0.3 * (tick as f32 * 0.04).sin();
                let rotation = Quat::from_rotation_y(turned) * Quat::from_rotation_z(turned);
                (Vec3::new(x, floor - 0.1 * side, z), rotation)
            }
        };
        Pose { position, rotation }
    }
}

/// The habit of a hand of a [`HardVisitor`].
#[derive(Clone, Copy, Debug)]
enum Habit {
    Works(HardWork),
    /// The bit wanders and turns slightly.
    Wanders,
    /// The bit has an arbitrary pose.
    Jumps,
}

/// A visitor whose two hands do the most expensive actions, undo and redo in between, and change habits.
#[derive(Debug)]
pub struct HardVisitor {
    dice: RandomSource,
    habits: [Habit; 2],
    poses: [Pose; 2],
}

impl HardVisitor {
    /// Creates a visitor whose inputs depend only on the seed and the world.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        let mut dice = RandomSource::new(seed);
        let habits = array::from_fn(|_| Habit::any(&mut dice));
        let pose = Pose { position: Vec3::splat(0.5), rotation: Quat::IDENTITY };
        HardVisitor { dice, habits, poses: [pose; 2] }
    }

    /// Returns the inputs of a visit's first ticks: start a session and take two tools, with their bits at
    /// minimum, maximum or unchanged size.
    pub fn begin_visit(&mut self, start: SessionMode) -> Vec<TickInput> {
        let mut inputs = vec![TickInput { start, ..TickInput::default() }];
        for (hand, bit) in self.choose_bits().into_iter().enumerate() {
            for item in [BenchItem::Tool(bit.spec().tool), BenchItem::Bit(bit)] {
                let pointer = PointerCommand::Take { hand: hand as u8, item: item.number() as u8 };
                inputs.push(TickInput { pointer, ..TickInput::default() });
            }
        }
        for hand in [0, 1] {
            let by = [-8, 0, 8][self.dice.below(3) as usize];
            let pointer = PointerCommand::Resize { hand, by };
            inputs.push(TickInput { pointer, ..TickInput::default() });
        }
        if self.dice.one_in(3) {
            let commands = commands::SYMMETRY;
            inputs.push(TickInput { commands, ..TickInput::default() });
        }
        inputs
    }

    /// Returns the input of the next tick of work; `tick` ticks of work came before.
    pub fn next_input<const N: usize, const K: usize>(
        &mut self,
        world: &World<N, K>,
        tick: u32,
    ) -> TickInput
    where
        Grid<N>: Size,
    {
        let hands = [0, 1].map(|hand| self.hand_input(hand, world, tick));
        let commands = match self.dice.below(9) {
            0 => commands::UNDO,
            1 => commands::REDO,
            _ => 0,
        };
        TickInput { hands, commands, ..TickInput::default() }
    }

    /// Chooses bits of two different tools; a fifth are saws.
    fn choose_bits(&mut self) -> [ToolBit; 2] {
        loop {
            let bits = [0; 2].map(|_| {
                let any = self.dice.below(ToolBit::ALL.len() as u64 + 2) as usize;
                ToolBit::ALL.get(any).copied().unwrap_or(ToolBit::DiscSaw)
            });
            if bits[0].spec().tool != bits[1].spec().tool {
                return bits;
            }
        }
    }

    fn hand_input<const N: usize, const K: usize>(
        &mut self,
        hand: usize,
        world: &World<N, K>,
        tick: u32,
    ) -> HandInput
    where
        Grid<N>: Size,
    {
        let dice = &mut self.dice;
        if dice.one_in(12) {
            self.habits[hand] = Habit::any(dice);
        }
        // In units of the grid's side.
        let Pose { position, rotation } = self.poses[hand];
        let pose = match self.habits[hand] {
            Habit::Works(work) => work.pose_at(hand, 1.0, 0.6, tick),
            Habit::Wanders => Pose {
                position: position + dice.uniform_in_cube() * 0.025,
                rotation: rotation * Quat::from_rotation_x(dice.uniform_signed() * 0.5),
            },
            Habit::Jumps => {
                let [x, y, z] = (dice.uniform_in_cube() * 3.0).to_array();
                Pose {
                    position: Vec3::new(0.5, 0.35, 0.5)
                        + dice.uniform_in_cube() * Vec3::new(0.45, 0.35, 0.45),
                    rotation: Quat::from_euler(EulerRot::XYZ, x, y, z),
                }
            }
        };
        self.poses[hand] = pose;
        let in_voxels = Pose { position: pose.position * N as f32, ..pose };
        let trigger = if dice.one_in(4) { 0 } else { 255 };
        HandInput { trigger, ..world.hand_with_bit_at(hand, &in_voxels) }
    }
}

impl Habit {
    fn any(dice: &mut RandomSource) -> Self {
        match dice.below(7) {
            0 => Habit::Works(HardWork::Storm),
            1 => Habit::Works(HardWork::Turns),
            2 => Habit::Works(HardWork::Deep),
            3 => Habit::Works(HardWork::Rough),
            4 => Habit::Works(HardWork::Sideways),
            5 => Habit::Wanders,
            _ => Habit::Jumps,
        }
    }
}
