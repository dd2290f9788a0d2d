//! Scene assembly: the instances of a frame, interpolated between the world's last two ticks, with
//! hands at their latest poses.

use core::f32::consts::{PI, TAU};

use glam::{Affine3A, Quat, Vec3};
use paros_core::edit::Pose;
use paros_core::internals::{
    BENCH_ITEMS, BOX_SIDE, BitAction, BitShape, RoomPose, STOOL_TOP, ToolPlace, Workbench,
};
use paros_core::session::{BenchItem, Tool, ToolBit};
use paros_core::volume::{Grid, Size};
use paros_core::{World, WorldEvent};

use super::draw::DrawList;
use super::falling::FallingStones;
use super::found::FoundLight;
use super::guides;
use super::island::IslandLattice;
use super::lit::LitTargets;
use super::meshes::{HandShape, MeshId};
use super::particles::{ParticleKind, Particles, random_in_cube};
use super::placing::{bit_pose, display_pose_unless_held_or_mounted, stool_turn_0_to_tau};
use super::refusal::RefusalMarks;
use crate::limits::EDIT_PARTICLES;

/// Input of a frame that is newer than the last tick.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
pub struct LatestInput {
    /// Latest grip poses of the left and the right hand, in metres; `None` falls back to the tick's.
    pub grips: [Option<RoomPose>; 2],
    /// `true` to draw the hands besides what they hold.
    pub show_hands: bool,
    /// Interpolation factor from the tick before the last (0) to the last (1); clamped.
    pub tick_fraction: f32,
    /// Monotonic time in seconds, of any epoch.
    pub time_seconds: f64,
    /// Displacement of each hand's bit by a pull of the trigger, in metres of the room; `None` for as far
    /// as the hand pushes the bit.
    pub next_bites: [Option<Vec3>; 2],
    /// `true` to draw the mirror's plane and the reflected tools while the mirror is on.
    pub show_mirror: bool,
    /// `true` to light what a squeeze of a hand would take.
    pub light_targets: bool,
}

/// The sculpture's placement in the room.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct SculpturePlacement {
    /// Rotation about the vertical axis, in radians, counter-clockwise from above.
    pub turn_radians: f32,
    /// Side of its box, in metres.
    pub side: f32,
    /// Centre of its base, in metres.
    pub foot: Vec3,
}

/// Builds the draw list of each frame. Allocates only when created.
#[derive(Debug)]
pub struct SceneAssembler {
    tick: Option<u64>,
    time: Option<f64>,
    /// Stool angles in radians of the tick before the last, and of the last.
    turns: [f32; 2],
    items: [[Option<RoomPose>; BENCH_ITEMS]; 2],
    lattice: Box<IslandLattice>,
    particles: Particles,
    stones: FallingStones,
    refusals: RefusalMarks,
    found: FoundLight,
    sculpture: SculpturePlacement,
    list: DrawList,
}

pub(super) const PLAIN: [f32; 4] = [1.0, 1.0, 1.0, 0.0];
pub(super) const SHINING: [f32; 4] = [1.0; 4];

impl Default for SceneAssembler {
    fn default() -> Self {
        Self::new()
    }
}

impl SceneAssembler {
    /// Creates an assembler that has followed no tick yet.
    #[must_use]
    pub fn new() -> Self {
        SceneAssembler {
            tick: None,
            time: None,
            turns: [0.0; 2],
            items: [[None; BENCH_ITEMS]; 2],
            lattice: Box::new(IslandLattice::new()),
            particles: Particles::new(),
            stones: FallingStones::new(),
            refusals: RefusalMarks::new(),
            found: FoundLight::new(),
            sculpture: SculpturePlacement { turn_radians: 0.0, side: BOX_SIDE, foot: STOOL_TOP },
            list: DrawList::new(),
        }
    }

    /// Takes in a tick. Call it after every tick, as the world keeps only the last tick's events; a
    /// second call for the same tick changes nothing.
    pub fn follow_tick<const N: usize, const K: usize>(&mut self, world: &World<N, K>)
    where
        Grid<N>: Size,
    {
        if self.tick == Some(world.tick()) {
            return;
        }
        self.found.follow_tick(world, self.tick.is_none());
        let skipped = self.tick.is_none_or(|tick| tick.wrapping_add(1) != world.tick());
        self.tick = Some(world.tick());
        let turn = stool_turn_0_to_tau(&world.stool_frame());
        self.turns = [if skipped { turn } else { self.turns[1] }, turn];
        self.items[0] = self.items[1];
        for i in 0..BENCH_ITEMS {
            let Some(item) = BenchItem::from_number(i) else { continue };
            let place = world.workbench().place_of(item);
            self.items[1][i] = display_pose_unless_held_or_mounted(world.workbench(), item);
            let drops = matches!(place, ToolPlace::Falling(ticks) if ticks > 0)
                || matches!(place, ToolPlace::Lying(_));
            if skipped || !drops {
                self.items[0][i] = self.items[1][i];
            }
        }
        self.lattice.follow_tick(world);
        self.spawn_particles(world);
        (0..2).for_each(|hand| self.refusals.follow_tick(world, hand));
    }

    /// Builds and returns the draw list of a frame.
    pub fn assemble_frame<const N: usize, const K: usize>(
        &mut self,
        world: &World<N, K>,
        latest: &LatestInput,
    ) -> &DrawList
    where
        Grid<N>: Size,
    {
        self.follow_tick(world);
        let seconds = self.time.map_or(0.0, |time| latest.time_seconds - time);
        self.time = Some(latest.time_seconds);
        let (frame, lattice) = (world.stool_frame(), &self.lattice);
        self.stones.advance_time(seconds as f32, (lattice, N), &frame, &mut self.particles);
        self.particles.advance_time(seconds as f32);
        self.refusals.advance_time(seconds as f32);
        self.found.advance_time(seconds as f32);
        let fraction = latest.tick_fraction.clamp(0.0, 1.0);
        let between = (self.turns[1] - self.turns[0] + PI).rem_euclid(TAU) - PI;
        self.sculpture.turn_radians = self.turns[0] + between * fraction;

        self.list.clear();
        self.list.add(MeshId::Room, Affine3A::IDENTITY, PLAIN);
        self.list.add(MeshId::Outside, Affine3A::IDENTITY, SHINING);
        self.list.add(MeshId::Workbench, Affine3A::IDENTITY, PLAIN);
        self.list.add(MeshId::StoolBase, Affine3A::IDENTITY, PLAIN);
        let lit = match latest.light_targets {
            true => LitTargets::of_hands(world),
            false => LitTargets::default(),
        };
        let turn = Quat::from_rotation_y(self.sculpture.turn_radians);
        let stool_top = Affine3A::from_rotation_translation(turn, STOOL_TOP);
        self.list.add(MeshId::StoolTop, stool_top, lit.stool_tint());
        self.add_unheld_items(world, fraction, &lit);
        for hand in 0..2 {
            self.add_hand_and_held_tool(world, latest, hand);
        }
        self.particles.add_instances(&mut self.list);
        self.stones.add_instances(&mut self.list);
        guides::add_guides(&mut self.list, world, latest, self.sculpture.turn_radians);
        self.refusals.add_instances(&mut self.list, &self.sculpture);
        self.list.batch_by_mesh();
        &self.list
    }

    /// Returns the sculpture's placement in the last assembled frame.
    #[must_use]
    pub const fn sculpture_placement(&self) -> SculpturePlacement {
        self.sculpture
    }

    /// Returns the part, 0 to 1, to which the last assembled frame has the light of a find: see
    /// [`RenderStyle::lighting_a_find`](crate::gpu::RenderStyle::lighting_a_find).
    #[must_use]
    pub fn found_part(&self) -> f32 {
        self.found.smooth_part()
    }

    /// Returns the draw list of the last assembled frame.
    #[must_use]
    pub const fn draw_list(&self) -> &DrawList {
        &self.list
    }

    /// Returns the particles.
    #[must_use]
    pub const fn particles(&self) -> &Particles {
        &self.particles
    }

    /// Adds the items that rest, fall or lie, each tool with its bit.
    fn add_unheld_items<const N: usize, const K: usize>(
        &mut self,
        world: &World<N, K>,
        tick_fraction: f32,
        lit: &LitTargets,
    ) where
        Grid<N>: Size,
    {
        for i in 0..BENCH_ITEMS {
            let (Some(item), Some(now)) = (BenchItem::from_number(i), self.items[1][i]) else {
                continue;
            };
            let last = self.items[0][i].unwrap_or(now);
            let pose = (last.0.lerp(now.0, tick_fraction), last.1.slerp(now.1, tick_fraction));
            let (bench, tint) = (world.workbench(), lit.item_tint(item));
            match item {
                BenchItem::Tool(tool) => {
                    self.add_tool(bench, (tool, bench.mounted_bit(tool)), pose, tint);
                }
                BenchItem::Bit(bit) => self.add_bit(bench, bit, pose, tint),
            }
        }
    }

    /// Adds a hand and what it holds at its latest grip, displaced by the tool's push-out from the
    /// volume.
    fn add_hand_and_held_tool<const N: usize, const K: usize>(
        &mut self,
        world: &World<N, K>,
        latest: &LatestInput,
        hand: usize,
    ) where
        Grid<N>: Size,
    {
        let held = world.held_tool(hand);
        let state = world.hand_state(hand);
        let known = state.tracked || held.is_some() && state.grip.1.length_squared() > 0.0;
        let Some(grip) = latest.grips[hand].or(known.then_some(state.grip)) else { return };
        let grip = match held {
            Some((tool, bit)) => {
                let pushed = (grip.0 + world.push_out_metres(hand), grip.1);
                self.add_tool(world.workbench(), (tool, bit), pushed, PLAIN);
                pushed
            }
            None => grip,
        };
        if latest.show_hands && (state.tracked || latest.grips[hand].is_some()) {
            let shape = if held.is_some() { HandShape::Closed } else { HandShape::Open };
            let of_hand = [MeshId::of_left_hand, MeshId::of_right_hand][hand];
            self.list.add(of_hand(shape), room_from_pose(grip), PLAIN);
        }
    }

    fn add_tool(
        &mut self,
        bench: &Workbench,
        (tool, bit): (Tool, ToolBit),
        grip: RoomPose,
        tint: [f32; 4],
    ) {
        self.list.add(MeshId::of_tool(tool), room_from_pose(grip), tint);
        self.add_bit(bench, bit, bit_pose(grip, tool), tint);
    }

    /// Adds a bit at its current size.
    fn add_bit(
        &mut self,
        bench: &Workbench,
        bit: ToolBit,
        (position, rotation): RoomPose,
        tint: [f32; 4],
    ) {
        let scale = Vec3::splat(bench.size_of(bit).scale());
        let placed = Affine3A::from_scale_rotation_translation(scale, rotation, position);
        self.list.add(MeshId::of_bit(bit), placed, tint);
    }

    /// Spawns the particles of the tick's events.
    fn spawn_particles<const N: usize, const K: usize>(&mut self, world: &World<N, K>)
    where
        Grid<N>: Size,
    {
        for (number, event) in (0u64..).zip(world.events()) {
            let seed = world.tick().wrapping_mul(16).wrapping_add(number).wrapping_mul(1024);
            match event {
                WorldEvent::Started(_) => {
                    self.particles.clear();
                    self.stones.clear();
                    self.refusals.clear();
                }
                WorldEvent::Edited { hand, bit, report }
                    if bit.spec().action != BitAction::Fill =>
                {
                    self.spawn_chips(world, usize::from(*hand), *bit, report.removed, seed);
                }
                WorldEvent::Islands(report) if report.removed > 0 => {
                    self.drop_island(world, seed);
                }
                // A flake falls like an island.
                WorldEvent::Split { .. } => self.drop_island(world, seed),
                _ => {}
            }
        }
    }

    /// Spawns chips and dust under a bit that removed voxels.
    fn spawn_chips<const N: usize, const K: usize>(
        &mut self,
        world: &World<N, K>,
        hand: usize,
        bit: ToolBit,
        removed_voxels: u32,
        seed: u64,
    ) where
        Grid<N>: Size,
    {
        if removed_voxels == 0 {
            return;
        }
        let frame = world.stool_frame();
        let (centre, _) = frame.to_room(&world.hand_state(hand).frozen_pose);
        let turn = frame.to_room(&Pose::ZERO).1;
        let normal = world.hand_contact(hand).map_or(Vec3::Y, |contact| turn * contact.normal);
        let radius = match bit.spec_at(world.workbench().size_of(bit)).shape {
            BitShape::Ball { radius_um } => radius_um,
            BitShape::Box { half_extents_um: [x, y, _] } => x.min(y),
            // The chips of a saw fly from its rim.
            BitShape::Disc { radius_um } => radius_um,
        } as f32
            * 1e-6;
        // A chip stands for a few cubic millimetres: finer grids throw no more.
        let volume = removed_voxels as f32 * (frame.voxel_metres() * 1e3).powi(3);
        let count = ((volume / 250.0).ceil() as u32).min(EDIT_PARTICLES);
        for i in 0..u64::from(count) {
            let seed = seed + i;
            let aside = random_in_cube(seed, 10);
            let from = centre + (aside * 0.8 - normal * 0.5) * radius;
            let smooth = bit.spec().action == BitAction::Smooth;
            let kind = if smooth || i % 3 != 0 { ParticleKind::Dust } else { ParticleKind::Chip };
            let speed = if kind == ParticleKind::Chip { 0.9 } else { 0.7 };
            let way = normal * 0.9 + aside * 0.8 + Vec3::Y * 0.5;
            self.particles.spawn(kind, from, way * speed, seed);
        }
    }

    /// Drops a removed island as a falling stone, or spawns motes in its place if it is too small for one.
    fn drop_island<const N: usize, const K: usize>(&mut self, world: &World<N, K>, seed: u64)
    where
        Grid<N>: Size,
    {
        let frame = world.stool_frame();
        if self.stones.drop_removed(&self.lattice, N, &frame, seed) {
            return;
        }
        let mut seed = seed;
        let particles = &mut self.particles;
        self.lattice.for_some_removed_samples(N, |voxel| {
            seed += 1;
            let aside = random_in_cube(seed, 10);
            let pose = Pose { position: voxel + aside * 1.5, rotation: Quat::IDENTITY };
            let (from, _) = frame.to_room(&pose);
            particles.spawn(ParticleKind::Mote, from, aside * 0.05, seed);
        });
    }
}

/// Returns the transform from an item's own space, at a pose, to the room.
pub(super) fn room_from_pose((position, rotation): RoomPose) -> Affine3A {
    Affine3A::from_rotation_translation(rotation, position)
}
