// Panels and text over the frame, from a list of triangles and an atlas.

@group(0) @binding(0) var atlas: texture_2d_array<f32>;
@group(0) @binding(1) var clamped: sampler;

struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) place: vec2<f32>,
    @location(1) color: vec4<f32>,
}

// `position` is in clip space already, `place` in the atlas from 0 to 1.
@vertex
fn vertex(
    @location(0) position: vec2<f32>,
    @location(1) place: vec2<f32>,
    @location(2) color: vec4<f32>,
) -> Corner {
    return Corner(vec4<f32>(position, 0.0, 1.0), place, color);
}

// Colours are sRGB with alpha multiplied in, as the atlas's are; the target wants linear light.
@fragment
fn fragment(corner: Corner) -> @location(0) vec4<f32> {
    let color = corner.color * textureSampleLevel(atlas, clamped, corner.place, 0, 0.0);
    let low = color.rgb / 12.92;
    let high = pow((color.rgb + 0.055) / 1.055, vec3<f32>(2.4));
    return vec4<f32>(select(high, low, color.rgb <= vec3<f32>(0.04045)), color.a);
}
