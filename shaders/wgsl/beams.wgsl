// The second level of cone marching: beams of 8 x 8 pixels, from where their tile's beam stopped.
#import paros::beam
#import paros::constants::{BINDING_CELLS, BINDING_CLAMPED, BINDING_DENSITY, BINDING_NEAREST}

@group(0) @binding(BINDING_DENSITY) var density: texture_3d<f32>;
@group(0) @binding(BINDING_CELLS) var cells: texture_3d<f32>;
@group(0) @binding(BINDING_CLAMPED) var clamped: sampler;
@group(0) @binding(BINDING_NEAREST) var nearest: sampler;

@fragment
fn fragment(
    @location(0) direction: vec3<f32>,
    @location(1) @interpolate(flat) eye: vec3<f32>,
    @location(2) @interpolate(flat) start: f32,
    @location(3) @interpolate(flat) spread: f32,
) -> @location(0) f32 {
    return beam::find_start(cells, nearest, density, clamped, eye, direction, spread, start, true);
}
