//! The scene drawn the plain way, triangle by triangle into a depth buffer, for eyes and tests.

use glam::{Mat3, Vec3};
use paros_core::plane::Plane;
use paros_core::size::{Grid, Size};
use paros_shaders::Image;
use paros_shaders::harmonics::basis;
use paros_shaders::scene::{
    DrawList, ROOM_AMBIENT, SKY, SUN_BOUNDS, SUN_COLOR, SUN_DIRECTION, SculpturePose, Stage,
};

/// A corner in the room: place, normal, reflectance, openness, and how much shines by itself.
#[derive(Clone, Copy, Debug)]
struct Corner {
    position: Vec3,
    normal: Vec3,
    colour: Vec3,
    open: f32,
    glow: f32,
}

/// Where the picture is taken from.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// In metres.
    pub eye: Vec3,
    /// The point looked at.
    pub at: Vec3,
    /// Vertical angle of view in radians.
    pub angle: f32,
    /// Pixels.
    pub size: [usize; 2],
}

/// Triangles and the depths that the sun sees.
#[derive(Debug, Default)]
pub struct Preview {
    corners: Vec<[Corner; 3]>,
    casters: usize,
    shadow: Vec<f32>,
}

const SHADOW: usize = 3072;

impl Preview {
    /// All instances of a list.
    pub fn new(list: &DrawList) -> Self {
        let mut preview = Preview::default();
        for shadow in [true, false] {
            for batch in list.batches().iter().filter(|b| b.mesh.casts_shadow() == shadow) {
                for instance in list.of(batch.mesh) {
                    let column = |k: usize| {
                        Vec3::new(
                            instance.transform[k],
                            instance.transform[4 + k],
                            instance.transform[8 + k],
                        )
                    };
                    let normals =
                        Mat3::from_cols(column(0), column(1), column(2)).inverse().transpose();
                    let particle = batch.mesh.stage() == Stage::Particles;
                    let glow = if particle { 0.0 } else { instance.tint[3] };
                    let tint = Vec3::new(instance.tint[0], instance.tint[1], instance.tint[2]);
                    let corner = |i: u16| {
                        let v = &batch.mesh.vertices()[usize::from(i)];
                        let [x, y, z, _] = v.normal.map(|n| f32::from(n) / 127.0);
                        let [r, g, b, a] = v.colour.map(|c| f32::from(c) / 255.0);
                        Corner {
                            position: instance.place(Vec3::from_array(v.position)),
                            normal: (normals * Vec3::new(x, y, z)).normalize(),
                            colour: Vec3::new(r, g, b) * tint,
                            open: a,
                            glow,
                        }
                    };
                    preview.corners.extend(
                        batch
                            .mesh
                            .indices()
                            .chunks_exact(3)
                            .map(|t| [t[0], t[1], t[2]].map(corner)),
                    );
                }
            }
            if shadow {
                preview.casters = preview.corners.len();
            }
        }
        preview
    }

    /// The sculpture as the outer faces of its voxels, with the normals of its blurred density.
    pub fn add_sculpture<const N: usize>(&mut self, volume: &Plane<N>, pose: &SculpturePose)
    where
        Grid<N>: Size,
    {
        let full = |p: [i32; 3]| {
            p.iter().all(|i| (0..N as i32).contains(i)) && volume.contains(p.map(|i| i as usize))
        };
        let turn = glam::Quat::from_rotation_y(pose.turn);
        let scale = pose.side / N as f32;
        let mut faces = Vec::new();
        for i in 0..(N * N * N) as i32 {
            let n = N as i32;
            let p = [i % n, i / n % n, i / n / n];
            if !full(p) {
                continue;
            }
            for side in 0..6 {
                let (axis, sign) = (side / 2, 2 * (side as i32 % 2) - 1);
                let mut next = p;
                next[axis] += sign;
                if full(next) {
                    continue;
                }
                let mut gradient = Vec3::ZERO;
                for j in 0..125 {
                    let d = [j % 5 - 2, j / 5 % 5 - 2, j / 25 - 2];
                    if !full([p[0] + d[0], p[1] + d[1], p[2] + d[2]]) {
                        gradient += Vec3::from_array(d.map(|c| c as f32));
                    }
                }
                let normal = turn * gradient.normalize_or(Vec3::AXES[axis] * sign as f32);
                let corner = |a: i32, b: i32| {
                    let mut c = p.map(|i| i as f32 + 0.5);
                    c[axis] += 0.5 * sign as f32;
                    c[(axis + 1) % 3] += 0.5 * a as f32;
                    c[(axis + 2) % 3] += 0.5 * (b * sign) as f32;
                    let half = 0.5 * N as f32;
                    let at = (Vec3::from_array(c) - Vec3::new(half, 0.0, half)) * scale;
                    Corner {
                        position: turn * at + pose.foot,
                        normal,
                        colour: Vec3::new(0.84, 0.825, 0.8),
                        open: 0.95,
                        glow: 0.0,
                    }
                };
                let [a, b, c, d] = [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)];
                faces.extend([[a, b, c], [a, c, d]]);
            }
        }
        let casters = self.casters;
        self.casters += faces.len();
        self.corners.splice(casters..casters, faces);
    }

    /// The picture.
    pub fn draw(&mut self, view: &View) -> Image {
        self.cast();
        let [width, height] = view.size;
        let forward = (view.at - view.eye).normalize();
        let right = forward.cross(Vec3::Y).normalize();
        let up = right.cross(forward);
        let scale = 1.0 / (0.5 * view.angle).tan();
        let mut depth = vec![f32::MAX; width * height];
        let mut pixels = vec![Vec3::from_array(SKY); width * height];
        for triangle in &self.corners {
            let seen = triangle.map(|c| {
                let p = c.position - view.eye;
                Vec3::new(p.dot(right), p.dot(up), p.dot(forward))
            });
            for [a, b, c] in clipped(seen) {
                let screen = [a, b, c].map(|p: Vec3| {
                    let s = 0.5 * height as f32 * scale / p.z;
                    Vec3::new(
                        0.5 * width as f32 + p.x * s,
                        0.5 * height as f32 - p.y * s,
                        1.0 / p.z,
                    )
                });
                raster(screen, [width, height], |i, inverse| {
                    let z = 1.0 / inverse;
                    if z >= depth[i] {
                        return;
                    }
                    depth[i] = z;
                    let (x, y) = ((i % width) as f32 + 0.5, (i / width) as f32 + 0.5);
                    let s = z / (0.5 * height as f32 * scale);
                    let point = view.eye + forward * z + right * ((x - 0.5 * width as f32) * s)
                        - up * ((y - 0.5 * height as f32) * s);
                    pixels[i] = self.shade(triangle, point);
                });
            }
        }
        let mut image = Image::filled(width, height, [0; 3]);
        for (to, colour) in image.pixels.chunks_exact_mut(3).zip(&pixels) {
            for (k, to) in to.iter_mut().enumerate() {
                let c = colour[k];
                let mapped = (c * (1.0 + 0.25 * c) / (1.0 + c)).clamp(0.0, 1.0);
                *to = (mapped.powf(1.0 / 2.2) * 255.0).round() as u8;
            }
        }
        image
    }

    fn shade(&self, triangle: &[Corner; 3], point: Vec3) -> Vec3 {
        let [a, b, c] = triangle.map(|c| c.position);
        let across = (b - a).cross(c - a);
        let area = across.length_squared();
        let u = ((c - b).cross(point - b).dot(across) / area).clamp(0.0, 1.0);
        let v = ((a - c).cross(point - c).dot(across) / area).clamp(0.0, 1.0);
        let weights = [u, v, 1.0 - u - v];
        let mix = |of: fn(&Corner) -> Vec3| {
            triangle.iter().zip(weights).map(|(c, w)| of(c) * w).sum::<Vec3>()
        };
        let normal = mix(|c| c.normal).normalize();
        let (colour, open) = (mix(|c| c.colour), mix(|c| Vec3::splat(c.open)).x);
        let bands = [1.0, 2.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0, 0.25, 0.25, 0.25, 0.25, 0.25];
        let ambient: Vec3 = basis(normal)
            .iter()
            .zip(bands)
            .zip(ROOM_AMBIENT)
            .map(|((h, b), c)| Vec3::from_array(c) * (h * b))
            .sum();
        let sun = normal.dot(Vec3::from_array(SUN_DIRECTION)).max(0.0);
        let lit = if sun > 0.0 { sun * self.sunlit(point + normal * 0.006) } else { 0.0 };
        colour
            * (Vec3::from_array(SUN_COLOR) * lit
                + ambient.max(Vec3::ZERO) * open
                + Vec3::splat(triangle[0].glow))
    }

    /// Draws the depths that the sun sees.
    fn cast(&mut self) {
        let mut shadow = vec![f32::MIN; SHADOW * SHADOW];
        for triangle in &self.corners[..self.casters] {
            let seen = triangle.map(|c| from_sun(c.position));
            raster(seen, [SHADOW, SHADOW], |i, height| shadow[i] = shadow[i].max(height));
        }
        self.shadow = shadow;
    }

    fn sunlit(&self, point: Vec3) -> f32 {
        let p = from_sun(point);
        let mut lit = 0.0;
        for j in -2..=2 {
            for i in -2..=2 {
                let (x, y) = (p.x + i as f32, p.y + j as f32);
                let inside = (0.0..SHADOW as f32).contains(&x) && (0.0..SHADOW as f32).contains(&y);
                let seen = !inside || self.shadow[y as usize * SHADOW + x as usize] < p.z + 0.008;
                lit += if seen { 0.04 } else { 0.0 };
            }
        }
        lit
    }
}

/// Texels across and height towards the sun.
fn from_sun(point: Vec3) -> Vec3 {
    let (middle, radius) = SUN_BOUNDS;
    let p = point - Vec3::from_array(middle);
    let sun = Vec3::from_array(SUN_DIRECTION);
    let u = sun.cross(Vec3::Y).normalize();
    let v = sun.cross(u);
    let scale = 0.5 * SHADOW as f32;
    Vec3::new(p.dot(u) / radius * scale + scale, p.dot(v) / radius * scale + scale, p.dot(sun))
}

/// The parts of a triangle before the eye.
fn clipped(triangle: [Vec3; 3]) -> Vec<[Vec3; 3]> {
    const NEAR: f32 = 0.05;
    let mut ring = Vec::new();
    for i in 0..3 {
        let (a, b) = (triangle[i], triangle[(i + 1) % 3]);
        if a.z >= NEAR {
            ring.push(a);
        }
        if (a.z < NEAR) != (b.z < NEAR) {
            ring.push(a.lerp(b, (NEAR - a.z) / (b.z - a.z)));
        }
    }
    (2..ring.len()).map(|i| [ring[0], ring[i - 1], ring[i]]).collect()
}

/// Hands each pixel of a triangle, either way round, and what its third parts come to there.
fn raster([a, b, c]: [Vec3; 3], [width, height]: [usize; 2], mut each: impl FnMut(usize, f32)) {
    let area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    if area.abs() < 1e-12 {
        return;
    }
    let range = |p: f32, q: f32, r: f32, n: usize| {
        let lo = p.min(q).min(r).floor().clamp(0.0, n as f32) as usize;
        let hi = p.max(q).max(r).ceil().clamp(0.0, n as f32) as usize;
        lo..hi
    };
    for y in range(a.y, b.y, c.y, height) {
        for x in range(a.x, b.x, c.x, width) {
            let (px, py) = (x as f32 + 0.5, y as f32 + 0.5);
            let edge =
                |p: Vec3, q: Vec3| ((q.x - p.x) * (py - p.y) - (q.y - p.y) * (px - p.x)) / area;
            let (u, v, w) = (edge(b, c), edge(c, a), edge(a, b));
            if u >= 0.0 && v >= 0.0 && w >= 0.0 {
                each(y * width + x, u * a.z + v * b.z + w * c.z);
            }
        }
    }
}
