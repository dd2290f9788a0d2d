// The meshes and the sculpture as the sun sees them, for its map.
#import paros::layout::frame
#import paros::box

@group(0) @binding(2) var density: texture_3d<f32>;
@group(0) @binding(5) var clamped: sampler;

#ifdef SCULPTURE

struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) grid: vec3<f32>,
    @location(1) depth: f32,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Corner {
    let grid = box::corner(index) * frame.sun_grid.w;
    let place = frame.shadow_from_grid * vec4<f32>(grid, 1.0);
    return Corner(place, grid, place.z);
}

// From where the ray enters the box, to where the density is a half. Both paths cast this
// shadow: it tells only to a texel of the map, several voxels wide, where their surfaces part.
@fragment
fn fragment(@location(0) grid: vec3<f32>, @location(1) depth: f32) -> @builtin(frag_depth) f32 {
    let n = frame.sun_grid.w;
    let side = frame.sun_room.w;
    let d = -frame.sun_grid.xyz;
    // From before the box, wherever on the ray the point is that is drawn.
    let back = 2.0 * n;
    let way = box::span(grid - d * back, d, vec3<f32>(0.0), vec3<f32>(n)) - back;
    let o = (grid + 0.5 * (side - n)) / side;
    var t = way.x;
    while t < way.y {
        let p = o + d * (t / side);
        // Texels of the third level hold the mean of eight voxels across: nothing there is nothing
        // for four voxels around.
        if textureSampleLevel(density, clamped, p, 3.0).x == 0.0 {
            t += 4.0;
        } else if textureSampleLevel(density, clamped, p, 0.0).x < 0.5 {
            t += 1.4;
        } else {
            return depth + t * frame.depth.w * frame.sun_map.x;
        }
    }
    discard;
}

#else

@vertex
fn vertex(
    @location(0) position: vec3<f32>,
    @location(3) row_x: vec4<f32>,
    @location(4) row_y: vec4<f32>,
    @location(5) row_z: vec4<f32>,
) -> @builtin(position) vec4<f32> {
    let p = vec4<f32>(position, 1.0);
    let room = vec4<f32>(dot(row_x, p), dot(row_y, p), dot(row_z, p), 1.0);
    return frame.shadow_from_room * room;
}

#endif
