//! A shell's request for a frame: eyes, the sculpture's placement, light, render path and scene.

use glam::{Mat4, Quat, Vec3, Vec4};

use crate::constants::{AMBIENT_HARMONICS, SUN_COLOR, SUN_DIRECTION};
use crate::gpu::pipelines::paths::{Drawn, RenderPath};
use crate::panel::Panel;
use crate::scene::SculpturePlacement;
use crate::scene::{DrawList, ROOM_AMBIENT};

/// Distance of the near plane, in metres.
pub(crate) const NEAR: f32 = 0.04;
/// Distance of the far plane, in metres.
pub(crate) const FAR: f32 = 60.0;

/// Field of view, as OpenXR's `XrFovf`: angles from the eye's axis to the sides of its picture, in
/// radians, positive to the right and up.
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

/// The tangents of a [`Fov`]'s angles, positive to the right and up.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct FovTangents {
    pub(crate) left: f32,
    pub(crate) right: f32,
    pub(crate) up: f32,
    pub(crate) down: f32,
}

/// An eye in the room, looking along its own -z.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Eye {
    /// The eye's position, in metres.
    pub position: Vec3,
    /// The eye's orientation.
    pub rotation: Quat,
    /// The eye's field of view.
    pub fov: Fov,
}

/// Draw order of the sculpture among the opaque parts of the scene. The picture stays the same; only the
/// overdraw differs.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum SculptureOrder {
    /// After tools and hands, before stool, bench and room.
    #[default]
    Between,
    /// Before all.
    First,
    /// After all.
    Last,
}

/// Render path and lighting.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct RenderStyle {
    /// The sculpture's render path.
    pub path: RenderPath,
    /// The output of the render path.
    pub drawn: Drawn,
    /// Unit vector towards the sun, in the room.
    pub sun_direction: Vec3,
    /// The sun's irradiance at normal incidence, over pi.
    pub sun_color: Vec3,
    /// Ambient radiance as spherical harmonics, as `constants::AMBIENT_HARMONICS`.
    pub ambient: [[f32; 3]; 9],
}

impl Default for RenderStyle {
    fn default() -> Self {
        RenderStyle {
            path: RenderPath::default(),
            drawn: Drawn::Picture,
            sun_direction: Vec3::from_array(SUN_DIRECTION),
            sun_color: Vec3::from_array(SUN_COLOR),
            ambient: AMBIENT_HARMONICS,
        }
    }
}

impl RenderStyle {
    /// Returns the studio's light with a render path: the sun dimmed and the ambient light raised, so that
    /// sunlit white stone keeps its shading and the room is not gloomy.
    #[must_use]
    pub fn in_studio(path: RenderPath) -> Self {
        const SUN: f32 = 0.74;
        const ROOM: f32 = 1.2;
        let sun_color = Vec3::from_array(SUN_COLOR) * SUN;
        let ambient = ROOM_AMBIENT.map(|color| color.map(|part| part * ROOM));
        RenderStyle { path, sun_color, ambient, ..RenderStyle::default() }
    }

    /// Returns this light, blended by `part`, 0 to 1, into that of a find: a warmer, stronger sun in a
    /// dimmer room.
    #[must_use]
    pub fn lighting_a_find(self, part: f32) -> Self {
        const SUN: Vec3 = Vec3::new(1.25, 1.06, 0.78);
        const ROOM: Vec3 = Vec3::new(0.66, 0.56, 0.50);
        let sun_color = self.sun_color * Vec3::ONE.lerp(SUN, part);
        let room = Vec3::ONE.lerp(ROOM, part);
        let ambient = self.ambient.map(|color| (Vec3::from_array(color) * room).to_array());
        RenderStyle { sun_color, ambient, ..self }
    }
}

/// The contents of a frame.
#[derive(Clone, Copy, Debug)]
pub struct FrameRequest<'a> {
    /// One eye, or the left and the right one: as many as the format has views.
    pub eyes: &'a [Eye],
    /// The sculpture's placement.
    pub placement: SculpturePlacement,
    /// Render path and lighting.
    pub style: RenderStyle,
    /// The room and its contents; `None` draws the sculpture alone, without shadows from or on anything
    /// else.
    pub scene: Option<&'a DrawList>,
    /// Panels in the room, each drawn over those before it.
    pub panels: &'a [&'a [Panel]],
    /// Linear colour of the background, where nothing is drawn.
    pub backdrop: [f32; 3],
}

impl FrameRequest<'_> {
    /// Returns `true` if the sculpture is drawn. From far beyond the far plane it isn't: a step along a ray
    /// would be below float precision, and the march would not end.
    pub(crate) fn shows_sculpture(&self) -> bool {
        let near = |eye: &Eye| eye.position.distance(self.placement.foot) < 10.0 * FAR;
        self.eyes.iter().all(near)
    }
}

impl SculpturePlacement {
    /// Returns the transform from the grid (voxels, `grid_side` a side) to the room (metres).
    #[must_use]
    pub fn room_from_grid(&self, grid_side: usize) -> Mat4 {
        let half = 0.5 * grid_side as f32;
        Mat4::from_translation(self.foot)
            * Mat4::from_rotation_y(self.turn_radians)
            * Mat4::from_scale(Vec3::splat(self.side / grid_side as f32))
            * Mat4::from_translation(Vec3::new(-half, 0.0, -half))
    }
}

impl Eye {
    /// Distances of the near and the far plane, in metres.
    pub const PLANES: [f32; 2] = [NEAR, FAR];

    /// Returns the view-projection matrix from the room to Vulkan's clip space; reversed depth, 1 on the
    /// near plane and 0 on the far one.
    #[must_use]
    pub fn clip_from_room(&self) -> Mat4 {
        let FovTangents { left: l, right: r, up: u, down: d } = self.fov_tangents();
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

    /// Returns the tangents of the angles to the sides of the eye's picture.
    pub(crate) fn fov_tangents(&self) -> FovTangents {
        let Fov { left, right, up, down } = self.fov;
        let [left, right, up, down] = [left, right, up, down].map(f32::tan);
        FovTangents { left, right, up, down }
    }
}
