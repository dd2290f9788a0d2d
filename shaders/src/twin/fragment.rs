//! One fragment of the sculpture: march, surface, light.
//!
//! Source: section 4 of the paper.

use glam::Vec3;
use paros_core::RangeMaps;

use super::march::{Ray, is_point_occupied, march_all_maps, march_maps};
use super::room::{LitRoom, TwinLight};
use super::{fast, light, marble, noise, surface};
use crate::constants::{AMBIENT_HARMONICS, SUN_COLOR, SUN_DIRECTION};
use crate::field::{DensityField, FigureShares};

/// Switches of the paper's path, for its experiments. The default is the path as the paper has it.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct TwinSettings {
    /// `true` for the blob surface and equation 1; `false` for the voxel's face (section 5's first
    /// experiment).
    pub sdf: bool,
    /// `true` for marble, sun, shadow and ambient light; `false` for the normal as a colour.
    pub shading: bool,
    /// `true` to read all three maps at every step, not only at a quick hit. The picture is the same.
    pub full_march: bool,
}

impl Default for TwinSettings {
    fn default() -> Self {
        TwinSettings { sdf: true, shading: true, full_march: false }
    }
}

/// The inputs of a fragment.
#[derive(Clone, Copy)]
pub struct TwinScene<'a, const N: usize, const K: usize = 1> {
    /// The sculpture.
    pub maps: &'a RangeMaps<N, K>,
    /// The noise texture.
    pub noise: &'a [i8],
    /// Cosine and sine of the stool's rotation about y.
    pub turn_cos_sin: [f32; 2],
    /// The parts of the path that are on.
    pub settings: TwinSettings,
    /// The fast path's textures; `None` for the paper's path.
    pub field: Option<&'a DensityField<N, K>>,
    /// The hidden figure, if there is one; the fast path shows it where it is bared.
    pub figure: Option<&'a FigureShares>,
    /// The light.
    pub light: TwinLight,
    /// The room, which may hide the sun, if there is one.
    pub room: Option<&'a LitRoom>,
}

/// A shaded point of the sculpture.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ShadedHit {
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

impl<'a, const N: usize, const K: usize> TwinScene<'a, N, K> {
    /// Creates the scene of a sculpture on a stool rotated by an angle, counter-clockwise from above.
    #[must_use]
    pub fn new(maps: &'a RangeMaps<N, K>, turn_radians: f32, settings: TwinSettings) -> Self {
        TwinScene {
            maps,
            noise: noise::noise_texture(),
            turn_cos_sin: [turn_radians.cos(), turn_radians.sin()],
            settings,
            field: None,
            figure: None,
            light: TwinLight {
                sun_direction: Vec3::from_array(SUN_DIRECTION),
                sun_color: Vec3::from_array(SUN_COLOR),
                ambient: AMBIENT_HARMONICS,
            },
            room: None,
        }
    }

    /// Rotates a studio direction into the grid.
    #[must_use]
    pub fn direction_to_grid(&self, studio_direction: Vec3) -> Vec3 {
        let [c, s] = self.turn_cos_sin;
        let d = studio_direction;
        Vec3::new(c * d.x - s * d.z, d.y, s * d.x + c * d.z)
    }

    /// Rotates a direction of the grid into the studio.
    #[must_use]
    pub fn direction_to_studio(&self, grid_direction: Vec3) -> Vec3 {
        let [c, s] = self.turn_cos_sin;
        let d = grid_direction;
        Vec3::new(c * d.x + s * d.z, d.y, c * d.z - s * d.x)
    }

    /// Converts a studio point to the grid, in voxels. The cube's base is centred on the studio's origin.
    #[must_use]
    pub fn point_to_grid(&self, studio_point: Vec3) -> Vec3 {
        (self.direction_to_grid(studio_point) + Vec3::new(0.5, 0.0, 0.5)) * N as f32
    }

    /// Converts a point of the grid, in voxels, to the studio, in sides of the cube.
    #[must_use]
    pub fn point_to_studio(&self, grid_point: Vec3) -> Vec3 {
        self.direction_to_studio(grid_point / N as f32 - Vec3::new(0.5, 0.0, 0.5))
    }

    /// Returns the sun's irradiance over pi at a surface point of the sculpture, with this normal in the
    /// studio: zero where the room hides the sun. The sculpture's own shadow is left out.
    fn sun_color_at(&self, grid_point: Vec3, studio_normal: Vec3) -> Vec3 {
        let faces_sun = studio_normal.dot(self.light.sun_direction) > 0.0;
        let hides = |room: &LitRoom| !room.lets_sun_to(self.point_to_studio(grid_point));
        if faces_sun && self.room.is_some_and(hides) { Vec3::ZERO } else { self.light.sun_color }
    }

    /// Converts a studio ray to the grid, in voxels.
    #[must_use]
    pub fn ray_to_grid(&self, studio_ray: &Ray) -> Ray {
        Ray {
            origin: self.point_to_grid(studio_ray.origin),
            direction: self.direction_to_grid(studio_ray.direction),
        }
    }
}

/// Casts a studio ray at the sculpture and shades the hit; `None` if the ray misses. `dither` in
/// 0..1 differs from fragment to fragment.
#[must_use]
pub fn shade_ray<const N: usize, const K: usize>(
    scene: &TwinScene<'_, N, K>,
    studio_ray: &Ray,
    dither: f32,
) -> Option<ShadedHit> {
    let inside = scene.ray_to_grid(studio_ray);
    let (at, voxel) = match scene.field {
        Some(field) => {
            let at = fast::find_surface(field, &inside)?;
            (at, at.position.to_array().map(|c| (c as usize).min(N - 1)))
        }
        None => {
            let hit = match scene.settings.full_march {
                true => march_all_maps(scene.maps, &inside)?,
                false => march_maps(scene.maps, &inside)?,
            };
            let at = if scene.settings.sdf {
                surface::trace_blobs_or_closest_approach(scene.maps, &inside, &hit)
            } else {
                surface::entry_face_point(&inside, &hit)
            };
            (at, hit.voxel)
        }
    };
    let normal = scene.direction_to_studio(at.normal);
    let color = match scene.field {
        _ if !scene.settings.shading => normal * 0.5 + Vec3::splat(0.5),
        Some(field) => {
            let direction = scene.direction_to_grid(scene.light.sun_direction);
            let color = scene.sun_color_at(at.position, normal);
            let halfway = fast::halfway_to_eye(direction, inside.origin, N);
            let sun = fast::SunLight { direction, color, halfway };
            let ambient = scene.light.ambient_over_pi(normal);
            let share =
                scene.figure.map_or(0.0, |figure| figure.sample_clamped(at.position / N as f32));
            fast::shade_surface_with_figure(field, &at, &sun, ambient, share)
        }
        None => shade_marble(scene, at.position, at.normal, dither),
    };
    Some(ShadedHit {
        color,
        depth: at.distance / N as f32,
        position: scene.point_to_studio(at.position),
        normal,
        voxel,
    })
}

/// Shades Lambertian marble under the sun and the ambient light; point and normal are in the grid.
fn shade_marble<const N: usize, const K: usize>(
    scene: &TwinScene<'_, N, K>,
    grid_point: Vec3,
    grid_normal: Vec3,
    dither: f32,
) -> Vec3 {
    let (point, normal) = (grid_point, grid_normal);
    let to_sun = scene.direction_to_grid(scene.light.sun_direction);
    let facing = normal.dot(to_sun).max(0.0);
    let held = |at: Vec3| is_point_occupied(scene.maps, at);
    let direct = if facing > 0.0 {
        facing * light::cone_visibility(N, point, to_sun, dither, held)
    } else {
        0.0
    };
    let studio_normal = scene.direction_to_studio(normal);
    let ambient = scene.light.ambient_over_pi(studio_normal);
    marble::reflectance(scene.noise, point / N as f32)
        * (scene.sun_color_at(point, studio_normal) * direct + ambient)
}
