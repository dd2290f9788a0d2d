// The second level of cone marching: beams of 8 x 8 pixels, from where their tile's beam stopped.
#import paros::beam

@group(0) @binding(2) var density: texture_3d<f32>;
@group(0) @binding(3) var cells: texture_3d<f32>;
@group(0) @binding(5) var clamped: sampler;
@group(0) @binding(6) var nearest: sampler;

@fragment
fn fragment(
    @location(0) direction: vec3<f32>,
    @location(1) @interpolate(flat) eye: vec3<f32>,
    @location(2) @interpolate(flat) start: f32,
    @location(3) @interpolate(flat) spread: f32,
) -> @location(0) f32 {
    return beam::find_start(cells, nearest, density, clamped, eye, direction, spread, start, true);
}
