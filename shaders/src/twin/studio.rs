//! The studio around the sculpture: a round stool on a floor that runs into the backdrop.
//!
//! In the paper a game engine draws the surroundings; here they are a signed distance field, sphere traced.
//! The sculpture's shadow on them comes from marching the same range maps.

use core::f32::consts::TAU;

use glam::Vec3;

use super::fragment::TwinScene;
use super::light;
use super::march::{Ray, is_point_occupied, march_maps};
use crate::constants::{GOLDEN_ANGLE_COS_SIN, SUN_COLOR, SUN_DIRECTION};

const FLOOR: f32 = -1.1;
const TOP_RADIUS: f32 = 0.74;
const TOP_THICKNESS: f32 = 0.09;
const COLUMN_RADIUS: f32 = 0.5;
const STOOL_COLOR: Vec3 = Vec3::new(0.13, 0.105, 0.09);
const FLOOR_COLOR: Vec3 = Vec3::new(0.16, 0.155, 0.155);
const SUN_RADIUS: f32 = 0.09;
const SHADOW_RAYS: u32 = 4;
const FAR: f32 = 14.0;

/// Returns the linear radiance of the studio along a studio ray that misses the sculpture.
#[must_use]
pub fn shade_background<const N: usize, const K: usize>(
    scene: &TwinScene<'_, N, K>,
    studio_ray: &Ray,
    dither: f32,
) -> Vec3 {
    let ray = studio_ray;
    let backdrop = backdrop_radiance(ray.direction);
    let Some(distance) = distance_to_stool_or_floor(ray) else {
        return backdrop;
    };
    let point = ray.at(distance);
    let normal = studio_normal(point);
    let on_floor = point.y < FLOOR + 0.01;
    let reflectance = if on_floor { FLOOR_COLOR } else { STOOL_COLOR };
    let sun = sun_visibility_times_cosine(scene, point, normal, dither);
    let open = ambient_openness(scene, point, normal, dither);
    let color =
        reflectance * (Vec3::from_array(SUN_COLOR) * sun + light::ambient_over_pi(normal) * open);
    if on_floor {
        // The floor bends up into the backdrop, without a horizon.
        let away = length_2d(point.x, point.z);
        color.lerp(backdrop, smoothstep((away - 1.5) / 5.0))
    } else {
        color
    }
}

/// Returns the radiance of the backdrop: a soft spot of light on the wall behind the stool.
fn backdrop_radiance(direction: Vec3) -> Vec3 {
    let pool = Vec3::new(0.05, -0.08, -1.0).normalize().dot(direction);
    let light = smoothstep((pool - 0.90) / 0.1);
    Vec3::new(0.035, 0.038, 0.045).lerp(Vec3::new(0.17, 0.168, 0.165), light)
}

/// Sphere tracing: returns the distance along a ray to the floor or the stool, which lie below y = 0.
fn distance_to_stool_or_floor(studio_ray: &Ray) -> Option<f32> {
    let falling = -studio_ray.direction.y;
    let to_height = |y: f32| (studio_ray.origin.y - y) / falling;
    if studio_ray.origin.y > 0.0 && falling <= 0.0 {
        return None;
    }
    let mut distance = if studio_ray.origin.y > 0.0 { to_height(0.0) } else { 0.0 };
    let floor = if falling > 0.0 { to_height(FLOOR) } else { f32::INFINITY };
    for _ in 0..64 {
        let gap = stool_distance(studio_ray.at(distance));
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

/// Returns the signed distance to the stool and the floor.
fn studio_distance(point: Vec3) -> f32 {
    stool_distance(point).min(point.y - FLOOR)
}

fn stool_distance(point: Vec3) -> f32 {
    let top = cylinder_distance(
        point + Vec3::Y * (0.5 * TOP_THICKNESS),
        TOP_RADIUS,
        0.5 * TOP_THICKNESS,
        0.02,
    );
    let column = cylinder_distance(
        point - Vec3::Y * (0.5 * FLOOR),
        COLUMN_RADIUS,
        -0.5 * FLOOR - 0.02,
        0.01,
    );
    top.min(column)
}

/// Returns the signed distance to an upright cylinder with rounded rims, centred on the origin.
fn cylinder_distance(point: Vec3, radius: f32, half_height: f32, rim: f32) -> f32 {
    let side = length_2d(point.x, point.z) - radius + rim;
    let cap = point.y.abs() - half_height + rim;
    side.max(cap).min(0.0) + length_2d(side.max(0.0), cap.max(0.0)) - rim
}

fn studio_normal(point: Vec3) -> Vec3 {
    const STEP: f32 = 0.0015;
    let slope =
        |axis: Vec3| studio_distance(point + axis * STEP) - studio_distance(point - axis * STEP);
    Vec3::new(slope(Vec3::X), slope(Vec3::Y), slope(Vec3::Z)).normalize()
}

/// Area-light shadow: returns the part of the sun's disc that a studio point sees past stool and sculpture,
/// times the cosine of incidence.
fn sun_visibility_times_cosine<const N: usize, const K: usize>(
    scene: &TwinScene<'_, N, K>,
    point: Vec3,
    normal: Vec3,
    dither: f32,
) -> f32 {
    let sun = Vec3::from_array(SUN_DIRECTION);
    let facing = normal.dot(sun);
    if facing <= 0.0 {
        return 0.0;
    }
    let (u, v) = light::tangent_basis(sun);
    let start = point + normal * 0.004;
    let mut seen = 0;
    let (mut cos, mut sin) = ((dither * TAU).cos(), (dither * TAU).sin());
    for i in 0..SHADOW_RAYS {
        let radius = SUN_RADIUS * ((i as f32 + dither) / SHADOW_RAYS as f32).sqrt();
        let direction = (sun + (u * cos + v * sin) * radius).normalize();
        let ray = Ray { origin: start, direction };
        let hidden = march_maps(scene.maps, &scene.ray_to_grid(&ray)).is_some();
        seen += u32::from(!hidden);
        let [c, s] = GOLDEN_ANGLE_COS_SIN;
        (cos, sin) = (cos * c - sin * s, sin * c + cos * s);
    }
    facing * stool_sun_visibility(start, sun) * seen as f32 / SHADOW_RAYS as f32
}

/// Distance field soft shadow of the stool, by the shadow ray's closest approach (Aaltonen and Quilez).
/// Returns the visibility, 0 to 1.
fn stool_sun_visibility(start: Vec3, to_sun: Vec3) -> f32 {
    let (mut distance, mut seen) = (0.02, 1.0f32);
    for _ in 0..32 {
        let gap = stool_distance(start + to_sun * distance);
        seen = seen.min(gap / (SUN_RADIUS * distance) * 0.5 + 0.5);
        if seen <= 0.0 {
            return 0.0;
        }
        distance += gap.max(0.02);
        if distance > 3.0 {
            break;
        }
    }
    smoothstep(seen)
}

/// Ambient occlusion by stool and sculpture at a studio point: returns the part of the ambient light left.
fn ambient_openness<const N: usize, const K: usize>(
    scene: &TwinScene<'_, N, K>,
    point: Vec3,
    normal: Vec3,
    dither: f32,
) -> f32 {
    let mut open = 1.0;
    for i in 1..=4 {
        let reach = 0.09 * i as f32;
        open -= (reach - studio_distance(point + normal * reach)).max(0.0) / reach * 0.16;
    }
    let (u, v) = light::tangent_basis(normal);
    let (mut cos, mut sin) = ((dither * TAU).cos(), (dither * TAU).sin());
    let (mut free, samples) = (0.0, 16);
    for i in 0..samples {
        let part = (i as f32 + dither) / samples as f32;
        let reach = 0.015 + 0.35 * part * part;
        let spread = reach * (0.3 + 1.2 * (i * 7 % samples) as f32 / samples as f32);
        let sample = point + normal * reach + (u * cos + v * sin) * spread;
        free += if is_point_occupied(scene.maps, scene.point_to_grid(sample)) { 0.0 } else { 1.0 };
        let [c, s] = GOLDEN_ANGLE_COS_SIN;
        (cos, sin) = (cos * c - sin * s, sin * c + cos * s);
    }
    open.max(0.0) * free / samples as f32
}

/// Returns the length of (x, y), by the hardware's square root; glam uses libm's here, as the core needs
/// it.
fn length_2d(x: f32, y: f32) -> f32 {
    (x * x + y * y).sqrt()
}

fn smoothstep(t: f32) -> f32 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
