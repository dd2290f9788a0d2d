// Where the rays of each tile of pixels may start: a cone around them, marched through the cells.
#import paros::layout::{frame, TILE}
#import paros::box

@group(0) @binding(3) var cells: texture_3d<f32>;
@group(0) @binding(6) var nearest: sampler;

struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) direction: vec3<f32>,
    @location(1) @interpolate(flat) eye: vec3<f32>,
    // How far a tile's corner ray is from its middle one, for each unit of depth.
    @location(2) @interpolate(flat) spread: f32,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32, @builtin(view_index) view: u32) -> Corner {
    let corner = vec2<f32>(f32(index & 1u), f32(index >> 1u)) * 2.0;
    let pixel = corner * frame.extent.zw * TILE;
    let ray_x = frame.views[view].ray_x.xyz;
    let ray_y = frame.views[view].ray_y.xyz;
    let direction = frame.views[view].ray_base.xyz + pixel.x * ray_x + pixel.y * ray_y;
    let across = (abs(ray_x) + abs(ray_y)) * (0.5 * TILE);
    return Corner(
        vec4<f32>(corner * 2.0 - 1.0, 0.0, 1.0),
        direction,
        frame.views[view].eye.xyz,
        max(across.x, max(across.y, across.z)),
    );
}

// Depth in voxels before which no ray of the tile meets the surface; none if it is negative.
@fragment
fn fragment(
    @location(0) direction: vec3<f32>,
    @location(1) @interpolate(flat) eye: vec3<f32>,
    @location(2) @interpolate(flat) spread: f32,
) -> @location(0) f32 {
    let side = frame.sun_room.w;
    let pad = 0.5 * (side - frame.sun_grid.w);
    let o = eye + pad;
    // The cone is nowhere wider than where it has passed the box.
    let reach = length(max(abs(o), abs(o - side)));
    let wide = spread * reach;
    let span = box::span(o, direction, pad - 1.0 - wide, side - pad + 1.0 + wide);
    let speed = 1.0 / (max(abs(direction.x), max(abs(direction.y), abs(direction.z))) + spread);
    var t = max(span.x, frame.depth.z);
    while t < span.y {
        let p = o + direction * t;
        let inside = clamp(p, vec3<f32>(0.5), vec3<f32>(side - 0.5));
        let out = abs(p - inside);
        let free = 1020.0 * textureSampleLevel(cells, nearest, inside / side, 0.0).x;
        let radius = max(free, max(out.x, max(out.y, out.z)) - 0.5) - 0.01;
        let step = (radius - spread * t) * speed;
        if step < 0.5 {
            return t;
        }
        t += step;
    }
    return -1.0;
}
