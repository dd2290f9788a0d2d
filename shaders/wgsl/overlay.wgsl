// Panels and text over the frame: a triangle list textured from an atlas.
#import paros::constants::{
    BINDING_ATLAS, BINDING_ATLAS_SAMPLER, SRGB_EXPONENT, SRGB_LINEAR_SLOPE, SRGB_OFFSET,
}

@group(0) @binding(BINDING_ATLAS) var atlas: texture_2d_array<f32>;
@group(0) @binding(BINDING_ATLAS_SAMPLER) var clamped: sampler;

struct VertexOutput {
    @builtin(position) position: vec4<f32>,
    @location(0) atlas_uv: vec2<f32>,
    @location(1) color: vec4<f32>,
}

// `position` is in clip space, `atlas_uv` in texture coordinates.
@vertex
fn vertex(
    @location(0) position: vec2<f32>,
    @location(1) atlas_uv: vec2<f32>,
    @location(2) color: vec4<f32>,
) -> VertexOutput {
    return VertexOutput(vec4<f32>(position, 0.0, 1.0), atlas_uv, color);
}

// Colours and the atlas are sRGB with premultiplied alpha. The sRGB target takes linear colours.
@fragment
fn fragment(vertex_output: VertexOutput) -> @location(0) vec4<f32> {
    let color = vertex_output.color * textureSampleLevel(atlas, clamped, vertex_output.atlas_uv, 0, 0.0);
    let low = color.rgb / SRGB_LINEAR_SLOPE;
    let high = pow((color.rgb + SRGB_OFFSET) / (1.0 + SRGB_OFFSET), vec3<f32>(SRGB_EXPONENT));
    return vec4<f32>(select(high, low, color.rgb <= vec3<f32>(0.04045)), color.a);
}
