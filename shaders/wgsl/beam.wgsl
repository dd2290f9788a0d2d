// How far a beam of rays goes before any of them can meet the surface.
#define_import_path paros::beam
#import paros::layout::frame
#import paros::box

// How fast the density rises towards the surface, a voxel; only rods' is steeper.
const STEEPEST: f32 = 0.6;
const USUAL: f32 = 0.42;

// A beam in the texels of the density; `spread` is how far its rays part for each unit of depth,
// in the largest coordinate. Depth in voxels, or negative if the beam misses everything.
// `cells` tell how far in texels nothing can be met, and close to the surface the density does: a
// beam stops where one of its rays may have met the surface by the steepest rise of the density, and
// else goes on by the usual one. What lies a little deeper then is met all the same, from inside.
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
    var turns = 64u;
    while t < span.y {
        let p = o + direction * t;
        let inside = clamp(p, vec3<f32>(0.5), vec3<f32>(side - 0.5));
        let out = abs(p - inside);
        let free = frame.cells.x * textureSampleLevel(cells, nearest, inside / side, 0.0).x;
        let wide = spread * t;
        var radius = max(free, max(out.x, max(out.y, out.z)) - 0.5) - 0.01;
        var touching = false;
        if close && radius < 2.0 {
            let full = textureSampleLevel(density, clamped, inside / side, 0.0).x;
            if full == 0.0 {
                radius = max(radius, 1.9);
            } else {
                radius = max(radius, (0.5 - full) / USUAL);
                touching = 0.5 - full < STEEPEST * wide;
            }
        }
        let step = (radius - wide) * speed;
        turns -= 1u;
        if touching || step < 0.1 || turns == 0u {
            return t;
        }
        t += step;
    }
    return -1.0;
}
