//! The light that falls in the studio, by rays: sun and sky through the window, and what floor and
//! walls give back.

use core::f32::consts::PI;

use std::collections::HashMap;

use glam::{Quat, Vec3};

use super::bvh::Bvh;
use super::{Corner, Mesh};
use crate::constants::{SUN_COLOR, SUN_DIRECTION};
use crate::harmonics::{ambient, basis};

/// Rays for a corner, and for each place of a group of triangles that give light back.
const CORNER_RAYS: usize = 48;
/// Rays for a corner of a thing that shades itself.
const OWN_RAYS: usize = 32;
/// Corners as close as this, in metres, may share what they receive.
const CLOSE: f32 = 0.02;
/// How often openness is smoothed.
const SMOOTHINGS: usize = 3;
const GROUP_RAYS: usize = 16;
const GROUP_PLACES: usize = 3;
/// Side of the cells in which triangles that face alike are a group, in metres.
const GROUP_CELL: f32 = 0.5;
/// Rays for the light about the sculpture.
const SPHERE_RAYS: usize = 8_192;
/// How often light is given back.
const BOUNCES: usize = 2;
/// How far a thing that is carried about shades itself, in metres.
const OWN_REACH: f32 = 0.12;
/// A ray starts this far over the surface, in metres.
const OFF: f32 = 0.002;
const FAR: f32 = 40.0;

/// Radiance of the sky in a direction: hazy and bright, and a garden under it.
pub(crate) fn sky(way: Vec3) -> Vec3 {
    let up = (way.y * 4.0 + 0.4).clamp(0.0, 1.0);
    Vec3::new(0.8, 0.86, 0.62).lerp(Vec3::new(4.6, 5.0, 5.7), up)
}

/// The standing things, and the radiance that each of their triangles gives back.
pub(crate) struct Lit {
    bvh: Bvh,
    radiance: Vec<Vec3>,
}

impl Lit {
    /// Lights all triangles that lie within the room's `inner` bounds. Neighbours that face alike
    /// share what they receive of each other's light.
    pub(crate) fn new(things: &Mesh, inner: (Vec3, Vec3)) -> Self {
        let numbered = (0u32..).zip(things.triangles.iter().map(|t| things.positions(*t)));
        let radiance = vec![Vec3::ZERO; things.triangles.len()];
        let mut lit = Lit { bvh: Bvh::new(numbered.collect()), radiance };
        let places: Vec<Place> = things.triangles.iter().map(|t| Place::of(things, *t)).collect();
        let is_in =
            |place: &Place| place.start.cmpge(inner.0).all() && place.start.cmple(inner.1).all();
        let sun = in_parallel(&places, |place| match is_in(place) {
            true => lit.sun(place.start, place.normal),
            false => Vec3::ZERO,
        });
        let mut groups = HashMap::new();
        let mut shared: Vec<Vec<Place>> = Vec::new();
        let group: Vec<usize> = places
            .iter()
            .map(|place| {
                let at = *groups.entry(place.cell()).or_insert(shared.len());
                if at == shared.len() {
                    shared.push(Vec::new());
                }
                if shared[at].len() < GROUP_PLACES && is_in(place) {
                    shared[at].push(*place);
                }
                at
            })
            .collect();
        for _ in 0..=BOUNCES {
            let received = in_parallel(&shared, |places| {
                let each = |p: &Place| lit.ambient(p.start, p.normal, GROUP_RAYS);
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

    /// Light at a corner but for the sun's own, over pi.
    pub(crate) fn at(&self, position: Vec3, normal: Vec3) -> Vec3 {
        self.ambient(position + normal * OFF, normal, CORNER_RAYS)
    }

    /// Radiance that arrives at a point, as spherical harmonics of bands 0 to 2.
    pub(crate) fn harmonics(&self, point: Vec3) -> [[f32; 3]; 9] {
        let mut sum = [Vec3::ZERO; 9];
        for i in 0..SPHERE_RAYS {
            let way = on_sphere(i, SPHERE_RAYS);
            let light = self.radiance(point, way) * (4.0 * PI / SPHERE_RAYS as f32);
            for (sum, basis) in sum.iter_mut().zip(basis(way)) {
                *sum += light * basis;
            }
        }
        sum.map(|light| light.to_array())
    }

    /// Irradiance by the sun, over pi.
    fn sun(&self, start: Vec3, normal: Vec3) -> Vec3 {
        let sun = Vec3::from_array(SUN_DIRECTION);
        let facing = normal.dot(sun);
        if facing <= 0.0 || self.bvh.hit(start, sun, FAR).is_some() {
            return Vec3::ZERO;
        }
        Vec3::from_array(SUN_COLOR) * facing
    }

    fn ambient(&self, start: Vec3, normal: Vec3, rays: usize) -> Vec3 {
        let sum: Vec3 = over(normal, rays).map(|way| self.radiance(start, way)).sum();
        sum / rays as f32
    }

    fn radiance(&self, start: Vec3, way: Vec3) -> Vec3 {
        match self.bvh.hit(start, way, FAR) {
            None => sky(way),
            Some((triangle, _, true)) => self.radiance[triangle as usize],
            Some((_, _, false)) => Vec3::ZERO,
        }
    }
}

/// The middle of a triangle.
#[derive(Clone, Copy)]
struct Place {
    start: Vec3,
    normal: Vec3,
    colour: Vec3,
}

impl Place {
    fn of(things: &Mesh, triangle: [u32; 3]) -> Self {
        let [a, b, c] = things.positions(triangle);
        let normal = (b - a).cross(c - a).normalize();
        let colour = things.corners[triangle[0] as usize].colour;
        Place { start: (a + b + c) / 3.0 + normal * OFF, normal, colour }
    }

    /// Where it is, coarsely, and which way it faces.
    fn cell(&self) -> [i32; 4] {
        let [x, y, z] = (self.start / GROUP_CELL).floor().to_array().map(|f| f as i32);
        let axis = (0..3).max_by(|a, b| self.normal[*a].abs().total_cmp(&self.normal[*b].abs()));
        let axis = axis.unwrap_or(0);
        [x, y, z, 2 * axis as i32 + i32::from(self.normal[axis] > 0.0)]
    }
}

/// Sets how much of the light about the sculpture arrives at each corner of a standing thing.
pub(crate) fn open_in_room(mesh: &mut Mesh, lit: &Lit, about: &[[f32; 3]; 9]) {
    const LUMA: Vec3 = Vec3::new(0.2126, 0.7152, 0.0722);
    set_open(mesh, |corner| {
        let here = lit.at(corner.position, corner.normal).dot(LUMA);
        (here / ambient(about, corner.normal).dot(LUMA).max(1e-3)).min(1.0)
    });
}

/// Sets how open each corner of a thing that is carried about is, past the thing itself.
pub(crate) fn open_alone(mesh: &mut Mesh) {
    let numbered = (0u32..).zip(mesh.triangles.iter().map(|t| mesh.positions(*t)));
    let bvh = Bvh::new(numbered.collect());
    set_open(mesh, |corner| {
        let start = corner.position + corner.normal * (0.2 * OFF);
        let hit = |way: &Vec3| bvh.hit(start, *way, OWN_REACH).is_some();
        let hidden = over(corner.normal, OWN_RAYS).filter(hit).count();
        1.0 - 0.9 * hidden as f32 / OWN_RAYS as f32
    });
}

/// Finds each corner's openness; those that are close together and face alike share it.
fn set_open(mesh: &mut Mesh, open: impl Fn(&Corner) -> f32 + Sync) {
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
    let open = in_parallel(&firsts, open);
    mesh.corners.iter_mut().zip(shared).for_each(|(corner, i)| corner.open = open[i]);
    for _ in 0..SMOOTHINGS {
        smooth_open(mesh);
    }
}

/// Takes each corner's openness half-way to its neighbours' mean: few rays are enough then.
fn smooth_open(mesh: &mut Mesh) {
    let mut sums = vec![(0.0, 0.0); mesh.corners.len()];
    for triangle in &mesh.triangles {
        for (i, j) in [(0, 1), (1, 2), (2, 0), (1, 0), (2, 1), (0, 2)] {
            let [a, b] = [triangle[i], triangle[j]].map(|k| &mesh.corners[k as usize]);
            if a.normal.dot(b.normal) > 0.8 {
                let (sum, count) = &mut sums[triangle[i] as usize];
                (*sum, *count) = (*sum + b.open, *count + 1.0);
            }
        }
    }
    for (corner, (sum, count)) in mesh.corners.iter_mut().zip(sums) {
        if count > 0.0 {
            corner.open = 0.5 * (corner.open + sum / count);
        }
    }
}

/// Directions over a surface, as dense as the cosine: a disc of points, lifted to the half-sphere.
fn over(normal: Vec3, count: usize) -> impl Iterator<Item = Vec3> {
    let turn = Quat::from_rotation_arc(Vec3::Y, normal);
    (0..count).map(move |i| {
        let radius = ((i as f32 + 0.5) / count as f32).sqrt();
        let angle = GOLDEN * i as f32;
        let height = (1.0 - radius * radius).sqrt();
        turn * Vec3::new(radius * angle.cos(), height, radius * angle.sin())
    })
}

fn on_sphere(i: usize, count: usize) -> Vec3 {
    let y = 1.0 - (2.0 * i as f32 + 1.0) / count as f32;
    let radius = (1.0 - y * y).sqrt();
    let angle = GOLDEN * i as f32;
    Vec3::new(radius * angle.cos(), y, radius * angle.sin())
}

/// The golden angle, in radians.
const GOLDEN: f32 = 2.399_963;

/// Maps a slice on all cores, in order.
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
