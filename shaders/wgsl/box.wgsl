// The sculpture's bounding box: its faces as a triangle strip, and ray-box intersection.
#define_import_path paros::box
#import paros::layout::frame

struct VertexOutput {
    @builtin(position) position: vec4<f32>,
    @location(0) direction: vec3<f32>,
    @location(1) @interpolate(flat) eye: vec3<f32>,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32, @builtin(view_index) view: u32) -> VertexOutput {
    let grid = strip_corner(index) * frame.grid_side;
    let room = frame.room_from_grid * vec4<f32>(grid, 1.0);
    let eye = frame.views[view].eye;
    return VertexOutput(frame.views[view].clip_from_room * room, grid - eye, eye);
}

// Corner of the unit cube at an index of a triangle strip of 14 vertices.
fn strip_corner(index: u32) -> vec3<f32> {
    // Bit i of each mask is a coordinate of corner i.
    let bits = (vec3<u32>(0x287au, 0x02afu, 0x31e3u) >> vec3<u32>(index)) & vec3<u32>(1u);
    return vec3<f32>(bits);
}

// Slab test: the depths where a ray enters and leaves the box from `low` to `high`, the first one
// at least 0. The ray misses unless the first is less than the second.
fn clip_ray(eye: vec3<f32>, direction: vec3<f32>, low: vec3<f32>, high: vec3<f32>) -> vec2<f32> {
    let inverse = 1.0 / direction;
    let a = (low - eye) * inverse;
    let b = (high - eye) * inverse;
    let near = min(a, b);
    let far = max(a, b);
    return vec2<f32>(
        max(max(near.x, near.y), max(near.z, 0.0)),
        min(min(far.x, far.y), far.z),
    );
}

// The depth where a ray from inside leaves the box from `low` to `high`.
fn exit_depth(eye: vec3<f32>, direction: vec3<f32>, low: vec3<f32>, high: vec3<f32>) -> f32 {
    let far = (select(low, high, direction > vec3<f32>(0.0)) - eye) / direction;
    return min(far.x, min(far.y, far.z));
}
