// What the sun's map tells: how far its light reaches past the room's things and the sculpture.
#define_import_path paros::shadow
#import paros::layout::frame
#import paros::box

@group(0) @binding(11) var map: texture_depth_2d_array;
@group(0) @binding(12) var within: sampler_comparison;

// Depth of the map, in metres, by which the point where a ray leaves the sculpture's box is held
// nearer to the sun: texels of the sculpture's own shadow reach over the box's border.
const LIFT: f32 = 0.04;

// The part of the sun's light that arrives where a ray from a point in voxels of the grid leaves
// the box. The sun's rays are parallel: the whole ray has one place in the map.
fn beyond(grid: vec3<f32>) -> f32 {
    let n = frame.sun_grid.w;
    let way = box::span(grid, frame.sun_grid.xyz, vec3<f32>(0.0), vec3<f32>(n)).y;
    let place = (frame.shadow_from_grid * vec4<f32>(grid, 1.0)).xyz;
    let far = max(way, 0.0) * frame.depth.w + LIFT;
    let reached = place.z - far * frame.sun_map.x;
    return textureSampleCompareLevel(map, within, place.xy * 0.5 + 0.5, 0, reached);
}

// The same at a place in the map, softened over three texels.
fn around(place: vec3<f32>) -> f32 {
    let at = place.xy * 0.5 + 0.5;
    let e = vec2<f32>(0.75, -0.75) * frame.sun_map.y;
    let sum = textureSampleCompareLevel(map, within, at + e.xx, 0, place.z)
        + textureSampleCompareLevel(map, within, at + e.xy, 0, place.z)
        + textureSampleCompareLevel(map, within, at + e.yx, 0, place.z)
        + textureSampleCompareLevel(map, within, at + e.yy, 0, place.z);
    return sum * 0.25;
}
