// The first level of cone marching: a beam for each screen tile of 64 x 64 pixels.
#import paros::layout::frame
#import paros::constants::{
    BINDING_CELLS, BINDING_CLAMPED, BINDING_DENSITY, BINDING_NEAREST, TILE_PIXELS,
}
#import paros::beam

@group(0) @binding(BINDING_DENSITY) var density: texture_3d<f32>;
@group(0) @binding(BINDING_CELLS) var cells: texture_3d<f32>;
@group(0) @binding(BINDING_CLAMPED) var clamped: sampler;
@group(0) @binding(BINDING_NEAREST) var nearest: sampler;

struct VertexOutput {
    @builtin(position) position: vec4<f32>,
    @location(0) direction: vec3<f32>,
    @location(1) @interpolate(flat) eye: vec3<f32>,
    @location(2) @interpolate(flat) spread: f32,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32, @builtin(view_index) view: u32) -> VertexOutput {
    let corner = vec2<f32>(f32(index & 1u), f32(index >> 1u)) * 2.0;
    let pixel = corner * frame.tiles * f32(TILE_PIXELS);
    let ray_x = frame.views[view].ray_x;
    let ray_y = frame.views[view].ray_y;
    let direction = frame.views[view].ray_base + pixel.x * ray_x + pixel.y * ray_y;
    let spread = (abs(ray_x) + abs(ray_y)) * (0.5 * f32(TILE_PIXELS) + 1.0);
    return VertexOutput(
        vec4<f32>(corner * 2.0 - 1.0, 0.0, 1.0),
        direction,
        frame.views[view].eye,
        max(spread.x, max(spread.y, spread.z)),
    );
}

@fragment
fn fragment(
    @location(0) direction: vec3<f32>,
    @location(1) @interpolate(flat) eye: vec3<f32>,
    @location(2) @interpolate(flat) spread: f32,
) -> @location(0) f32 {
    let near = frame.near;
    return beam::find_start(cells, nearest, density, clamped, eye, direction, spread, near, false);
}
