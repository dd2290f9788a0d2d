// The sculpture's box, drawn by its faces.
#define_import_path paros::box
#import paros::layout::frame

struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) direction: vec3<f32>,
    @location(1) @interpolate(flat) eye: vec3<f32>,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32, @builtin(view_index) view: u32) -> Corner {
    let grid = corner(index) * frame.sun_grid.w;
    let room = frame.room_from_grid * vec4<f32>(grid, 1.0);
    let eye = frame.views[view].eye.xyz;
    return Corner(frame.views[view].clip_from_room * room, grid - eye, eye);
}

// A strip of 14 corners around a cube of side 1.
fn corner(index: u32) -> vec3<f32> {
    // Bit i of each mask is a coordinate of corner i.
    let bits = (vec3<u32>(0x287au, 0x02afu, 0x31e3u) >> vec3<u32>(index)) & vec3<u32>(1u);
    return vec3<f32>(bits);
}

// Where a ray enters and leaves the cube from `low` to `high`, not behind the eye.
fn span(eye: vec3<f32>, direction: vec3<f32>, low: vec3<f32>, high: vec3<f32>) -> vec2<f32> {
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
