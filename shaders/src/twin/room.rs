//! The lit room around the sculpture, ray cast: the scene's meshes under the studio's light, as the GPU draws them.
//!
//! The twin of `wgsl/scene.wgsl`. Where the program looks into a shadow map, the twin casts a ray towards
//! the sun.

use glam::{Affine3A, Vec3};

use super::bvh::{Bvh, BvhHit, BvhTriangle, HitFace};
use super::fragment::TwinScene;
use super::harmonics;
use super::march::{Ray, march_maps};
use crate::constants::{CONTACT_FADE, CONTACT_HEIGHT, CONTACT_OPACITY};
use crate::field::{DensityField, PAD};
use crate::gpu::RenderStyle;
use crate::scene::{DrawGroup, DrawList, MeshInstance, SculpturePlacement};

/// Offset of a shadow ray's origin along the normal, in metres: `NORMAL_OFFSET` of the program.
const NORMAL_OFFSET: f32 = 0.012;
/// The most back faces that a ray passes through; back faces aren't drawn.
const MOST_BACK_FACES: u32 = 16;
const FAR: f32 = 60.0;

/// The light of a studio: its sun, and the rest as spherical harmonics.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct TwinLight {
    /// Unit vector towards the sun.
    pub sun_direction: Vec3,
    /// The sun's irradiance at normal incidence, over pi.
    pub sun_color: Vec3,
    /// Ambient radiance, as [`AMBIENT_HARMONICS`](crate::constants::AMBIENT_HARMONICS).
    pub ambient: [[f32; 3]; 9],
}

impl TwinLight {
    /// Returns the ambient irradiance over pi of a surface with this normal.
    #[must_use]
    pub fn ambient_over_pi(&self, normal: Vec3) -> Vec3 {
        harmonics::irradiance_over_pi(&self.ambient, normal)
    }
}

/// The room's triangles, and the sculpture's placement among them.
pub struct LitRoom {
    bvh: Bvh,
    /// The triangles that cast shadows; the garden stands in the sun's way, but casts none.
    casters: Bvh,
    triangles: Vec<[RoomCorner; 3]>,
    /// The sculpture's placement.
    pub stand: SculpturePlacement,
    /// The room's light.
    pub light: TwinLight,
    /// `true` if the plain studio, of pictures without a room, surrounds these triangles.
    pub(super) is_in_studio: bool,
}

/// A corner of a triangle, in the room.
#[derive(Clone, Copy)]
struct RoomCorner {
    position: Vec3,
    normal: Vec3,
    color: Vec3,
    openness: f32,
    glow: f32,
}

/// A point of the room that a ray meets.
#[derive(Clone, Copy, Debug)]
pub struct RoomHit {
    /// Distance from the ray's origin, in sides of the cube.
    pub depth: f32,
    triangle: usize,
    point: Vec3,
}

impl LitRoom {
    /// Creates the room of a frame's scene, without the parts that are blended over it.
    #[must_use]
    pub fn new(scene: &DrawList, stand: SculpturePlacement, light: TwinLight) -> Self {
        Self::of_groups(scene, &[DrawGroup::Handheld, DrawGroup::Surroundings], stand, light)
    }

    /// Creates a room of only the hands and tools of a frame's scene, in the plain studio of
    /// [`render_image`](crate::render_image): as cheap as that studio.
    #[must_use]
    pub fn of_hands_in_studio(scene: &DrawList, stand: SculpturePlacement) -> Self {
        let RenderStyle { sun_direction, sun_color, ambient, .. } = RenderStyle::default();
        let light = TwinLight { sun_direction, sun_color, ambient };
        let hands = Self::of_groups(scene, &[DrawGroup::Handheld], stand, light);
        LitRoom { is_in_studio: true, ..hands }
    }

    fn of_groups(
        scene: &DrawList,
        groups: &[DrawGroup],
        stand: SculpturePlacement,
        light: TwinLight,
    ) -> Self {
        let (mut triangles, mut casts_shadow) = (Vec::new(), Vec::new());
        for batch in scene.batches() {
            if groups.contains(&batch.group) {
                let all = &scene.instances()[batch.first as usize..][..batch.count as usize];
                for instance in all {
                    let corners: Vec<_> =
                        batch.mesh.vertices().iter().map(|v| room_corner(v, instance)).collect();
                    let indices = batch.mesh.indices().as_chunks::<3>().0;
                    let corner = |i: u16| corners[usize::from(i)];
                    triangles.extend(indices.iter().map(|triangle| triangle.map(corner)));
                    casts_shadow.resize(triangles.len(), batch.casts_shadow());
                }
            }
        }
        let numbered = |wanted: &dyn Fn(usize) -> bool| {
            let all = triangles.iter().enumerate().filter(|(number, _)| wanted(*number));
            let triangle = |(number, corners): (usize, &[RoomCorner; 3])| BvhTriangle {
                number: number as u32,
                corners: corners.map(|corner| corner.position),
            };
            Bvh::new(all.map(triangle).collect())
        };
        let [bvh, casters] = [numbered(&|_| true), numbered(&|number| casts_shadow[number])];
        LitRoom { bvh, casters, triangles, stand, light, is_in_studio: false }
    }

    /// Finds the point where a ray of the studio, in sides of the cube around the sculpture's foot, meets
    /// the room.
    #[must_use]
    pub fn cast_ray(&self, studio_ray: &Ray) -> Option<RoomHit> {
        let origin = self.to_room(studio_ray.origin);
        let mut passed = 0.0;
        for _ in 0..MOST_BACK_FACES {
            let from = origin + studio_ray.direction * passed;
            let BvhHit { triangle, distance, face } =
                self.bvh.nearest_hit(from, studio_ray.direction, FAR)?;
            let distance = passed + distance;
            if face == HitFace::Front {
                let point = origin + studio_ray.direction * distance;
                let depth = distance / self.stand.side;
                return Some(RoomHit { depth, triangle: triangle as usize, point });
            }
            passed = distance + 1e-4;
        }
        None
    }

    /// Returns the linear radiance of a point of the room, before tone mapping.
    #[must_use]
    pub fn shade<const N: usize, const K: usize>(
        &self,
        scene: &TwinScene<'_, N, K>,
        hit: &RoomHit,
    ) -> Vec3 {
        let corners = &self.triangles[hit.triangle];
        let weights = barycentric_weights(corners.map(|corner| corner.position), hit.point);
        let mix = |part: fn(&RoomCorner) -> Vec3| -> Vec3 {
            corners.iter().zip(weights).map(|(corner, weight)| part(corner) * weight).sum()
        };
        let normal = mix(|corner| corner.normal).normalize_or(Vec3::Y);
        let color = mix(|corner| corner.color);
        let [openness, glow, _] =
            mix(|corner| Vec3::new(corner.openness, corner.glow, 0.0)).to_array();
        let studio = |room: Vec3| (room - self.stand.foot) / self.stand.side;
        let mut irradiance = self.light.ambient_over_pi(normal) * openness;
        let facing = normal.dot(self.light.sun_direction);
        if facing > 0.0 {
            let from = hit.point + normal * NORMAL_OFFSET;
            let to_sun = Ray { origin: studio(from), direction: self.light.sun_direction };
            let is_lit = self.is_lit_from(from)
                && march_maps(scene.maps, &scene.ray_to_grid(&to_sun)).is_none();
            irradiance += self.light.sun_color * if is_lit { facing } else { 0.0 };
        }
        if let Some(field) = scene.field {
            let above = scene.point_to_grid(studio(hit.point))
                + scene.direction_to_grid(normal) * CONTACT_HEIGHT;
            irradiance *= contact_openness(field, above);
        }
        color * (irradiance + Vec3::splat(glow))
    }

    /// Returns `true` if the room doesn't hide the sun from a point of the studio.
    pub(super) fn lets_sun_to(&self, studio_point: Vec3) -> bool {
        self.is_lit_from(self.to_room(studio_point))
    }

    fn is_lit_from(&self, point: Vec3) -> bool {
        self.casters.nearest_hit(point, self.light.sun_direction, FAR).is_none()
    }

    fn to_room(&self, studio_point: Vec3) -> Vec3 {
        self.stand.foot + studio_point * self.stand.side
    }
}

/// Transforms a vertex of an instance to the room.
fn room_corner(vertex: &crate::scene::MeshVertex, instance: &MeshInstance) -> RoomCorner {
    let t = &instance.transform;
    let columns = [0, 1, 2, 3].map(|k| Vec3::new(t[k], t[4 + k], t[8 + k]));
    let room_from_mesh = Affine3A::from_cols(
        columns[0].into(),
        columns[1].into(),
        columns[2].into(),
        columns[3].into(),
    );
    let [x, y, z, _] = vertex.normal.map(|c| f32::from(c) / 127.0);
    let [r, g, b, openness] = vertex.colour.map(|c| f32::from(c) / 255.0);
    let [tint_r, tint_g, tint_b, glow] = instance.tint;
    RoomCorner {
        position: room_from_mesh.transform_point3(Vec3::from_array(vertex.position)),
        normal: room_from_mesh.transform_vector3(Vec3::new(x, y, z)).normalize_or(Vec3::Y),
        color: Vec3::new(r * tint_r, g * tint_g, b * tint_b),
        openness,
        glow,
    }
}

/// Returns the barycentric weights of a triangle's corners at a point in it.
fn barycentric_weights([a, b, c]: [Vec3; 3], point: Vec3) -> [f32; 3] {
    let whole = (b - a).cross(c - a);
    let part = |p: Vec3, q: Vec3| (p - point).cross(q - point).dot(whole);
    let weights = [part(b, c), part(c, a), part(a, b)];
    let sum: f32 = weights.iter().sum();
    if sum == 0.0 { [1.0, 0.0, 0.0] } else { weights.map(|weight| weight / sum) }
}

/// The twin of the program's `contact_openness`: `above` is in voxels.
fn contact_openness<const N: usize, const K: usize>(
    field: &DensityField<N, K>,
    above: Vec3,
) -> f32 {
    let side = (N + 2 * PAD) as f32;
    let aside = ((above + Vec3::splat(PAD as f32)) / side - Vec3::splat(0.5)).abs();
    let near = (0.5 * CONTACT_FADE + 1.0 - CONTACT_FADE * aside.max_element()).clamp(0.0, 1.0);
    if near == 0.0 {
        return 1.0;
    }
    1.0 - CONTACT_OPACITY * near * field.sample_density(3, above)
}
