// How far a beam of rays goes before any of them can meet the surface.
#define_import_path paros::beam
#import paros::layout::frame
#import paros::box

// A beam in the texels of the density; `spread` is how far its rays part for each unit of depth,
// in the largest coordinate. Depth in voxels, or negative if the beam misses everything.
// `cells` tell how far in texels nothing can be met, and close to the surface the density does:
// it changes by at most 0.6 a voxel.
fn start(
    cells: texture_3d<f32>,
    nearest: sampler,
    density: texture_3d<f32>,
    clamped: sampler,
    eye: vec3<f32>,
    direction: vec3<f32>,
    spread: f32,
    begin: f32,
    close: bool,
) -> f32 {
    let side = frame.sun_room.w;
    let pad = 0.5 * (side - frame.sun_grid.w);
    let o = eye + pad;
    // The beam is nowhere wider than where it has passed the box.
    let wide = spread * length(max(abs(o), abs(o - side)));
    let low = vec3<f32>(pad - 1.0 - wide);
    let span = box::span(o, direction, low, vec3<f32>(side) - low);
    let size = abs(direction);
    let speed = 1.0 / (max(size.x, max(size.y, size.z)) + spread);
    var t = max(span.x, begin);
    // Where it stops doesn't matter to the picture: a beam that crawls along a surface may.
    var turns = 16u;
    while t < span.y {
        let p = o + direction * t;
        let inside = clamp(p, vec3<f32>(0.5), vec3<f32>(side - 0.5));
        let out = abs(p - inside);
        let free = frame.cells.x * textureSampleLevel(cells, nearest, inside / side, 0.0).x;
        var radius = max(free, max(out.x, max(out.y, out.z)) - 0.5) - 0.01;
        if close && radius < 2.0 {
            let full = textureSampleLevel(density, clamped, inside / side, 0.0).x;
            radius = max(radius, select((0.5 - full) / 0.6, 1.9, full == 0.0));
        }
        let step = (radius - spread * t) * speed;
        turns -= 1u;
        if step < 0.4 || turns == 0u {
            return t;
        }
        t += step;
    }
    return -1.0;
}
