//! Baked lighting of the studio by ray casting: sun and sky through the window, and diffuse
//! interreflection between floor, walls and furniture (radiosity over groups of triangles).

use core::f32::consts::PI;

use std::collections::HashMap;

use glam::{Quat, Vec3};

use super::{Corner, MeshBuilder};
use crate::bvh::{Bvh, BvhTriangle, HitFace};
use crate::constants::{SUN_COLOR, SUN_DIRECTION};
use crate::harmonics::{irradiance_over_pi, sh_basis};

/// Rays cast from a corner of a standing thing.
const CORNER_RAYS: usize = 64;
/// Rays cast from a corner of a carried thing, for its self-occlusion.
const OWN_RAYS: usize = 32;
/// Corners in one cell of this side, in metres, share an openness.
const CLOSE: f32 = 0.02;
/// Passes that smooth the openness.
const SMOOTHINGS: usize = 6;
/// Rays cast from each sample of a group.
const GROUP_RAYS: usize = 16;
/// Samples of a group at most.
const GROUP_SAMPLES: usize = 3;
/// Side of a group's cell, in metres. The triangles of a group lie in one cell and face along the same
/// axis.
const GROUP_CELL: f32 = 0.5;
/// Rays for the spherical harmonics at the sculpture.
const SPHERE_RAYS: usize = 8_192;
/// Diffuse bounces.
const BOUNCES: usize = 2;
/// Length of a self-occlusion ray, in metres.
const OWN_REACH: f32 = 0.12;
/// Offset of a ray's origin along the normal, in metres.
const RAY_OFFSET: f32 = 0.002;
const FAR: f32 = 40.0;

/// Returns the radiance of the sky in a direction: hazy and bright, and a garden under it.
pub(crate) fn sky_radiance(direction: Vec3) -> Vec3 {
    let up = (direction.y * 4.0 + 0.4).clamp(0.0, 1.0);
    Vec3::new(0.8, 0.86, 0.62).lerp(Vec3::new(4.6, 5.0, 5.7), up)
}

/// The standing things, and the outgoing radiance of each of their triangles.
pub(crate) struct RoomLight {
    bvh: Bvh,
    radiance: Vec<Vec3>,
}

impl RoomLight {
    /// Solves the radiance of all triangles within the room's inside. Triangles of a group share their
    /// indirect light.
    pub(crate) fn new(things: &MeshBuilder, inside: &BoxBounds) -> Self {
        let radiance = vec![Vec3::ZERO; things.triangles.len()];
        let mut lit = RoomLight { bvh: build_bvh(things), radiance };
        let places: Vec<TriangleCentre> =
            things.triangles.iter().map(|t| TriangleCentre::of(things, *t)).collect();
        let is_in = |place: &TriangleCentre| {
            place.start.cmpge(inside.low).all() && place.start.cmple(inside.high).all()
        };
        let sun = in_parallel(&places, |place| match is_in(place) {
            true => lit.sun_irradiance_over_pi(place.start, place.normal),
            false => Vec3::ZERO,
        });
        let mut groups = HashMap::new();
        let mut shared: Vec<Vec<TriangleCentre>> = Vec::new();
        let group: Vec<usize> = places
            .iter()
            .map(|place| {
                let at = *groups.entry(place.group_key()).or_insert(shared.len());
                if at == shared.len() {
                    shared.push(Vec::new());
                }
                if shared[at].len() < GROUP_SAMPLES && is_in(place) {
                    shared[at].push(*place);
                }
                at
            })
            .collect();
        for _ in 0..=BOUNCES {
            let received = in_parallel(&shared, |places| {
                let each = |p: &TriangleCentre| lit.mean_radiance(p.start, p.normal, GROUP_RAYS);
                places.iter().map(each).sum::<Vec3>() / places.len().max(1) as f32
            });
            lit.radiance = (0..places.len())
                .map(|i| {
                    if is_in(&places[i]) {
                        (sun[i] + received[group[i]]) * places[i].colour
                    } else {
                        Vec3::ZERO
                    }
                })
                .collect();
        }
        lit
    }

    /// Returns the irradiance over pi at a corner, without the direct sun.
    pub(crate) fn ambient_over_pi_at(&self, position: Vec3, normal: Vec3) -> Vec3 {
        self.mean_radiance(position + normal * RAY_OFFSET, normal, CORNER_RAYS)
    }

    /// Returns the incoming radiance at a point, projected onto spherical harmonics of bands 0 to 2.
    pub(crate) fn radiance_sh_at(&self, point: Vec3) -> [[f32; 3]; 9] {
        let mut sum = [Vec3::ZERO; 9];
        for i in 0..SPHERE_RAYS {
            let direction = fibonacci_direction(i, SPHERE_RAYS);
            let light = self.ray_radiance(point, direction) * (4.0 * PI / SPHERE_RAYS as f32);
            for (sum, basis) in sum.iter_mut().zip(sh_basis(direction)) {
                *sum += light * basis;
            }
        }
        sum.map(|light| light.to_array())
    }

    /// Returns the irradiance over pi by the direct sun.
    fn sun_irradiance_over_pi(&self, start: Vec3, normal: Vec3) -> Vec3 {
        let sun = Vec3::from_array(SUN_DIRECTION);
        let facing = normal.dot(sun);
        if facing <= 0.0 || self.bvh.nearest_hit(start, sun, FAR).is_some() {
            return Vec3::ZERO;
        }
        Vec3::from_array(SUN_COLOR) * facing
    }

    /// Returns the irradiance over pi by cosine-weighted sampling: the mean radiance of `ray_count` rays.
    fn mean_radiance(&self, start: Vec3, normal: Vec3, ray_count: usize) -> Vec3 {
        let sum: Vec3 = cosine_directions(normal, ray_count)
            .map(|direction| self.ray_radiance(start, direction))
            .sum();
        sum / ray_count as f32
    }

    /// Returns the radiance that arrives along a ray; back faces are black.
    fn ray_radiance(&self, start: Vec3, direction: Vec3) -> Vec3 {
        match self.bvh.nearest_hit(start, direction, FAR) {
            None => sky_radiance(direction),
            Some(hit) if hit.face == HitFace::Front => self.radiance[hit.triangle as usize],
            Some(_) => Vec3::ZERO,
        }
    }
}

/// A box by two of its corners, in metres.
pub(crate) struct BoxBounds {
    pub(crate) low: Vec3,
    pub(crate) high: Vec3,
}

/// Builds the hierarchy of a mesh's triangles, numbered by their index in the mesh.
fn build_bvh(mesh: &MeshBuilder) -> Bvh {
    let numbered = (0u32..).zip(&mesh.triangles);
    let triangle =
        |(number, t): (u32, &[u32; 3])| BvhTriangle { number, corners: mesh.corner_positions(*t) };
    Bvh::new(numbered.map(triangle).collect())
}

/// The centroid of a triangle, moved off its surface.
#[derive(Clone, Copy)]
struct TriangleCentre {
    start: Vec3,
    normal: Vec3,
    colour: Vec3,
}

impl TriangleCentre {
    fn of(things: &MeshBuilder, triangle: [u32; 3]) -> Self {
        let [a, b, c] = things.corner_positions(triangle);
        let normal = (b - a).cross(c - a).normalize();
        let colour = things.corners[triangle[0] as usize].colour;
        TriangleCentre { start: (a + b + c) / 3.0 + normal * RAY_OFFSET, normal, colour }
    }

    fn group_key(&self) -> GroupKey {
        let cell = (self.start / GROUP_CELL).floor().to_array().map(|f| f as i32);
        let axis = (0..3).max_by(|a, b| self.normal[*a].abs().total_cmp(&self.normal[*b].abs()));
        let axis = axis.unwrap_or(0);
        GroupKey { cell, axis, is_positive: self.normal[axis] > 0.0 }
    }
}

/// Properties that the triangles of a group share.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
struct GroupKey {
    cell: [i32; 3],
    /// The axis that their normals are closest to, and the sign along it.
    axis: usize,
    is_positive: bool,
}

/// Sets the openness of each corner of a standing thing: the ratio of its luminance to that of the
/// ambient harmonics at the sculpture, at most 1.
pub(crate) fn set_openness_in_room(
    mesh: &mut MeshBuilder,
    light: &RoomLight,
    sculpture_radiance_sh: &[[f32; 3]; 9],
) {
    const LUMA: Vec3 = Vec3::new(0.2126, 0.7152, 0.0722);
    set_openness(mesh, |corner| {
        let here = light.ambient_over_pi_at(corner.position, corner.normal).dot(LUMA);
        (here / irradiance_over_pi(sculpture_radiance_sh, corner.normal).dot(LUMA).max(1e-3))
            .min(1.0)
    });
}

/// Ambient occlusion of a carried thing by itself: sets the openness of each corner.
pub(crate) fn set_openness_by_itself(mesh: &mut MeshBuilder) {
    let bvh = build_bvh(mesh);
    set_openness(mesh, |corner| {
        let start = corner.position + corner.normal * (0.2 * RAY_OFFSET);
        let hit = |direction: &Vec3| bvh.nearest_hit(start, *direction, OWN_REACH).is_some();
        let hidden = cosine_directions(corner.normal, OWN_RAYS).filter(hit).count();
        1.0 - 0.9 * hidden as f32 / OWN_RAYS as f32
    });
}

/// Sets each corner's openness, computed once for corners that are close together and face alike.
fn set_openness(mesh: &mut MeshBuilder, openness_of: impl Fn(&Corner) -> f32 + Sync) {
    let mut numbers = HashMap::new();
    let mut firsts = Vec::new();
    let shared: Vec<usize> = mesh
        .corners
        .iter()
        .map(|corner| {
            let [x, y, z] = (corner.position / CLOSE).round().to_array().map(|f| f as i32);
            let [a, b, c] = (corner.normal * 2.0).round().to_array().map(|f| f as i32);
            *numbers.entry([x, y, z, a, b, c]).or_insert_with(|| {
                firsts.push(*corner);
                firsts.len() - 1
            })
        })
        .collect();
    let open = in_parallel(&firsts, openness_of);
    mesh.corners.iter_mut().zip(shared).for_each(|(corner, i)| corner.openness = open[i]);
    let welded = weld_corners(mesh);
    for _ in 0..SMOOTHINGS {
        smooth_openness(mesh, &welded);
    }
}

/// Returns a number for each corner. Corners in one place that face alike share a number: adjacent strips
/// of a smooth surface each have their own corner there.
fn weld_corners(mesh: &MeshBuilder) -> Vec<usize> {
    let mut numbers = HashMap::new();
    let rounded = |v: Vec3, scale: f32| (v * scale).round().to_array().map(|f| f as i32);
    let key = |corner: &Corner| (rounded(corner.position, 2e4), rounded(corner.normal, 32.0));
    let keys = mesh.corners.iter().map(key);
    keys.map(|key| {
        let next = numbers.len();
        *numbers.entry(key).or_insert(next)
    })
    .collect()
}

/// Laplacian smoothing: moves each corner's openness half-way to the mean of its neighbours, which removes
/// the noise of few rays. Corners that share a number count as one.
fn smooth_openness(mesh: &mut MeshBuilder, welded: &[usize]) {
    let mut sums = vec![(0.0, 0.0); mesh.corners.len()];
    let mut own = vec![(0.0, 0.0); mesh.corners.len()];
    for triangle in &mesh.triangles {
        for (i, j) in [(0, 1), (1, 2), (2, 0), (1, 0), (2, 1), (0, 2)] {
            let [a, b] = [triangle[i], triangle[j]].map(|k| &mesh.corners[k as usize]);
            if a.normal.dot(b.normal) > 0.8 {
                let (sum, count) = &mut sums[welded[triangle[i] as usize]];
                (*sum, *count) = (*sum + b.openness, *count + 1.0);
            }
        }
    }
    for (corner, number) in mesh.corners.iter().zip(welded) {
        let (sum, count) = &mut own[*number];
        (*sum, *count) = (*sum + corner.openness, *count + 1.0);
    }
    for (corner, number) in mesh.corners.iter_mut().zip(welded) {
        let ((around, neighbours), (here, corners)) = (sums[*number], own[*number]);
        corner.openness = here / corners;
        if neighbours > 0.0 {
            corner.openness = 0.5 * (corner.openness + around / neighbours);
        }
    }
}

/// Returns cosine-weighted directions over a surface: a Vogel spiral on the disc, projected up to the
/// hemisphere (Malley's method).
fn cosine_directions(normal: Vec3, count: usize) -> impl Iterator<Item = Vec3> {
    let turn = Quat::from_rotation_arc(Vec3::Y, normal);
    (0..count).map(move |i| {
        let radius = ((i as f32 + 0.5) / count as f32).sqrt();
        let angle = GOLDEN * i as f32;
        let height = (1.0 - radius * radius).sqrt();
        turn * Vec3::new(radius * angle.cos(), height, radius * angle.sin())
    })
}

/// Returns a point of a Fibonacci sphere of `count` points.
fn fibonacci_direction(index: usize, count: usize) -> Vec3 {
    let y = 1.0 - (2.0 * index as f32 + 1.0) / count as f32;
    let radius = (1.0 - y * y).sqrt();
    let angle = GOLDEN * index as f32;
    Vec3::new(radius * angle.cos(), y, radius * angle.sin())
}

/// The golden angle, in radians.
const GOLDEN: f32 = 2.399_963;

/// Maps a slice in parallel on all cores; results keep the order.
fn in_parallel<T: Sync, U: Send>(items: &[T], each: impl Fn(&T) -> U + Sync) -> Vec<U> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let share = items.len().div_ceil(cores).max(1);
    let each = &each;
    std::thread::scope(|scope| {
        let part = |part| scope.spawn(move || <[T]>::iter(part).map(each).collect::<Vec<U>>());
        let parts: Vec<_> = items.chunks(share).map(part).collect();
        parts.into_iter().flat_map(|part| part.join().expect("no panic in a ray")).collect()
    })
}
