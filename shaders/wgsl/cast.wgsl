// The shadow map's depth: meshes, and the sculpture by ray marching its box.
#import paros::layout::frame
#import paros::constants::{BINDING_CLAMPED, BINDING_DENSITY, DENSITY_LEVELS}
#import paros::box

@group(0) @binding(BINDING_DENSITY) var density: texture_3d<f32>;
@group(0) @binding(BINDING_CLAMPED) var clamped: sampler;

#ifdef SCULPTURE

struct VertexOutput {
    @builtin(position) position: vec4<f32>,
    @location(0) grid: vec3<f32>,
    @location(1) depth: f32,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> VertexOutput {
    let grid = box::strip_corner(index) * frame.grid_side;
    let clip = frame.shadow_from_grid * vec4<f32>(grid, 1.0);
    return VertexOutput(clip, grid, clip.z);
}

// Ray marching from the box's border to a density of a half, with empty-space skipping by the
// coarsest mip level. Both paths cast this shadow: their surfaces differ by less than a texel of
// the map, which is several voxels wide.
@fragment
fn fragment(@location(0) grid: vec3<f32>, @location(1) depth: f32) -> @builtin(frag_depth) f32 {
    let n = frame.grid_side;
    let side = frame.density_side;
    let d = -frame.sun_in_grid;
    // The rasterised point lies anywhere on the ray within the box: start outside of it.
    let lead = 2.0 * n;
    let range = box::clip_ray(grid - d * lead, d, vec3<f32>(0.0), vec3<f32>(n)) - lead;
    let o = (grid + 0.5 * (side - n)) / side;
    var t = range.x;
    while t < range.y {
        let p = o + d * (t / side);
        // A texel of the last mip level is the mean of 8 x 8 x 8 texels: where the trilinear sample
        // is 0, four voxels around are empty.
        if textureSampleLevel(density, clamped, p, f32(DENSITY_LEVELS - 1u)).x == 0.0 {
            t += 4.0;
        } else if textureSampleLevel(density, clamped, p, 0.0).x < 0.5 {
            t += 1.4;
        } else {
            return depth + t * frame.voxel_size * frame.shadow_depth_per_metre;
        }
    }
    discard;
}

#else

@vertex
fn vertex(
    @location(0) position: vec3<f32>,
    @location(3) row_x: vec4<f32>,
    @location(4) row_y: vec4<f32>,
    @location(5) row_z: vec4<f32>,
) -> @builtin(position) vec4<f32> {
    let p = vec4<f32>(position, 1.0);
    let room = vec4<f32>(dot(row_x, p), dot(row_y, p), dot(row_z, p), 1.0);
    return frame.shadow_from_room * room;
}

#endif
