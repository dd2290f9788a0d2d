//! The studio around the sculpture: a round stool on a floor that runs into the backdrop.
//!
//! Not in the paper, where a game engine draws it: a distance field, sphere traced, that takes the
//! sculpture's shadow by marching the same range maps.

use core::f32::consts::TAU;

use glam::Vec3;

use crate::constants::{GOLDEN_TURN, SUN_COLOR, SUN_DIRECTION};
use crate::fragment::Scene;
use crate::light;
use crate::march::{Ray, march, occupied};

const FLOOR: f32 = -1.1;
const TOP_RADIUS: f32 = 0.74;
const TOP_THICKNESS: f32 = 0.09;
const COLUMN_RADIUS: f32 = 0.5;
const STOOL_COLOR: Vec3 = Vec3::new(0.13, 0.105, 0.09);
const FLOOR_COLOR: Vec3 = Vec3::new(0.16, 0.155, 0.155);
const SUN_RADIUS: f32 = 0.09;
const SHADOW_RAYS: u32 = 4;
const FAR: f32 = 14.0;

/// Linear radiance of the studio along a ray that passes the sculpture by.
#[must_use]
pub fn background<const N: usize>(scene: &Scene<'_, N>, ray: &Ray, dither: f32) -> Vec3 {
    let backdrop = backdrop(ray.direction);
    let Some(distance) = trace(ray) else {
        return backdrop;
    };
    let point = ray.at(distance);
    let normal = normal(point);
    let on_floor = point.y < FLOOR + 0.01;
    let reflectance = if on_floor { FLOOR_COLOR } else { STOOL_COLOR };
    let sun = sunlight(scene, point, normal, dither);
    let open = openness(scene, point, normal, dither);
    let color = reflectance * (Vec3::from_array(SUN_COLOR) * sun + light::ambient(normal) * open);
    if on_floor {
        // The floor bends up into the backdrop, without a horizon.
        let away = length(point.x, point.z);
        color.lerp(backdrop, smooth((away - 1.5) / 5.0))
    } else {
        color
    }
}

/// A soft pool of light on the wall behind the stool.
fn backdrop(direction: Vec3) -> Vec3 {
    let pool = Vec3::new(0.05, -0.08, -1.0).normalize().dot(direction);
    let light = smooth((pool - 0.90) / 0.1);
    Vec3::new(0.035, 0.038, 0.045).lerp(Vec3::new(0.17, 0.168, 0.165), light)
}

/// Distance along a ray to the floor or the stool. All of that lies under y = 0.
fn trace(ray: &Ray) -> Option<f32> {
    let falling = -ray.direction.y;
    let to_height = |y: f32| (ray.origin.y - y) / falling;
    if ray.origin.y > 0.0 && falling <= 0.0 {
        return None;
    }
    let mut distance = if ray.origin.y > 0.0 { to_height(0.0) } else { 0.0 };
    let floor = if falling > 0.0 { to_height(FLOOR) } else { f32::INFINITY };
    for _ in 0..64 {
        let gap = stool(ray.at(distance));
        if gap < 0.0008 {
            return Some(distance);
        }
        distance += gap;
        if distance > floor.min(FAR) {
            break;
        }
    }
    (floor < FAR).then_some(floor)
}

/// Distance to the stool and the floor.
fn field(point: Vec3) -> f32 {
    stool(point).min(point.y - FLOOR)
}

fn stool(point: Vec3) -> f32 {
    let top = disc(point + Vec3::Y * (0.5 * TOP_THICKNESS), TOP_RADIUS, 0.5 * TOP_THICKNESS, 0.02);
    let column = disc(point - Vec3::Y * (0.5 * FLOOR), COLUMN_RADIUS, -0.5 * FLOOR - 0.02, 0.01);
    top.min(column)
}

/// Distance to an upright cylinder with rounded rims, centred on the origin.
fn disc(point: Vec3, radius: f32, half_height: f32, rim: f32) -> f32 {
    let side = length(point.x, point.z) - radius + rim;
    let cap = point.y.abs() - half_height + rim;
    side.max(cap).min(0.0) + length(side.max(0.0), cap.max(0.0)) - rim
}

fn normal(point: Vec3) -> Vec3 {
    const STEP: f32 = 0.0015;
    let slope = |axis: Vec3| field(point + axis * STEP) - field(point - axis * STEP);
    Vec3::new(slope(Vec3::X), slope(Vec3::Y), slope(Vec3::Z)).normalize()
}

/// How much of the sun, a small disc here, a studio point sees past stool and sculpture, times the
/// cosine.
fn sunlight<const N: usize>(scene: &Scene<'_, N>, point: Vec3, normal: Vec3, dither: f32) -> f32 {
    let sun = Vec3::from_array(SUN_DIRECTION);
    let facing = normal.dot(sun);
    if facing <= 0.0 {
        return 0.0;
    }
    let (u, v) = light::across(sun);
    let start = point + normal * 0.004;
    let mut seen = 0;
    let (mut cos, mut sin) = ((dither * TAU).cos(), (dither * TAU).sin());
    for i in 0..SHADOW_RAYS {
        let radius = SUN_RADIUS * ((i as f32 + dither) / SHADOW_RAYS as f32).sqrt();
        let direction = (sun + (u * cos + v * sin) * radius).normalize();
        let ray = Ray { origin: start, direction };
        let hidden = march(scene.maps, &scene.ray_inside(&ray), false).is_some();
        seen += u32::from(!hidden);
        let [c, s] = GOLDEN_TURN;
        (cos, sin) = (cos * c - sin * s, sin * c + cos * s);
    }
    facing * stool_shadow(start, sun) * seen as f32 / SHADOW_RAYS as f32
}

/// Soft shadow of the stool by the closest approach of the way to the sun (Aaltonen and Quilez).
fn stool_shadow(start: Vec3, sun: Vec3) -> f32 {
    let (mut distance, mut seen) = (0.02, 1.0f32);
    for _ in 0..32 {
        let gap = stool(start + sun * distance);
        seen = seen.min(gap / (SUN_RADIUS * distance) * 0.5 + 0.5);
        if seen <= 0.0 {
            return 0.0;
        }
        distance += gap.max(0.02);
        if distance > 3.0 {
            break;
        }
    }
    smooth(seen)
}

/// How open a studio point is to the ambient light, past stool and sculpture.
fn openness<const N: usize>(scene: &Scene<'_, N>, point: Vec3, normal: Vec3, dither: f32) -> f32 {
    let mut open = 1.0;
    for i in 1..=4 {
        let reach = 0.09 * i as f32;
        open -= (reach - field(point + normal * reach)).max(0.0) / reach * 0.16;
    }
    let (u, v) = light::across(normal);
    let (mut cos, mut sin) = ((dither * TAU).cos(), (dither * TAU).sin());
    let (mut free, samples) = (0.0, 16);
    for i in 0..samples {
        let part = (i as f32 + dither) / samples as f32;
        let reach = 0.015 + 0.35 * part * part;
        let spread = reach * (0.3 + 1.2 * (i * 7 % samples) as f32 / samples as f32);
        let sample = point + normal * reach + (u * cos + v * sin) * spread;
        free += if occupied(scene.maps, scene.point_inside(sample)) { 0.0 } else { 1.0 };
        let [c, s] = GOLDEN_TURN;
        (cos, sin) = (cos * c - sin * s, sin * c + cos * s);
    }
    open.max(0.0) * free / samples as f32
}

/// The hardware's square root; glam's is a library's here, for the core's sake.
fn length(x: f32, y: f32) -> f32 {
    (x * x + y * y).sqrt()
}

fn smooth(t: f32) -> f32 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
