// The widest beams: one for each tile of the picture.
#import paros::layout::{frame, TILE}
#import paros::beam

@group(0) @binding(2) var density: texture_3d<f32>;
@group(0) @binding(3) var cells: texture_3d<f32>;
@group(0) @binding(5) var clamped: sampler;
@group(0) @binding(6) var nearest: sampler;

struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) direction: vec3<f32>,
    @location(1) @interpolate(flat) eye: vec3<f32>,
    @location(2) @interpolate(flat) spread: f32,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32, @builtin(view_index) view: u32) -> Corner {
    let corner = vec2<f32>(f32(index & 1u), f32(index >> 1u)) * 2.0;
    let pixel = corner * frame.extent.zw * TILE;
    let ray_x = frame.views[view].ray_x.xyz;
    let ray_y = frame.views[view].ray_y.xyz;
    let direction = frame.views[view].ray_base.xyz + pixel.x * ray_x + pixel.y * ray_y;
    let across = (abs(ray_x) + abs(ray_y)) * (0.5 * TILE + 1.0);
    return Corner(
        vec4<f32>(corner * 2.0 - 1.0, 0.0, 1.0),
        direction,
        frame.views[view].eye.xyz,
        max(across.x, max(across.y, across.z)),
    );
}

@fragment
fn fragment(
    @location(0) direction: vec3<f32>,
    @location(1) @interpolate(flat) eye: vec3<f32>,
    @location(2) @interpolate(flat) spread: f32,
) -> @location(0) f32 {
    let near = frame.depth.z;
    return beam::start(cells, nearest, density, clamped, eye, direction, spread, near, false);
}
