//! Chips and dust: a ring of particles that fly, bounce, come to rest and fade by shrinking.
//!
//! For show only: no digest knows them. What they do is a function of the events and of the times
//! they are moved by.

use glam::{Affine3A, Quat, Vec3};
use paros_core::frame::{BOX, STOOL};
use paros_core::workbench::BENCH_TOP;

use super::draw::DrawList;
use super::meshes::MeshId;
use crate::constants::MARBLE_WHITE;
use crate::limits::PARTICLES;

/// What a particle is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Kind {
    /// A splinter: it falls, bounces and lies for a while.
    Chip,
    /// Dust: it floats down.
    Dust,
    /// What is left of an island: it hangs in the air and is gone soon.
    Mote,
}

#[derive(Clone, Copy, Debug)]
struct Particle {
    kind: Kind,
    /// Seconds left; none are drawn from 0 on.
    left: f32,
    life: f32,
    size: f32,
    position: Vec3,
    velocity: Vec3,
    /// Half the turn a second, as a scaled axis.
    spin: Vec3,
    rotation: Quat,
    shade: f32,
}

/// The ring.
#[derive(Debug)]
pub struct Particles {
    ring: Vec<Particle>,
    next: usize,
}

/// Seconds that a trace of an island is seen.
pub const TRACE: f32 = 1.2;

/// Seconds that the longest-lived particle is seen.
pub const LONGEST: f32 = 2.4;

/// The most that one move can make up for, in seconds.
const MOST: f32 = 0.1;

impl Default for Particles {
    fn default() -> Self {
        Self::new()
    }
}

impl Particles {
    /// None, and room for all.
    #[must_use]
    pub fn new() -> Self {
        Particles { ring: Vec::with_capacity(PARTICLES), next: 0 }
    }

    /// Forgets all.
    pub fn clear(&mut self) {
        self.ring.clear();
        self.next = 0;
    }

    /// How many are seen.
    #[must_use]
    pub fn alive(&self) -> usize {
        self.ring.iter().filter(|p| p.left > 0.0).count()
    }

    /// Throws one from `position` with `velocity`, both in metres; `seed` makes it differ from
    /// others. The oldest makes room.
    pub fn throw(&mut self, kind: Kind, position: Vec3, velocity: Vec3, seed: u64) {
        let [a, b, c, d, e] = [0, 1, 2, 3, 4].map(|i| chance(seed, i));
        let (life, size) = match kind {
            Kind::Chip => (1.0 + (LONGEST - 1.0) * a, 0.003 + 0.006 * b * b),
            Kind::Dust => (0.5 + 0.6 * a, 0.0012 + 0.0016 * b),
            Kind::Mote => (TRACE * (0.6 + 0.4 * a), 0.004 + 0.006 * b),
        };
        let spin = scatter(seed, 5) * if kind == Kind::Chip { 18.0 } else { 2.0 };
        let rotation = Quat::from_xyzw(c - 0.5, d - 0.5, e - 0.5, 0.6).normalize();
        let shade = 0.82 + 0.18 * c;
        let particle =
            Particle { kind, left: life, life, size, position, velocity, spin, rotation, shade };
        if self.ring.len() < PARTICLES {
            self.ring.push(particle);
        } else {
            self.ring[self.next] = particle;
        }
        self.next = (self.next + 1) % PARTICLES;
    }

    /// Moves all by a time in seconds.
    pub fn advance(&mut self, seconds: f32) {
        let seconds = seconds.clamp(0.0, MOST);
        for particle in self.ring.iter_mut().filter(|p| p.left > 0.0) {
            particle.advance(seconds);
        }
    }

    pub(super) fn draw(&self, list: &mut DrawList) {
        for p in self.ring.iter().filter(|p| p.left > 0.0) {
            let mesh = if p.kind == Kind::Dust { MeshId::Speck } else { MeshId::Chip };
            // Shrinks over the last third of its time; a mote all the while.
            let fade = match p.kind {
                Kind::Mote => p.left / p.life,
                Kind::Chip | Kind::Dust => (3.0 * p.left / p.life).min(1.0),
            };
            let scale = Vec3::splat(p.size * fade);
            let at = Affine3A::from_scale_rotation_translation(scale, p.rotation, p.position);
            let [r, g, b] = MARBLE_WHITE.map(|part| part * p.shade);
            list.add(mesh, at, [r, g, b, 0.0]);
        }
    }
}

impl Particle {
    fn advance(&mut self, seconds: f32) {
        self.left -= seconds;
        let (gravity, drag) = match self.kind {
            Kind::Chip => (9.81, 0.3),
            Kind::Dust => (1.2, 5.0),
            Kind::Mote => (0.5, 2.5),
        };
        self.velocity.y -= gravity * seconds;
        self.velocity *= 1.0 / (1.0 + drag * seconds);
        let before = self.position.y;
        self.position += self.velocity * seconds;
        let ground = ground(self.position, before) + 0.3 * self.size;
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

/// The height of what is under a point that came from height `before`: stool, bench or floor.
fn ground(point: Vec3, before: f32) -> f32 {
    let aside = point - STOOL;
    let on_stool = aside.x * aside.x + aside.z * aside.z < 0.55 * BOX * BOX;
    let on_bench = (0.3..0.9).contains(&point.x) && (-0.8..0.2).contains(&point.z);
    if on_stool && before > STOOL.y - 0.02 {
        STOOL.y
    } else if on_bench && before > BENCH_TOP - 0.02 {
        BENCH_TOP
    } else {
        0.0
    }
}

/// A number in 0..1, the `i`th for a seed.
pub(super) fn chance(seed: u64, i: u64) -> f32 {
    let hash = paros_core::volume::mix(seed.wrapping_mul(64).wrapping_add(i));
    (hash >> 40) as f32 / (1u64 << 24) as f32
}

/// A vector in the cube from -1 to 1, by the `i`th and the next two numbers for a seed.
pub(super) fn scatter(seed: u64, i: u64) -> Vec3 {
    Vec3::new(chance(seed, i), chance(seed, i + 1), chance(seed, i + 2)) * 2.0 - 1.0
}
