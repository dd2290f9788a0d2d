// Screen tiles whose beam didn't miss, as quads at the depth where their rays start: instances that
// the depth test culls against what has been drawn.
#import paros::layout::frame
#import paros::constants::{BEAM_PIXELS, BINDING_TILE_STARTS, TILE_PIXELS}

// Pixels of the picture along a side of the target's texels.
#ifdef BEAMS
const PIXELS_PER_TEXEL: f32 = f32(BEAM_PIXELS);
#else
const PIXELS_PER_TEXEL: f32 = 1.0;
#endif

@group(0) @binding(BINDING_TILE_STARTS) var starts: texture_2d_array<f32>;

struct VertexOutput {
    @builtin(position) position: vec4<f32>,
    @location(0) direction: vec3<f32>,
    @location(1) @interpolate(flat) eye: vec3<f32>,
#ifdef BEAMS
    @location(2) @interpolate(flat) start: f32,
    @location(3) @interpolate(flat) spread: f32,
#endif
}

@vertex
fn vertex(
    @builtin(vertex_index) index: u32,
    @builtin(instance_index) instance: u32,
    @builtin(view_index) view: u32,
) -> VertexOutput {
    let across = u32(frame.tiles.x);
    let tile = vec2<u32>(instance % across, instance / across);
    let start = textureLoad(starts, tile, view, 0).x;
    let pixel = vec2<f32>(tile + vec2<u32>(index & 1u, index >> 1u)) * f32(TILE_PIXELS);
    let ray_x = frame.views[view].ray_x;
    let ray_y = frame.views[view].ray_y;
    let direction = frame.views[view].ray_base + pixel.x * ray_x + pixel.y * ray_y;
    // A tile whose beam missed is clipped by its depth.
    let depth = select(frame.depth_scale / start + frame.depth_offset, -1.0, start < 0.0);
    // The fast path's rays are in the density texture's coordinates, the beams' in voxels.
    let side = select(1.0, frame.density_side, PIXELS_PER_TEXEL == 1.0);
    let pad = select(0.0, 0.5 * (side - frame.grid_side), PIXELS_PER_TEXEL == 1.0);
    let clip = pixel / (ceil(frame.pixels / PIXELS_PER_TEXEL) * PIXELS_PER_TEXEL) * 2.0 - 1.0;
    // One pixel wider than the beam: rays that pass an outline within a pixel get coverage.
    let corner = (abs(ray_x) + abs(ray_y)) * (0.5 * PIXELS_PER_TEXEL + 1.0);
    return VertexOutput(
        vec4<f32>(clip, depth, 1.0),
        direction / side,
        (frame.views[view].eye + pad) / side,
#ifdef BEAMS
        start,
        max(corner.x, max(corner.y, corner.z)),
#endif
    );
}
