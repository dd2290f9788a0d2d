//! Particle system for chips and dust: a ring buffer of particles that fly, bounce, rest and fade.
//!
//! Cosmetic only, in no digest of the world; deterministic given the events and time steps.

use glam::{Affine3A, Quat, Vec3};
use paros_core::internals::{BENCH_TOP, BOX_SIDE, STOOL_TOP, is_over_bench};

use super::draw::DrawList;
use super::meshes::MeshId;
use crate::constants::MARBLE_BASE_COLOR;
use crate::limits::PARTICLES;

/// The kind of a particle.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ParticleKind {
    /// A splinter: it falls, bounces and rests for a while.
    Chip,
    /// Dust: it floats down.
    Dust,
    /// The trace of a removed island: it hangs in the air and fades soon.
    Mote,
}

#[derive(Clone, Copy, Debug)]
struct Particle {
    kind: ParticleKind,
    /// Drawn while positive.
    seconds_left: f32,
    life_seconds: f32,
    size: f32,
    position: Vec3,
    velocity: Vec3,
    /// Angular velocity: axis times radians a second.
    spin: Vec3,
    rotation: Quat,
    shade: f32,
}

/// The particles, in a ring buffer.
#[derive(Debug)]
pub struct Particles {
    ring: Vec<Particle>,
    next: usize,
}

/// Longest life of a mote, in seconds.
pub const MOTE_SECONDS: f32 = 1.2;

/// Longest life of any particle, in seconds.
pub const MAX_LIFE_SECONDS: f32 = 2.4;

/// Longest time step, in seconds; longer steps are clamped.
pub(super) const MAX_STEP_SECONDS: f32 = 0.1;

impl Default for Particles {
    fn default() -> Self {
        Self::new()
    }
}

impl Particles {
    /// Creates a system without particles, with capacity for all.
    #[must_use]
    pub fn new() -> Self {
        Particles { ring: Vec::with_capacity(PARTICLES), next: 0 }
    }

    /// Removes all particles.
    pub fn clear(&mut self) {
        self.ring.clear();
        self.next = 0;
    }

    /// Returns the number of particles alive.
    #[must_use]
    pub fn alive_count(&self) -> usize {
        self.ring.iter().filter(|p| p.seconds_left > 0.0).count()
    }

    /// Spawns a particle with this position and velocity; `seed` varies it. Replaces the oldest when full.
    pub fn spawn(
        &mut self,
        kind: ParticleKind,
        position_metres: Vec3,
        metres_per_second: Vec3,
        seed: u64,
    ) {
        let [a, b, c, d, e] = [0, 1, 2, 3, 4].map(|i| random_fraction(seed, i));
        let (life_seconds, size) = match kind {
            ParticleKind::Chip => (1.0 + (MAX_LIFE_SECONDS - 1.0) * a, 0.003 + 0.006 * b * b),
            ParticleKind::Dust => (0.5 + 0.6 * a, 0.0012 + 0.0016 * b),
            ParticleKind::Mote => (MOTE_SECONDS * (0.6 + 0.4 * a), 0.004 + 0.006 * b),
        };
        let spin = random_in_cube(seed, 5) * if kind == ParticleKind::Chip { 18.0 } else { 2.0 };
        let rotation = Quat::from_xyzw(c - 0.5, d - 0.5, e - 0.5, 0.6).normalize();
        let shade = 0.82 + 0.18 * c;
        let particle = Particle {
            kind,
            seconds_left: life_seconds,
            life_seconds,
            size,
            position: position_metres,
            velocity: metres_per_second,
            spin,
            rotation,
            shade,
        };
        if self.ring.len() < PARTICLES {
            self.ring.push(particle);
        } else {
            self.ring[self.next] = particle;
        }
        self.next = (self.next + 1) % PARTICLES;
    }

    /// Integrates all particles over a time step in seconds.
    pub fn advance_time(&mut self, seconds: f32) {
        let seconds = seconds.clamp(0.0, MAX_STEP_SECONDS);
        for particle in self.ring.iter_mut().filter(|p| p.seconds_left > 0.0) {
            particle.advance_time(seconds);
        }
    }

    pub(super) fn add_instances(&self, list: &mut DrawList) {
        for p in self.ring.iter().filter(|p| p.seconds_left > 0.0) {
            let mesh = if p.kind == ParticleKind::Dust { MeshId::Speck } else { MeshId::Chip };
            // Particles fade over the last third of their life, motes over all of it.
            let fade = match p.kind {
                ParticleKind::Mote => p.seconds_left / p.life_seconds,
                ParticleKind::Chip | ParticleKind::Dust => {
                    (3.0 * p.seconds_left / p.life_seconds).min(1.0)
                }
            };
            let scale = Vec3::splat(p.size);
            let at = Affine3A::from_scale_rotation_translation(scale, p.rotation, p.position);
            let [r, g, b] = MARBLE_BASE_COLOR.map(|part| part * p.shade);
            list.add(mesh, at, [r, g, b, fade]);
        }
    }
}

impl Particle {
    fn advance_time(&mut self, seconds: f32) {
        self.seconds_left -= seconds;
        let (gravity, drag) = match self.kind {
            ParticleKind::Chip => (9.81, 0.3),
            ParticleKind::Dust => (1.2, 5.0),
            ParticleKind::Mote => (0.5, 2.5),
        };
        self.velocity.y -= gravity * seconds;
        self.velocity *= 1.0 / (1.0 + drag * seconds);
        let previous_height = self.position.y;
        self.position += self.velocity * seconds;
        let ground = ground_height_metres(self.position, previous_height) + 0.3 * self.size;
        if self.position.y < ground && self.velocity.y < 0.0 {
            self.position.y = ground;
            self.velocity *= Vec3::new(0.55, -0.3, 0.55);
            self.spin *= 0.5;
            if self.velocity.y < 0.15 {
                (self.velocity, self.spin) = (Vec3::ZERO, Vec3::ZERO);
            }
        }
        let turn = self.spin * (0.5 * seconds);
        let turned = Quat::from_xyzw(turn.x, turn.y, turn.z, 1.0) * self.rotation;
        self.rotation = turned.normalize();
    }
}

/// Returns the height of the ground under a point, in metres: the stool or the bench, if `previous_height`
/// was above it, else the floor.
pub(super) fn ground_height_metres(point: Vec3, previous_height: f32) -> f32 {
    let aside = point - STOOL_TOP;
    let on_stool = aside.x * aside.x + aside.z * aside.z < 0.55 * BOX_SIDE * BOX_SIDE;
    if on_stool && previous_height > STOOL_TOP.y - 0.02 {
        STOOL_TOP.y
    } else if is_over_bench(point) && previous_height > BENCH_TOP - 0.02 {
        BENCH_TOP
    } else {
        0.0
    }
}

/// Returns a pseudo-random number in 0..1: the one of this number from a seed.
pub(super) fn random_fraction(seed: u64, number: u64) -> f32 {
    let hash = paros_core::internals::mix_bits(seed.wrapping_mul(64).wrapping_add(number));
    (hash >> 40) as f32 / (1u64 << 24) as f32
}

/// Returns a pseudo-random vector in the cube from -1 to 1, from three numbers of a seed.
pub(super) fn random_in_cube(seed: u64, first_number: u64) -> Vec3 {
    let i = first_number;
    Vec3::new(random_fraction(seed, i), random_fraction(seed, i + 1), random_fraction(seed, i + 2))
        * 2.0
        - 1.0
}
