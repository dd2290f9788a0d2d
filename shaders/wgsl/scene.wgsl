// The room's meshes and particles: Lambertian shading, a shadow map, baked ambient occlusion.
#import paros::layout::frame
#import paros::light
#import paros::shadow
#import paros::constants::{
    BINDING_CLAMPED, BINDING_DENSITY, CONTACT_FADE, CONTACT_HEIGHT, CONTACT_OPACITY,
}

@group(0) @binding(BINDING_DENSITY) var density: texture_3d<f32>;
@group(0) @binding(BINDING_CLAMPED) var clamped: sampler;

// Normal offset against shadow acne, in metres: a texel and a half of the map.
const NORMAL_OFFSET: f32 = 0.012;

struct VertexInput {
    @location(0) position: vec3<f32>,
    @location(1) normal: vec4<f32>,
    // w: baked ambient occlusion, the part of the ambient light that arrives.
    @location(2) color: vec4<f32>,
    // Rows of the affine transform from the mesh to the room.
    @location(3) row_x: vec4<f32>,
    @location(4) row_y: vec4<f32>,
    @location(5) row_z: vec4<f32>,
    // w: emission; for a particle its opacity.
    @location(6) tint: vec4<f32>,
}

struct VertexOutput {
    @builtin(position) position: vec4<f32>,
    @location(0) normal: vec3<f32>,
    @location(1) color: vec3<f32>,
    @location(2) sun_position: vec3<f32>,
    // Ambient irradiance over pi that arrives, and the tint's w: emission or opacity. Flat faces have one normal, and
    // on round ones a quadratic of it is as good as linear between vertices.
    @location(3) ambient_and_glow: vec4<f32>,
    // A place above the surface, in the density texture.
    @location(4) above: vec3<f32>,
}

@vertex
fn vertex(v: VertexInput, @builtin(view_index) view: u32) -> VertexOutput {
    let p = vec4<f32>(v.position, 1.0);
    let room = vec3<f32>(dot(v.row_x, p), dot(v.row_y, p), dot(v.row_z, p));
    let n = v.normal.xyz;
    let normal = normalize(vec3<f32>(dot(v.row_x.xyz, n), dot(v.row_y.xyz, n), dot(v.row_z.xyz, n)));
    let in_grid = (vec4<f32>(normal, 0.0) * frame.room_from_grid).xyz / frame.voxel_size;
    return VertexOutput(
        frame.views[view].clip_from_room * vec4<f32>(room, 1.0),
        normal,
        v.color.xyz * v.tint.xyz,
        (frame.shadow_from_room * vec4<f32>(room + normal * NORMAL_OFFSET, 1.0)).xyz,
        vec4<f32>(light::ambient_over_pi(in_grid) * v.color.w, v.tint.w),
        density_place(room + normal * (frame.voxel_size * CONTACT_HEIGHT)),
    );
}

@fragment
fn fragment(
    @location(0) normal: vec3<f32>,
    @location(1) color: vec3<f32>,
    @location(2) sun_position: vec3<f32>,
    @location(3) ambient_and_glow: vec4<f32>,
    @location(4) above: vec3<f32>,
) -> @location(0) vec4<f32> {
    let facing = dot(normalize(normal), frame.sun_in_room);
    var irradiance = ambient_and_glow.xyz;
    if facing > 0.0 {
        irradiance += frame.sun_color * (facing * shadow::soft_visibility(sun_position));
    }
#ifdef PARTICLES
    let opacity = ambient_and_glow.w;
#else
    irradiance *= contact_openness(above);
    irradiance += ambient_and_glow.w;
    let opacity = 1.0;
#endif
    return vec4<f32>(light::tone_map(color * irradiance), opacity);
}

// The position in the density texture of a point of the room.
fn density_place(room: vec3<f32>) -> vec3<f32> {
    let from_foot = room - frame.room_from_grid[3].xyz;
    let grid = (vec4<f32>(from_foot, 0.0) * frame.room_from_grid).xyz / (frame.voxel_size * frame.voxel_size);
    return (grid + 0.5 * (frame.density_side - frame.grid_side)) / frame.density_side;
}

// Contact shadow: the part of the light left beside the stone, by its density above a surface; 1 away
// from the stone's cube.
fn contact_openness(above: vec3<f32>) -> f32 {
    let aside = abs(above - 0.5);
    let near = saturate(0.5 * CONTACT_FADE + 1.0 - CONTACT_FADE * max(aside.x, max(aside.y, aside.z)));
    return 1.0 - CONTACT_OPACITY * near * textureSampleLevel(density, clamped, above, 3.0).x;
}
