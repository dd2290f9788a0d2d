//! The studio of a frame, from the world's last two ticks and what must not pass through one.

use core::f32::consts::{PI, TAU};

use glam::{Affine3A, Quat, Vec3};
use paros_core::events::Event;
use paros_core::frame::{BOX, STOOL};
use paros_core::hand::RoomPose;
use paros_core::pose::Pose;
use paros_core::size::{Grid, Size};
use paros_core::tools::{Action, Bit, Shape, Tool};
use paros_core::workbench::{ITEMS, Item, Place};
use paros_core::world::World;

use super::draw::DrawList;
use super::island::Lattice;
use super::meshes::MeshId;
use super::particles::{Kind, Particles, scatter};
use super::placing::{shown, stool_turn, tip};
use crate::limits::EDIT_PARTICLES;

/// What is newer than the last tick.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
pub struct Fresh {
    /// The freshest grip of the left and the right hand, in metres; without one, the tick's.
    pub grips: [Option<RoomPose>; 2],
    /// Whether hands are drawn, or only what they hold.
    pub hands: bool,
    /// How far the frame is from the tick before the last (0) to the last (1).
    pub fraction: f32,
    /// Seconds since any moment; only differences count.
    pub time: f64,
}

/// Where the sculpture stands.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct SculpturePose {
    /// Its turn, in radians, counter-clockwise as seen from above.
    pub turn: f32,
    /// Side of its box, in metres.
    pub side: f32,
    /// The middle of its foot, in metres.
    pub foot: Vec3,
}

/// The scene between frames. All its memory is taken at the start.
#[derive(Debug)]
pub struct Assembly {
    tick: Option<u64>,
    time: Option<f64>,
    /// Of the tick before the last, and of the last.
    turns: [f32; 2],
    things: [[Option<RoomPose>; ITEMS]; 2],
    lattice: Box<Lattice>,
    particles: Particles,
    sculpture: SculpturePose,
    list: DrawList,
}

const PLAIN: [f32; 4] = [1.0, 1.0, 1.0, 0.0];
const SHINING: [f32; 4] = [1.0; 4];

impl Default for Assembly {
    fn default() -> Self {
        Self::new()
    }
}

impl Assembly {
    /// Nothing yet.
    #[must_use]
    pub fn new() -> Self {
        Assembly {
            tick: None,
            time: None,
            turns: [0.0; 2],
            things: [[None; ITEMS]; 2],
            lattice: Box::new(Lattice::new()),
            particles: Particles::new(),
            sculpture: SculpturePose { turn: 0.0, side: BOX, foot: STOOL },
            list: DrawList::new(),
        }
    }

    /// Takes in a tick. A shell that makes several in a frame calls this after each, as the world
    /// forgets a tick's events in the next; twice for the same tick changes nothing.
    pub fn follow<const N: usize>(&mut self, world: &World<N>)
    where
        Grid<N>: Size,
    {
        if self.tick == Some(world.tick()) {
            return;
        }
        let skipped = self.tick.is_none_or(|tick| tick.wrapping_add(1) != world.tick());
        self.tick = Some(world.tick());
        let turn = stool_turn(&world.frame());
        self.turns = [if skipped { turn } else { self.turns[1] }, turn];
        self.things[0] = self.things[1];
        for i in 0..ITEMS {
            let Some(item) = Item::from_number(i) else { continue };
            let place = world.bench().place(item);
            self.things[1][i] = shown(world.bench(), item);
            let drops = matches!(place, Place::Falling(ticks) if ticks > 0)
                || matches!(place, Place::Lying(_));
            if skipped || !drops {
                self.things[0][i] = self.things[1][i];
            }
        }
        self.lattice.follow(world);
        self.hear(world);
    }

    /// The frame's instances.
    pub fn assemble<const N: usize>(&mut self, world: &World<N>, fresh: &Fresh) -> &DrawList
    where
        Grid<N>: Size,
    {
        self.follow(world);
        let seconds = self.time.map_or(0.0, |time| fresh.time - time);
        self.time = Some(fresh.time);
        self.particles.advance(seconds as f32);
        let fraction = fresh.fraction.clamp(0.0, 1.0);
        let between = (self.turns[1] - self.turns[0] + PI).rem_euclid(TAU) - PI;
        self.sculpture.turn = self.turns[0] + between * fraction;

        self.list.clear();
        self.list.add(MeshId::Room, Affine3A::IDENTITY, PLAIN);
        self.list.add(MeshId::Outside, Affine3A::IDENTITY, SHINING);
        self.list.add(MeshId::Workbench, Affine3A::IDENTITY, PLAIN);
        self.list.add(MeshId::StoolBase, Affine3A::IDENTITY, PLAIN);
        let turn = Quat::from_rotation_y(self.sculpture.turn);
        self.list.add(MeshId::StoolTop, Affine3A::from_rotation_translation(turn, STOOL), PLAIN);
        self.lay_things(world, fraction);
        for hand in 0..2 {
            self.show_hand(world, fresh, hand);
        }
        self.particles.draw(&mut self.list);
        self.list.group();
        &self.list
    }

    /// Where the sculpture stands in the last assembled frame.
    #[must_use]
    pub const fn sculpture(&self) -> SculpturePose {
        self.sculpture
    }

    /// The instances of the last assembled frame.
    #[must_use]
    pub const fn list(&self) -> &DrawList {
        &self.list
    }

    /// The chips and motes about.
    #[must_use]
    pub const fn particles(&self) -> &Particles {
        &self.particles
    }

    /// What rests, falls or lies, each tool with its bit.
    fn lay_things<const N: usize>(&mut self, world: &World<N>, fraction: f32)
    where
        Grid<N>: Size,
    {
        for i in 0..ITEMS {
            let (Some(item), Some(now)) = (Item::from_number(i), self.things[1][i]) else {
                continue;
            };
            let last = self.things[0][i].unwrap_or(now);
            let pose = (last.0.lerp(now.0, fraction), last.1.slerp(now.1, fraction));
            match item {
                Item::Tool(tool) => self.add_tool(tool, world.bench().mounted(tool), pose),
                Item::Bit(bit) => self.list.add(MeshId::of_bit(bit), at(pose), PLAIN),
            }
        }
    }

    /// A hand at its freshest grip. What it holds is pushed out of the volume, and the hand stays
    /// on it.
    fn show_hand<const N: usize>(&mut self, world: &World<N>, fresh: &Fresh, hand: usize)
    where
        Grid<N>: Size,
    {
        let held = world.held(hand);
        let state = world.hand(hand);
        let known = state.tracked || held.is_some() && state.grip.1.length_squared() > 0.0;
        let Some(grip) = fresh.grips[hand].or(known.then_some(state.grip)) else { return };
        let grip = match held {
            Some((tool, bit)) => {
                let pushed = (grip.0 + world.push_out(hand), grip.1);
                self.add_tool(tool, bit, pushed);
                pushed
            }
            None => grip,
        };
        if fresh.hands && (state.tracked || fresh.grips[hand].is_some()) {
            self.list.add(MeshId::of_hand(hand, held.is_some()), at(grip), PLAIN);
        }
    }

    fn add_tool(&mut self, tool: Tool, bit: Bit, grip: RoomPose) {
        self.list.add(MeshId::of_tool(tool), at(grip), PLAIN);
        self.list.add(MeshId::of_bit(bit), at(tip(grip, tool)), PLAIN);
    }

    /// What the tick's events throw about.
    fn hear<const N: usize>(&mut self, world: &World<N>)
    where
        Grid<N>: Size,
    {
        for (number, event) in (0u64..).zip(world.events()) {
            let seed = world.tick().wrapping_mul(16).wrapping_add(number).wrapping_mul(1024);
            match event {
                Event::Started(_) => self.particles.clear(),
                Event::Edited { hand, bit, report } if bit.data().action != Action::Fill => {
                    self.bite(world, usize::from(*hand), *bit, report.removed, seed);
                }
                Event::Islands(report) if report.removed > 0 => self.crumble(world, seed),
                _ => {}
            }
        }
    }

    /// Chips and dust from under a bit that removed voxels.
    fn bite<const N: usize>(
        &mut self,
        world: &World<N>,
        hand: usize,
        bit: Bit,
        removed: u32,
        seed: u64,
    ) where
        Grid<N>: Size,
    {
        if removed == 0 {
            return;
        }
        let frame = world.frame();
        let (centre, _) = frame.to_room(&world.hand(hand).frozen);
        let turn = frame.to_room(&Pose::ZERO).1;
        let normal = world.contact(hand).map_or(Vec3::Y, |contact| turn * contact.normal);
        let radius = match bit.data().shape {
            Shape::Ball { radius } => radius,
            Shape::Box { half } => half[0].min(half[1]),
        } as f32
            * 1e-6;
        // A chip stands for a few cubic millimetres: finer grids throw no more.
        let volume = removed as f32 * (frame.voxel() * 1e3).powi(3);
        let count = ((volume / 250.0).ceil() as u32).min(EDIT_PARTICLES);
        for i in 0..u64::from(count) {
            let seed = seed + i;
            let aside = scatter(seed, 10);
            let from = centre + (aside * 0.8 - normal * 0.5) * radius;
            let smooth = bit.data().action == Action::Smooth;
            let kind = if smooth || i % 3 != 0 { Kind::Dust } else { Kind::Chip };
            let speed = if kind == Kind::Chip { 0.9 } else { 0.7 };
            let way = normal * 0.9 + aside * 0.8 + Vec3::Y * 0.5;
            self.particles.throw(kind, from, way * speed, seed);
        }
    }

    /// Motes where an island was.
    fn crumble<const N: usize>(&mut self, world: &World<N>, seed: u64)
    where
        Grid<N>: Size,
    {
        let frame = world.frame();
        let mut seed = seed;
        let particles = &mut self.particles;
        self.lattice.gone(N, |voxel| {
            seed += 1;
            let aside = scatter(seed, 10);
            let pose = Pose { position: voxel + aside * 1.5, rotation: Quat::IDENTITY };
            let (from, _) = frame.to_room(&pose);
            particles.throw(Kind::Mote, from, aside * 0.05, seed);
        });
    }
}

fn at((position, rotation): RoomPose) -> Affine3A {
    Affine3A::from_rotation_translation(rotation, position)
}
