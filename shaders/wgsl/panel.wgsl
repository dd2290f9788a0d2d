// Panels in the room: rounded boxes, shapes of a signed distance field atlas, rings, and pictures, a quad
// each. The twin is `src/panel/quad.rs`. A pixel fetches at most one texel, and none for boxes and rings.
#import paros::layout::frame
#import paros::constants::{
    BINDING_CLAMPED, BINDING_PANEL_ATLAS, BINDING_PANEL_PICTURES, PANEL_BOX, PANEL_IMAGE, PANEL_QUAD_MARGIN,
    PANEL_REACH_TEXELS, PANEL_RING, PANEL_SHAPE, SRGB_EXPONENT, SRGB_LINEAR_SLOPE, SRGB_OFFSET,
}

@group(0) @binding(BINDING_PANEL_ATLAS) var atlas: texture_2d_array<f32>;
// sRGB, a layer for each cell; transparent where there is no picture.
@group(0) @binding(BINDING_PANEL_PICTURES) var pictures: texture_2d_array<f32>;
@group(0) @binding(BINDING_CLAMPED) var clamped: sampler;

const TURN: f32 = 6.2831855;

struct Quad {
    // Rows of the affine transform from the panel, in millimetres, y down, to the room.
    @location(0) row_x: vec4<f32>,
    @location(1) row_y: vec4<f32>,
    @location(2) row_z: vec4<f32>,
    // Middle and half width and height, in millimetres.
    @location(3) middle_and_half: vec4<f32>,
    // By kind, as `PanelQuad::shape`.
    @location(4) shape: vec4<f32>,
    // sRGB, straight alpha.
    @location(5) fill: vec4<f32>,
    @location(6) outline: vec4<f32>,
    @location(7) kind: u32,
}

struct VertexOutput {
    @builtin(position) position: vec4<f32>,
    // Millimetres from the quad's middle, y down.
    @location(0) at: vec2<f32>,
    @location(1) @interpolate(flat) half: vec2<f32>,
    @location(2) @interpolate(flat) shape: vec4<f32>,
    // Linear, straight alpha.
    @location(3) @interpolate(flat) fill: vec4<f32>,
    @location(4) @interpolate(flat) outline: vec4<f32>,
    @location(5) @interpolate(flat) kind: u32,
}

@vertex
fn vertex(quad: Quad, @builtin(vertex_index) index: u32, @builtin(view_index) view: u32) -> VertexOutput {
    let corner = vec2<f32>(f32(index >> 1u), f32(index & 1u)) * 2.0 - 1.0;
    var margin = PANEL_QUAD_MARGIN;
    if quad.kind == PANEL_BOX {
        margin += 0.5 * quad.shape.z;
    } else if quad.kind == PANEL_SHAPE {
        margin = 0.0;
    }
    let at = corner * (quad.middle_and_half.zw + margin);
    let p = vec4<f32>(quad.middle_and_half.xy + at, 0.0, 1.0);
    let room = vec4<f32>(dot(quad.row_x, p), dot(quad.row_y, p), dot(quad.row_z, p), 1.0);
    return VertexOutput(
        frame.views[view].clip_from_room * room,
        at,
        quad.middle_and_half.zw,
        quad.shape,
        linear_color(quad.fill),
        linear_color(quad.outline),
        quad.kind,
    );
}

@fragment
fn fragment(
    @location(0) at: vec2<f32>,
    @location(1) @interpolate(flat) half: vec2<f32>,
    @location(2) @interpolate(flat) shape: vec4<f32>,
    @location(3) @interpolate(flat) fill: vec4<f32>,
    @location(4) @interpolate(flat) outline: vec4<f32>,
    @location(5) @interpolate(flat) kind: u32,
) -> @location(0) vec4<f32> {
    // A pixel's width on the panel: the mean of both directions, which differ at a slanting view.
    let right = dpdx(at);
    let down = dpdy(at);
    let pixel = max(sqrt(0.5 * (dot(right, right) + dot(down, down))), 1e-6);
    if kind == PANEL_SHAPE {
        return vec4<f32>(fill.rgb, fill.a * coverage(shape_distance(at, shape), pixel));
    }
    if kind == PANEL_RING {
        return vec4<f32>(fill.rgb, fill.a * coverage(ring_distance(at, half.x, shape.xy), pixel));
    }
    let distance = box_distance(at, half, shape.x);
    if kind == PANEL_IMAGE {
        let color = picture_color((at + half) / (2.0 * half), shape.w);
        return vec4<f32>(color.rgb, color.a * coverage(distance, pixel));
    }
    let softness = shape.z;
    var outer = coverage(distance, max(pixel, softness));
    if softness > 0.0 {
        outer = outer * outer * (3.0 - 2.0 * outer);
    }
    let inner = select(1.0, coverage(distance - shape.y, pixel), shape.y > 0.0);
    let color = mix(outline, fill, inner);
    return vec4<f32>(color.rgb, outer * color.a);
}

// The part of a pixel inside an edge at this distance, which is positive inside.
fn coverage(distance: f32, width: f32) -> f32 {
    return saturate(distance / width + 0.5);
}

fn box_distance(at: vec2<f32>, half: vec2<f32>, radius: f32) -> f32 {
    let beyond = abs(at) - half + radius;
    return radius - length(max(beyond, vec2<f32>(0.0))) - min(max(beyond.x, beyond.y), 0.0);
}

// `width_and_part`: the ring's width, and the part of it from its top clockwise.
fn ring_distance(at: vec2<f32>, radius: f32, width_and_part: vec2<f32>) -> f32 {
    let half_width = 0.5 * width_and_part.x;
    let middle_radius = radius - half_width;
    let turn = TURN * width_and_part.y;
    let angle = atan2(at.x, -at.y);
    if select(angle, angle + TURN, angle < 0.0) <= turn {
        return half_width - abs(length(at) - middle_radius);
    }
    let start = vec2<f32>(0.0, -middle_radius);
    let end = vec2<f32>(sin(turn), -cos(turn)) * middle_radius;
    return half_width - min(distance(at, start), distance(at, end));
}

fn shape_distance(at: vec2<f32>, shape: vec4<f32>) -> f32 {
    let along = shape.z;
    let across = shape.w;
    let texel = shape.xy + vec2<f32>(at.x * along - at.y * across, at.x * across + at.y * along);
    let place = texel / vec2<f32>(textureDimensions(atlas));
    let value = textureSampleLevel(atlas, clamped, place, 0, 0.0).x;
    return (value - 0.5) * 2.0 * PANEL_REACH_TEXELS / length(shape.zw);
}

// `place`: 0 to 1 from the picture's upper left corner.
fn picture_color(place: vec2<f32>, cell: f32) -> vec4<f32> {
    return textureSampleLevel(pictures, clamped, place, u32(cell), 0.0);
}

// The sRGB target takes linear colours.
fn linear_color(color: vec4<f32>) -> vec4<f32> {
    let low = color.rgb / SRGB_LINEAR_SLOPE;
    let high = pow((color.rgb + SRGB_OFFSET) / (1.0 + SRGB_OFFSET), vec3<f32>(SRGB_EXPONENT));
    return vec4<f32>(select(high, low, color.rgb <= vec3<f32>(0.04045)), color.a);
}
