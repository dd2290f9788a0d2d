// What every program reads. `src/gpu/layout.rs` mirrors the structures, and the build checks their
// sizes against each other.
#define_import_path paros::layout

// An eye. A ray is `eye + t * (ray_base + x * ray_x + y * ray_y)` for the pixel (x, y), in voxels
// of the grid, with t the depth before the eye in voxels too.
struct View {
    clip_from_room: mat4x4<f32>,
    eye: vec4<f32>,
    ray_base: vec4<f32>,
    ray_x: vec4<f32>,
    ray_y: vec4<f32>,
}

// Pixels along a tile's side, and along a beam's.
const TILE: f32 = 64.0;
const BEAM: f32 = 8.0;

// The sculpture and the light, the same for both eyes.
struct Frame {
    views: array<View, 2>,
    // Clip space of the sun's map, with depth 0 next to the sun; zeros where there is no map: then
    // all is lit.
    shadow_from_grid: mat4x4<f32>,
    shadow_from_room: mat4x4<f32>,
    // Columns: the grid's axes in the room, then the grid's origin there. Metres a voxel.
    room_from_grid: mat4x4<f32>,
    // Towards the sun, in the grid. w: voxels along a side of the grid.
    sun_grid: vec4<f32>,
    // Towards the sun, in the room. w: texels along a side of the density texture.
    sun_room: vec4<f32>,
    // w: voxels that a pixel is wide at a depth of one voxel.
    sun_color: vec4<f32>,
    // The ambient light over pi for a normal of the grid: the constant, then the factors of x, y,
    // z, xy, yz, xz, xx and yy.
    ambient: array<vec4<f32>, 9>,
    // The depth buffer holds `x / t + y`; z: depth in voxels of the near plane; w: metres a voxel.
    depth: vec4<f32>,
    // Pixels across and down, tiles across and down.
    extent: vec4<f32>,
    // x: texels of the density that a cell's byte tells of if it is 255.
    cells: vec4<f32>,
    // The sun's map: depth a metre; the part of its side that a texel is.
    sun_map: vec4<f32>,
}

@group(0) @binding(0) var<uniform> frame: Frame;
