//! One fragment of the sculpture: march, surface, light.
//!
//! Source: section 4 of the paper.

use glam::Vec3;
use paros_core::maps::Maps;

use crate::constants::{SUN_COLOR, SUN_DIRECTION};
use crate::field::Field;
use crate::march::{Ray, march, occupied};
use crate::{fast, light, marble, noise, surface};

/// Which parts of the path are on. The default is the whole path and nothing else.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Settings {
    /// The blob surface and equation 1; else the voxel's face (section 5's first experiment).
    pub sdf: bool,
    /// Marble, sun, shadow and ambient light; else the normal as a colour.
    pub shading: bool,
    /// Look at all three maps on every step, not only on a quick hit. The picture is the same.
    pub full_march: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Settings { sdf: true, shading: true, full_march: false }
    }
}

/// What a fragment reads.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a, const N: usize> {
    /// The sculpture.
    pub maps: &'a Maps<N>,
    /// The noise texture.
    pub noise: &'a [i8],
    /// Cosine and sine of the angle by which the stool has turned about y.
    pub turn: [f32; 2],
    /// The parts of the path that are on.
    pub settings: Settings,
    /// The fast path's textures, if that is the path.
    pub field: Option<&'a Field<N>>,
}

/// A shaded point of the sculpture.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Hit {
    /// Linear radiance.
    pub color: Vec3,
    /// Distance from the ray's origin, in sides of the cube.
    pub depth: f32,
    /// The point, in the studio.
    pub position: Vec3,
    /// The outward unit normal, in the studio.
    pub normal: Vec3,
    /// The voxel that was hit; on the fast path, the one that the point lies in.
    pub voxel: [usize; 3],
}

impl<'a, const N: usize> Scene<'a, N> {
    /// A sculpture on a stool that has turned by an angle in radians, counter-clockwise from above.
    #[must_use]
    pub fn new(maps: &'a Maps<N>, turn: f32, settings: Settings) -> Self {
        Scene {
            maps,
            noise: noise::texture(),
            turn: [turn.cos(), turn.sin()],
            settings,
            field: None,
        }
    }

    /// A studio direction as one of the volume's.
    #[must_use]
    pub fn direction_inside(&self, d: Vec3) -> Vec3 {
        let [c, s] = self.turn;
        Vec3::new(c * d.x - s * d.z, d.y, s * d.x + c * d.z)
    }

    /// A direction of the volume as one of the studio's.
    #[must_use]
    pub fn direction_outside(&self, d: Vec3) -> Vec3 {
        let [c, s] = self.turn;
        Vec3::new(c * d.x + s * d.z, d.y, c * d.z - s * d.x)
    }

    /// A studio point in voxels. The cube's base is centred on the studio's origin.
    #[must_use]
    pub fn point_inside(&self, p: Vec3) -> Vec3 {
        (self.direction_inside(p) + Vec3::new(0.5, 0.0, 0.5)) * N as f32
    }

    /// A point in voxels as one of the studio's.
    #[must_use]
    pub fn point_outside(&self, p: Vec3) -> Vec3 {
        self.direction_outside(p / N as f32 - Vec3::new(0.5, 0.0, 0.5))
    }

    /// A studio ray in voxels.
    #[must_use]
    pub fn ray_inside(&self, ray: &Ray) -> Ray {
        Ray {
            origin: self.point_inside(ray.origin),
            direction: self.direction_inside(ray.direction),
        }
    }
}

/// The sculpture along a studio ray, shaded; `None` where the ray passes it by and the fragment is
/// discarded. `dither` in 0..1 differs from fragment to fragment.
#[must_use]
pub fn shade<const N: usize>(scene: &Scene<'_, N>, ray: &Ray, dither: f32) -> Option<Hit> {
    let inside = scene.ray_inside(ray);
    let (at, voxel) = match scene.field {
        Some(field) => {
            let at = fast::surface(field, &inside)?;
            (at, at.position.to_array().map(|c| (c as usize).min(N - 1)))
        }
        None => {
            let sample = march(scene.maps, &inside, scene.settings.full_march)?;
            let at = if scene.settings.sdf {
                surface::blobs(scene.maps, &inside, &sample)
            } else {
                surface::face(&inside, &sample)
            };
            (at, sample.voxel)
        }
    };
    let normal = scene.direction_outside(at.normal);
    let color = match scene.field {
        _ if !scene.settings.shading => normal * 0.5 + Vec3::splat(0.5),
        Some(field) => {
            let sun = scene.direction_inside(Vec3::from_array(SUN_DIRECTION));
            let sun = (sun, Vec3::from_array(SUN_COLOR));
            fast::lit(field, &at, sun, light::ambient(normal))
        }
        None => lit(scene, at.position, at.normal, dither),
    };
    Some(Hit {
        color,
        depth: at.distance / N as f32,
        position: scene.point_outside(at.position),
        normal,
        voxel,
    })
}

/// Lambertian marble under the sun and the ambient light; point and normal are the volume's.
fn lit<const N: usize>(scene: &Scene<'_, N>, point: Vec3, normal: Vec3, dither: f32) -> Vec3 {
    let sun = scene.direction_inside(Vec3::from_array(SUN_DIRECTION));
    let facing = normal.dot(sun).max(0.0);
    let held = |at: Vec3| occupied(scene.maps, at);
    let direct =
        if facing > 0.0 { facing * light::visibility(N, point, sun, dither, held) } else { 0.0 };
    let ambient = light::ambient(scene.direction_outside(normal));
    marble::reflectance(scene.noise, point / N as f32)
        * (Vec3::from_array(SUN_COLOR) * direct + ambient)
}
