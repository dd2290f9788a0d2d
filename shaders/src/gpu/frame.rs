//! What a shell asks of a frame: eyes, the sculpture's place, the light, and how to march.

use glam::{Mat3, Mat4, Quat, Vec3, Vec4};

use super::layout;
use super::shadow;
use crate::constants::{AMBIENT, SUN_COLOR, SUN_DIRECTION};
use crate::field::cell;
use crate::harmonics::{BANDS, FACTORS};
use crate::scene::{DrawList, ROOM_AMBIENT};

/// Distance of the near plane, in metres.
const NEAR: f32 = 0.04;
/// Distance of the far plane, in metres.
const FAR: f32 = 60.0;

/// Pixels along a side of the tiles that share the first part of their rays; `wgsl/layout.wgsl`'s.
pub(super) const TILE: u32 = 32;
/// Pixels along a side of the beams within them, likewise.
pub(super) const BEAM: u32 = 8;

/// The angles from an eye's axis to the sides of its picture, in radians, positive to the right
/// and up; OpenXR's `XrFovf`.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Fov {
    /// To the left side; mostly negative.
    pub left: f32,
    /// To the right side.
    pub right: f32,
    /// To the upper side.
    pub up: f32,
    /// To the lower side; mostly negative.
    pub down: f32,
}

/// An eye in the room, looking along its own -z.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Eye {
    /// Where it is, in metres.
    pub position: Vec3,
    /// How it is turned.
    pub rotation: Quat,
    /// What it sees.
    pub fov: Fov,
}

/// Which of the two ways the sculpture is drawn by.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum Path {
    /// Section 4 of the paper, with the parts of it that are on.
    Paper(Parts),
    /// The smooth surface of the blurred volume.
    #[default]
    Fast,
}

/// The paper's path whole, or one of its section 5's experiments.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum Parts {
    /// All of it.
    #[default]
    Whole,
    /// All three maps looked at on every step.
    FullMarch,
    /// The voxel's face instead of the blobs.
    NoSdf,
    /// The normal as a colour.
    NoShading,
}

/// How the sculpture is drawn and lit.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Look {
    /// The way.
    pub path: Path,
    /// Unit vector towards the sun, in the room.
    pub sun_direction: Vec3,
    /// Irradiance of what faces the sun, over pi.
    pub sun_color: Vec3,
    /// Radiance from everywhere else, as `constants::AMBIENT`.
    pub ambient: [[f32; 3]; 9],
}

impl Default for Look {
    fn default() -> Self {
        Look {
            path: Path::default(),
            sun_direction: Vec3::from_array(SUN_DIRECTION),
            sun_color: Vec3::from_array(SUN_COLOR),
            ambient: AMBIENT,
        }
    }
}

impl Look {
    /// The studio's light, for a way of drawing: the sun a little held back and the rest brought up,
    /// so that white stone in the sun keeps its shapes and the room is not gloomy.
    #[must_use]
    pub fn studio(path: Path) -> Self {
        const SUN: f32 = 0.74;
        const ROOM: f32 = 1.2;
        let sun_color = Vec3::from_array(SUN_COLOR) * SUN;
        let ambient = ROOM_AMBIENT.map(|color| color.map(|part| part * ROOM));
        Look { path, sun_color, ambient, ..Look::default() }
    }
}

/// Where the sculpture's cube stands.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Stand {
    /// The middle of its base, in metres in the room.
    pub foot: Vec3,
    /// Its side, in metres.
    pub side: f32,
    /// How far the stool has turned, in radians, counter-clockwise from above.
    pub turn: f32,
}

/// A frame.
#[derive(Clone, Copy, Debug)]
pub struct Picture<'a> {
    /// One eye, or the left and the right one: as many as the format has views.
    pub eyes: &'a [Eye],
    /// The sculpture's place.
    pub stand: Stand,
    /// How it is drawn.
    pub look: Look,
    /// The room and what is in it, lit by the look's light; without it the sculpture stands alone,
    /// and no shadow falls from or on anything else.
    pub scene: Option<&'a DrawList>,
    /// Linear colour of what nothing covers.
    pub backdrop: [f32; 3],
}

impl Picture<'_> {
    /// Whether the sculpture can be seen at all. From far beyond the far plane a step along a ray
    /// would be less than its last digit, and a march never end.
    pub(super) fn shows_sculpture(&self) -> bool {
        let near = |eye: &Eye| eye.position.distance(self.stand.foot) < 10.0 * FAR;
        self.eyes.iter().all(near)
    }
}

impl Stand {
    /// The room's point of a point in voxels, as a matrix, for N voxels a side.
    #[must_use]
    pub fn room_from_grid(&self, n: usize) -> Mat4 {
        let half = 0.5 * n as f32;
        Mat4::from_translation(self.foot)
            * Mat4::from_rotation_y(self.turn)
            * Mat4::from_scale(Vec3::splat(self.side / n as f32))
            * Mat4::from_translation(Vec3::new(-half, 0.0, -half))
    }
}

impl Eye {
    /// Distances of the near and the far plane, in metres.
    pub const PLANES: [f32; 2] = [NEAR, FAR];

    /// Clip space from the room, with depth 1 on the near plane and 0 on the far one.
    #[must_use]
    pub fn clip_from_room(&self) -> Mat4 {
        let [l, r, u, d] = self.tangents();
        let (width, height) = (r - l, u - d);
        // Vulkan's y points down.
        let projection = Mat4::from_cols(
            Vec4::new(2.0 / width, 0.0, 0.0, 0.0),
            Vec4::new(0.0, -2.0 / height, 0.0, 0.0),
            Vec4::new((r + l) / width, -(u + d) / height, NEAR / (FAR - NEAR), -1.0),
            Vec4::new(0.0, 0.0, NEAR * FAR / (FAR - NEAR), 0.0),
        );
        projection * Mat4::from_rotation_translation(self.rotation, self.position).inverse()
    }

    fn tangents(&self) -> [f32; 4] {
        [self.fov.left, self.fov.right, self.fov.up, self.fov.down].map(f32::tan)
    }
}

/// The frame as the programs read it, for pixels across and down and a density texture's side.
pub(super) fn layout(picture: &Picture<'_>, n: usize, [w, h]: [u32; 2]) -> layout::Frame {
    let room_from_grid = picture.stand.room_from_grid(n);
    let grid_from_room = room_from_grid.inverse();
    let voxel = picture.stand.side / n as f32;
    let look = &picture.look;
    let shadow_from_room = match picture.scene {
        Some(_) => shadow::shadow_from_room(look.sun_direction),
        None => Mat4::ZERO,
    };
    let sun_grid = grid_from_room.transform_vector3(look.sun_direction).normalize();
    let mut views = [layout::View::default(); 2];
    for (view, eye) in views.iter_mut().zip(picture.eyes) {
        let [l, r, u, d] = eye.tangents();
        // A direction whose part along the eye's axis is a voxel's length.
        let turned = |v: Vec3| grid_from_room.transform_vector3(eye.rotation * v * voxel);
        *view = layout::View {
            clip_from_room: eye.clip_from_room().to_cols_array_2d(),
            eye: grid_from_room.transform_point3(eye.position).extend(0.0).to_array(),
            ray_base: turned(Vec3::new(l, u, -1.0)).extend(0.0).to_array(),
            ray_x: turned(Vec3::X * ((r - l) / w as f32)).extend(0.0).to_array(),
            ray_y: turned(Vec3::Y * ((d - u) / h as f32)).extend(0.0).to_array(),
        };
    }
    let pixel = Vec4::from_array(views[0].ray_x).truncate().length();
    let tiles = [w, h].map(|pixels| pixels.div_ceil(TILE));
    layout::Frame {
        views,
        shadow_from_grid: (shadow_from_room * room_from_grid).to_cols_array_2d(),
        shadow_from_room: shadow_from_room.to_cols_array_2d(),
        room_from_grid: room_from_grid.to_cols_array_2d(),
        sun_grid: sun_grid.extend(n as f32).to_array(),
        sun_room: look.sun_direction.extend((n + 8) as f32).to_array(),
        sun_color: look.sun_color.extend(pixel).to_array(),
        ambient: harmonics(&look.ambient, Mat3::from_rotation_y(picture.stand.turn)),
        depth: [NEAR * FAR / (FAR - NEAR) / voxel, -NEAR / (FAR - NEAR), NEAR / voxel, voxel],
        extent: [w as f32, h as f32, tiles[0] as f32, tiles[1] as f32],
        cells: [255.0 * cell(n) as f32, 0.0, 0.0, 0.0],
        sun_map: [shadow::depth_per_metre(), 1.0 / shadow::SIDE as f32, 0.0, 0.0],
    }
}

/// The ambient light as a polynomial of a normal of the grid: the constant, then the factors of x,
/// y, z, xy, yz, xz, xx and yy.
fn harmonics(ambient: &[[f32; 3]; 9], room_from_grid: Mat3) -> [[f32; 4]; 9] {
    let mut polynomial = [[0.0; 4]; 9];
    for channel in 0..3 {
        let c: [f32; 9] = core::array::from_fn(|i| ambient[i][channel] * FACTORS[i] * BANDS[i]);
        let linear = room_from_grid.transpose() * Vec3::new(c[3], c[1], c[2]);
        let square = Mat3::from_cols(
            Vec3::new(c[8] - c[6], 0.5 * c[4], 0.5 * c[7]),
            Vec3::new(0.5 * c[4], -c[8] - c[6], 0.5 * c[5]),
            Vec3::new(0.5 * c[7], 0.5 * c[5], 2.0 * c[6]),
        );
        let square = room_from_grid.transpose() * square * room_from_grid;
        // A normal has length 1, which saves zz.
        let zz = square.z_axis.z;
        let factors = [
            c[0] + zz,
            linear.x,
            linear.y,
            linear.z,
            2.0 * square.x_axis.y,
            2.0 * square.y_axis.z,
            2.0 * square.x_axis.z,
            square.x_axis.x - zz,
            square.y_axis.y - zz,
        ];
        for (to, factor) in polynomial.iter_mut().zip(factors) {
            to[channel] = factor;
        }
    }
    polynomial
}
