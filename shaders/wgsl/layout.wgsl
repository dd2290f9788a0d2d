// The uniform buffer of every drawing program. `src/gpu/pipelines/layout.rs` mirrors the
// structures; the build checks the sizes and every field's offset against each other.
#define_import_path paros::layout
#import paros::constants::BINDING_FRAME

// An eye. The ray of pixel (x, y) is `eye + t * (ray_base + x * ray_x + y * ray_y)`, in voxels of
// the grid; its parameter t is the depth in front of the eye, also in voxels.
struct ViewUniforms {
    clip_from_room: mat4x4<f32>,
    eye: vec3<f32>,
    ray_base: vec3<f32>,
    ray_x: vec3<f32>,
    ray_y: vec3<f32>,
}

// The sculpture and the light, the same for both eyes.
struct FrameUniforms {
    views: array<ViewUniforms, 2>,
    // To the shadow map's clip space, with depth 0 next to the sun. All zeros if there is no map:
    // then everything is lit.
    shadow_from_grid: mat4x4<f32>,
    shadow_from_room: mat4x4<f32>,
    // Columns: the grid's axes and origin in the room, in metres; an axis is as long as a voxel.
    room_from_grid: mat4x4<f32>,
    // Unit vector towards the sun, in the grid.
    sun_in_grid: vec3<f32>,
    // Voxels along a side of the grid.
    grid_side: f32,
    // Unit vector towards the sun, in the room.
    sun_in_room: vec3<f32>,
    // Texels along a side of the density texture.
    density_side: f32,
    // Irradiance from the sun at normal incidence, over pi.
    sun_color: vec3<f32>,
    // Width of a pixel at a depth of one voxel, in voxels.
    pixel_width: f32,
    // Ambient irradiance over pi as a polynomial of the grid's normal: the coefficients of 1, x, y,
    // z, xy, yz, xz, xx and yy.
    ambient: array<vec3<f32>, 9>,
    // The depth buffer holds `depth_scale / t + depth_offset`.
    depth_scale: f32,
    depth_offset: f32,
    // Depth of the near plane, in voxels.
    near: f32,
    // A voxel's side, in metres.
    voxel_size: f32,
    // Width and height of the picture, in pixels.
    pixels: vec2<f32>,
    // Screen tiles along its width and height.
    tiles: vec2<f32>,
    // Density texels for a cell's normalised distance of 1, a byte of 255.
    cell_reach: f32,
    // The shadow map's depth per metre, and a texel's width as a part of its side.
    shadow_depth_per_metre: f32,
    shadow_texel: f32,
    // Unit vector halfway between the direction to the sun and the direction from the grid's middle to the
    // first eye. It is the same all over the sculpture and for both eyes, since sparkle that differs
    // between them would hurt.
    halfway_in_grid: vec3<f32>,
}

@group(0) @binding(BINDING_FRAME) var<uniform> frame: FrameUniforms;
