// Cone marching: the depth to which a beam of rays can skip, because none of its rays can meet the surface
// before it.
#define_import_path paros::beam
#import paros::layout::frame
#import paros::box

// Rise of the density towards the surface per voxel. Only at rods it is steeper, 0.6: there a ray may start
// inside.
const RISE: f32 = 0.42;

// The depth, in voxels, at which a beam must stop; negative if the beam misses everything. `spread` is the
// distance of the beam's outermost rays from the central one per unit of depth, in the Chebyshev norm;
// `first_depth` is the depth at which the beam begins. `cells` holds the empty distance in texels. With
// `by_density` the density bounds that distance near the surface: the beam stops where the density's rise
// could have brought one of its rays to the surface. A ray that starts a little inside still meets it.
fn find_start(
    cells: texture_3d<f32>,
    nearest: sampler,
    density: texture_3d<f32>,
    clamped: sampler,
    eye: vec3<f32>,
    direction: vec3<f32>,
    spread: f32,
    first_depth: f32,
    by_density: bool,
) -> f32 {
    let side = frame.density_side;
    let pad = 0.5 * (side - frame.grid_side);
    let o = eye + pad;
    // Half the beam's width where it has passed the box, an upper bound.
    let wide = spread * length(max(abs(o), abs(o - side)));
    let low = vec3<f32>(pad - 1.0 - wide);
    let span = box::clip_ray(o, direction, low, vec3<f32>(side) - low);
    let extent = abs(direction);
    let speed = 1.0 / (max(extent.x, max(extent.y, extent.z)) + spread);
    var t = max(span.x, first_depth);
    // A beam along a surface may stop early: that costs time, but the picture is the same.
    var steps_left = 64u;
    while t < span.y {
        let p = o + direction * t;
        let inside = clamp(p, vec3<f32>(0.5), vec3<f32>(side - 0.5));
        let out = abs(p - inside);
        let free = frame.cell_reach * textureSampleLevel(cells, nearest, inside / side, 0.0).x;
        let wide = spread * t;
        var radius = max(free, max(out.x, max(out.y, out.z)) - 0.5) - 0.01;
        var touching = false;
        if by_density && radius < 2.0 {
            let full = textureSampleLevel(density, clamped, inside / side, 0.0).x;
            if full == 0.0 {
                radius = max(radius, 1.9);
            } else {
                radius = max(radius, (0.5 - full) / RISE);
                touching = 0.5 - full < RISE * wide;
            }
        }
        let step = (radius - wide) * speed;
        steps_left -= 1u;
        if touching || step < 0.1 || steps_left == 0u {
            return t;
        }
        t += step;
    }
    return -1.0;
}
