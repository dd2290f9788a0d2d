//! The uniforms of a frame, computed from its request.

use glam::{Mat3, Mat4, Vec3};

use super::request::{FAR, FovTangents, FrameRequest, NEAR};
use crate::constants::TILE_PIXELS;
use crate::field::{PAD, cell_side_texels};
use crate::gpu::passes::shadow_map;
use crate::gpu::pipelines::layout;
use crate::twin::fast;
use crate::twin::harmonics::{BASIS_FACTORS, COSINE_FACTORS};

/// Returns the uniforms of a request, for `grid_side` voxels a side and a picture of this many pixels.
pub(crate) fn frame_uniforms(
    request: &FrameRequest<'_>,
    grid_side: usize,
    [width, height]: [u32; 2],
) -> layout::FrameUniforms {
    let room_from_grid = request.placement.room_from_grid(grid_side);
    let grid_from_room = room_from_grid.inverse();
    let voxel = request.placement.side / grid_side as f32;
    let style = &request.style;
    let shadow_from_room = match request.scene {
        Some(_) => shadow_map::shadow_from_room(style.sun_direction),
        None => Mat4::ZERO,
    };
    let sun_in_grid = grid_from_room.transform_vector3(style.sun_direction).normalize();
    let mut views = [layout::ViewUniforms::default(); 2];
    for (view, eye) in views.iter_mut().zip(request.eyes) {
        let FovTangents { left: l, right: r, up: u, down: d } = eye.fov_tangents();
        // A direction whose part along the eye's axis is a voxel's length.
        let turned = |v: Vec3| grid_from_room.transform_vector3(eye.rotation * v * voxel);
        *view = layout::ViewUniforms {
            clip_from_room: eye.clip_from_room().to_cols_array_2d(),
            eye: grid_from_room.transform_point3(eye.position).into(),
            ray_base: turned(Vec3::new(l, u, -1.0)).into(),
            ray_x: turned(Vec3::X * ((r - l) / width as f32)).into(),
            ray_y: turned(Vec3::Y * ((d - u) / height as f32)).into(),
        };
    }
    let eye = request
        .eyes
        .first()
        .map_or(Vec3::ZERO, |eye| grid_from_room.transform_point3(eye.position));
    let pixel_width = Vec3::from_array(views[0].ray_x.xyz).length();
    let tiles = [width, height].map(|pixels| pixels.div_ceil(TILE_PIXELS));
    layout::FrameUniforms {
        views,
        shadow_from_grid: (shadow_from_room * room_from_grid).to_cols_array_2d(),
        shadow_from_room: shadow_from_room.to_cols_array_2d(),
        room_from_grid: room_from_grid.to_cols_array_2d(),
        sun_in_grid: sun_in_grid.to_array(),
        grid_side: grid_side as f32,
        sun_in_room: style.sun_direction.to_array(),
        density_side: (grid_side + 2 * PAD) as f32,
        sun_color: style.sun_color.to_array(),
        pixel_width,
        ambient: ambient_polynomial(
            &style.ambient,
            Mat3::from_rotation_y(request.placement.turn_radians),
        ),
        depth_scale: NEAR * FAR / (FAR - NEAR) / voxel,
        depth_offset: -NEAR / (FAR - NEAR),
        near: NEAR / voxel,
        voxel_size: voxel,
        pixels: [width as f32, height as f32],
        tiles: tiles.map(|tiles| tiles as f32),
        cell_reach: 255.0 * cell_side_texels(grid_side) as f32,
        shadow_depth_per_metre: shadow_map::shadow_depth_per_metre(),
        shadow_texel: 1.0 / shadow_map::MAP_SIDE as f32,
        padding: 0.0,
        halfway_in_grid: fast::halfway_to_eye(sun_in_grid, eye, grid_side).into(),
    }
}

/// Returns the spherical-harmonics irradiance (bands 0 to 2) as a polynomial of the grid's normal: the
/// coefficients of 1, x, y, z, xy, yz, xz, xx and yy.
fn ambient_polynomial(
    radiance_sh: &[[f32; 3]; 9],
    room_from_grid: Mat3,
) -> [layout::PaddedVec3; 9] {
    let mut polynomial = [layout::PaddedVec3::default(); 9];
    #[expect(clippy::needless_range_loop, reason = "a channel of three arrays")]
    for channel in 0..3 {
        let c: [f32; 9] = core::array::from_fn(|i| {
            radiance_sh[i][channel] * BASIS_FACTORS[i] * COSINE_FACTORS[i]
        });
        let linear = room_from_grid.transpose() * Vec3::new(c[3], c[1], c[2]);
        let square = Mat3::from_cols(
            Vec3::new(c[8] - c[6], 0.5 * c[4], 0.5 * c[7]),
            Vec3::new(0.5 * c[4], -c[8] - c[6], 0.5 * c[5]),
            Vec3::new(0.5 * c[7], 0.5 * c[5], 2.0 * c[6]),
        );
        let square = room_from_grid.transpose() * square * room_from_grid;
        // A normal has length 1, so that zz is 1 - xx - yy.
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
            to.xyz[channel] = factor;
        }
    }
    polynomial
}
