// The room and what is in it: meshes in the sun and in the room's own light.
#import paros::layout::frame
#import paros::light
#import paros::shadow

// A vertex's normal may be this far, in metres, from what shades it: a texel of the map and a half.
const AWAY: f32 = 0.012;

struct Vertex {
    @location(0) position: vec3<f32>,
    @location(1) normal: vec4<f32>,
    // w: the part of the ambient light that arrives.
    @location(2) color: vec4<f32>,
    // The rows of what brings a point of the mesh into the room.
    @location(3) row_x: vec4<f32>,
    @location(4) row_y: vec4<f32>,
    @location(5) row_z: vec4<f32>,
    // w: how much shines by itself, or for a particle how much of what is behind it it hides.
    @location(6) tint: vec4<f32>,
}

struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) normal: vec3<f32>,
    @location(1) color: vec3<f32>,
    @location(2) sun_place: vec3<f32>,
    // The ambient light that arrives, and the tint's fourth part.
    @location(3) extra: vec2<f32>,
}

@vertex
fn vertex(v: Vertex, @builtin(view_index) view: u32) -> Corner {
    let p = vec4<f32>(v.position, 1.0);
    let room = vec3<f32>(dot(v.row_x, p), dot(v.row_y, p), dot(v.row_z, p));
    let n = v.normal.xyz;
    let normal = normalize(vec3<f32>(dot(v.row_x.xyz, n), dot(v.row_y.xyz, n), dot(v.row_z.xyz, n)));
    return Corner(
        frame.views[view].clip_from_room * vec4<f32>(room, 1.0),
        normal,
        v.color.xyz * v.tint.xyz,
        (frame.shadow_from_room * vec4<f32>(room + normal * AWAY, 1.0)).xyz,
        vec2<f32>(v.color.w, v.tint.w),
    );
}

@fragment
fn fragment(
    @location(0) normal: vec3<f32>,
    @location(1) color: vec3<f32>,
    @location(2) sun_place: vec3<f32>,
    @location(3) extra: vec2<f32>,
) -> @location(0) vec4<f32> {
    let n = normalize(normal);
    let facing = dot(n, frame.sun_room.xyz);
    let in_grid = (vec4<f32>(n, 0.0) * frame.room_from_grid).xyz / frame.depth.w;
    var lit = light::ambient(in_grid) * extra.x;
    if facing > 0.0 {
        lit += frame.sun_color.xyz * (facing * shadow::around(sun_place));
    }
#ifdef PARTICLES
    let opacity = extra.y;
#else
    lit += extra.y;
    let opacity = 1.0;
#endif
    return vec4<f32>(light::shown(color * lit), opacity);
}
