//! Falling stones: removed islands, until they land and break into chips.
//!
//! Cosmetic only, like the particles. A stone consists of coarse cells of the removed island. It falls as
//! one rigid body, slides off stone that it lies on, and breaks where it meets stool, bench or floor.

use glam::{Affine3A, Quat, Vec3};
use paros_core::edit::Pose;
use paros_core::internals::STOOL_TOP;
use paros_core::session::StoolFrame;

use super::draw::DrawList;
use super::island::IslandLattice;
use super::meshes::MeshId;
use super::particles::{
    MAX_STEP_SECONDS, ParticleKind, Particles, ground_height_metres, random_in_cube,
};
use crate::constants::MARBLE_BASE_COLOR;
use crate::limits::{FALLING_STONE_CELLS, FALLING_STONES};

/// Longest fall, in seconds; after it a stone breaks where it is.
pub const MAX_FALL_SECONDS: f32 = 2.0;

/// Speed at which a stone slides off stone that it lies on, away from the stool's middle, in metres a
/// second.
const SLIDE_SPEED: f32 = 0.45;

/// The fewest cells of a stone; a smaller island becomes motes at once.
const LEAST_CELLS: usize = 2;

/// Scale of a cell's shard, relative to the cell, so that a stone has no holes.
const OVERLAP: f32 = 1.25;

#[derive(Clone, Debug)]
struct FallingStone {
    /// Offsets of the cells from the stone's middle, in metres. Keeps its capacity.
    cells: Vec<Vec3>,
    cell_size: f32,
    position: Vec3,
    rotation: Quat,
    velocity: Vec3,
    spin: Vec3,
    seconds_left: f32,
    seed: u64,
}

/// The stones that fall.
#[derive(Debug)]
pub(super) struct FallingStones {
    stones: Vec<FallingStone>,
    next: usize,
}

impl FallingStones {
    /// Creates the stones, none of them falling. Allocates all memory.
    pub(super) fn new() -> Self {
        let stone = || FallingStone {
            cells: Vec::with_capacity(FALLING_STONE_CELLS),
            cell_size: 0.0,
            position: Vec3::ZERO,
            rotation: Quat::IDENTITY,
            velocity: Vec3::ZERO,
            spin: Vec3::ZERO,
            seconds_left: 0.0,
            seed: 0,
        };
        FallingStones { stones: (0..FALLING_STONES).map(|_| stone()).collect(), next: 0 }
    }

    pub(super) fn clear(&mut self) {
        self.stones.iter_mut().for_each(|stone| stone.seconds_left = 0.0);
    }

    /// Drops what the last tick removed, in the place of the oldest stone. Returns `true` if it was large
    /// enough.
    pub(super) fn drop_removed(
        &mut self,
        lattice: &IslandLattice,
        grid_side: usize,
        frame: &StoolFrame,
        seed: u64,
    ) -> bool {
        let stone = &mut self.stones[self.next];
        stone.cells.clear();
        let cells = &mut stone.cells;
        let cell_voxels =
            lattice.for_removed_outer_samples(grid_side, FALLING_STONE_CELLS, |voxel| {
                cells.push(frame.to_room(&Pose { position: voxel, rotation: Quat::IDENTITY }).0);
            });
        stone.seconds_left = 0.0;
        if stone.cells.len() < LEAST_CELLS {
            return false;
        }
        let middle = stone.cells.iter().sum::<Vec3>() / stone.cells.len() as f32;
        stone.cells.iter_mut().for_each(|cell| *cell -= middle);
        stone.cell_size = cell_voxels * frame.voxel_metres();
        (stone.position, stone.rotation) = (middle, Quat::IDENTITY);
        stone.velocity = Vec3::ZERO;
        stone.spin = random_in_cube(seed, 40) * 0.8;
        stone.seconds_left = MAX_FALL_SECONDS;
        stone.seed = seed;
        self.next = (self.next + 1) % FALLING_STONES;
        true
    }

    /// Integrates all stones over a time step in seconds; those that land break into `particles`.
    pub(super) fn advance_time(
        &mut self,
        seconds: f32,
        (lattice, grid_side): (&IslandLattice, usize),
        frame: &StoolFrame,
        particles: &mut Particles,
    ) {
        let seconds = seconds.clamp(0.0, MAX_STEP_SECONDS);
        for stone in self.stones.iter_mut().filter(|stone| stone.seconds_left > 0.0) {
            let is_on_stone = stone.places().any(|at| {
                let pose = frame.to_grid(at, Quat::IDENTITY);
                lattice.holds(grid_side, pose.position)
            });
            if stone.advance_time(seconds, is_on_stone) {
                stone.break_into(particles);
            }
        }
    }

    pub(super) fn add_instances(&self, list: &mut DrawList) {
        for stone in self.stones.iter().filter(|stone| stone.seconds_left > 0.0) {
            for (i, at) in (0u64..).zip(stone.places()) {
                let turned = random_in_cube(stone.seed.wrapping_add(i), 20);
                let rotation =
                    stone.rotation * Quat::from_xyzw(turned.x, turned.y, turned.z, 4.0).normalize();
                let scale = Vec3::splat(OVERLAP * stone.cell_size);
                let shard = Affine3A::from_scale_rotation_translation(scale, rotation, at);
                let [r, g, b] = MARBLE_BASE_COLOR;
                list.add(MeshId::Shard, shard, [r, g, b, 0.0]);
            }
        }
    }
}

impl FallingStone {
    /// Returns the positions of the cells, in the room.
    fn places(&self) -> impl Iterator<Item = Vec3> {
        self.cells.iter().map(|cell| self.position + self.rotation * *cell)
    }

    /// Advances the fall by a time step; returns `true` if the stone lands.
    fn advance_time(&mut self, seconds: f32, is_on_stone: bool) -> bool {
        self.seconds_left -= seconds;
        let before = self.position.y;
        if is_on_stone {
            let away = (self.position - STOOL_TOP) * Vec3::new(1.0, 0.0, 1.0);
            let way = away.try_normalize().unwrap_or(Vec3::Z);
            self.velocity = self.velocity.lerp(way * SLIDE_SPEED, (8.0 * seconds).min(1.0));
            self.velocity.y = self.velocity.y.min(0.0);
        } else {
            self.velocity.y -= 9.81 * seconds;
        }
        self.position += self.velocity * seconds;
        let turn = self.spin * (0.5 * seconds);
        self.rotation = (Quat::from_xyzw(turn.x, turn.y, turn.z, 1.0) * self.rotation).normalize();
        let fell = self.position.y - before;
        let half = 0.5 * self.cell_size;
        let lands = self.places().any(|at| {
            let height = at.y - fell;
            at.y - half < ground_height_metres(at, height)
        });
        lands && self.velocity.y < 0.0 || self.seconds_left <= 0.0
    }

    /// Turns the stone into chips and dust at its cells.
    fn break_into(&mut self, particles: &mut Particles) {
        self.seconds_left = 0.0;
        for (i, at) in (0u64..).zip(self.places()) {
            let seed = self.seed.wrapping_add(512 + 2 * i);
            let aside = random_in_cube(seed, 10);
            let way = self.velocity * Vec3::new(0.5, 0.0, 0.5) + aside * 0.5 + Vec3::Y * 0.5;
            particles.spawn(ParticleKind::Chip, at + aside * (0.5 * self.cell_size), way, seed);
            particles.spawn(ParticleKind::Dust, at, way * 0.6, seed + 1);
        }
    }
}
