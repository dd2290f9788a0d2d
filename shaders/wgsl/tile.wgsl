// Tiles of pixels that may show the sculpture, as quads at the depth where their rays start.
#import paros::layout::{frame, TILE}

// Pixels of the picture along a side of the target's: 1, or a beam's width.
override WIDTH: f32 = 1.0;

@group(0) @binding(7) var starts: texture_2d_array<f32>;

struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) direction: vec3<f32>,
    @location(1) @interpolate(flat) eye: vec3<f32>,
#ifdef BEAMS
    @location(2) @interpolate(flat) start: f32,
    @location(3) @interpolate(flat) spread: f32,
#endif
}

@vertex
fn vertex(
    @builtin(vertex_index) index: u32,
    @builtin(instance_index) instance: u32,
    @builtin(view_index) view: u32,
) -> Corner {
    let across = u32(frame.extent.z);
    let tile = vec2<u32>(instance % across, instance / across);
    let start = textureLoad(starts, tile, view, 0).x;
    let pixel = vec2<f32>(tile + vec2<u32>(index & 1u, index >> 1u)) * TILE;
    let ray_x = frame.views[view].ray_x.xyz;
    let ray_y = frame.views[view].ray_y.xyz;
    let direction = frame.views[view].ray_base.xyz + pixel.x * ray_x + pixel.y * ray_y;
    // What has no start goes where nothing is drawn.
    let depth = select(frame.depth.x / start + frame.depth.y, -1.0, start < 0.0);
    // The picture's own rays are in the density texture's coordinates, beams' in voxels.
    let side = select(1.0, frame.sun_room.w, WIDTH == 1.0);
    let pad = select(0.0, 0.5 * (side - frame.sun_grid.w), WIDTH == 1.0);
    let place = pixel / (ceil(frame.extent.xy / WIDTH) * WIDTH) * 2.0 - 1.0;
    // A pixel more than the beam's corner: rays that just miss are drawn in part.
    let corner = (abs(ray_x) + abs(ray_y)) * (0.5 * WIDTH + 1.0);
    return Corner(
        vec4<f32>(place, depth, 1.0),
        direction / side,
        (frame.views[view].eye.xyz + pad) / side,
#ifdef BEAMS
        start,
        max(corner.x, max(corner.y, corner.z)),
#endif
    );
}
