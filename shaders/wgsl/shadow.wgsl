// Shadow mapping: the sun's visibility past the room's meshes and the sculpture.
#define_import_path paros::shadow
#import paros::layout::frame
#import paros::box
#import paros::constants::{BINDING_DEPTH_COMPARE, BINDING_SUN_MAP}

@group(0) @binding(BINDING_SUN_MAP) var sun_map: texture_depth_2d_array;
@group(0) @binding(BINDING_DEPTH_COMPARE) var depth_compare: sampler_comparison;

// Depth bias, in metres, of the point where a ray leaves the sculpture's box: texels of the
// sculpture's own shadow reach over the box's border.
const DEPTH_BIAS: f32 = 0.04;

// Visibility of the sun, 0 to 1, from where the ray towards it from a point in voxels of the grid
// leaves the box. The sun's rays are parallel: the whole ray projects to one position in the map.
fn visibility_beyond_box(grid: vec3<f32>) -> f32 {
    let n = frame.grid_side;
    let exit = box::clip_ray(grid, frame.sun_in_grid, vec3<f32>(0.0), vec3<f32>(n)).y;
    let map_position = (frame.shadow_from_grid * vec4<f32>(grid, 1.0)).xyz;
    let far = max(exit, 0.0) * frame.voxel_size + DEPTH_BIAS;
    let reference_depth = map_position.z - far * frame.shadow_depth_per_metre;
    return textureSampleCompareLevel(sun_map, depth_compare, map_position.xy * 0.5 + 0.5, 0, reference_depth);
}

// Percentage-closer filtering over three texels: visibility, 0 to 1, at a position in the map's
// clip space.
fn soft_visibility(map_position: vec3<f32>) -> f32 {
    let at = map_position.xy * 0.5 + 0.5;
    let e = vec2<f32>(0.75, -0.75) * frame.shadow_texel;
    let sum = textureSampleCompareLevel(sun_map, depth_compare, at + e.xx, 0, map_position.z)
        + textureSampleCompareLevel(sun_map, depth_compare, at + e.xy, 0, map_position.z)
        + textureSampleCompareLevel(sun_map, depth_compare, at + e.yx, 0, map_position.z)
        + textureSampleCompareLevel(sun_map, depth_compare, at + e.yy, 0, map_position.z);
    return sum * 0.25;
}
