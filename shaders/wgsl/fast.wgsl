// The smooth surface where the blurred volume is half full, its normal, and its light.
#import paros::layout::{frame, BEAM}
#import paros::marble
#import paros::shadow

// What colours, normals and densities are made of: half precision where it is offered.
#ifdef HALF
alias part = f16;
alias color = vec3<f16>;
#else
alias part = f32;
alias color = vec3<f32>;
#endif

// At several samples a fragment's coverage is its alpha.
override COVERAGE: bool = false;

@group(0) @binding(2) var density: texture_3d<f32>;
@group(0) @binding(3) var cells: texture_3d<f32>;
@group(0) @binding(8) var marble_texture: texture_3d<f32>;
@group(0) @binding(5) var clamped: sampler;
@group(0) @binding(6) var nearest: sampler;
@group(0) @binding(10) var beams: texture_2d_array<f32>;

struct Shaded {
    @location(0) shown: vec4<f32>,
    @builtin(frag_depth) depth: f32,
}

@early_depth_test(less_equal)
@fragment
fn fragment(
    @builtin(position) position: vec4<f32>,
    @builtin(view_index) view: u32,
    @location(0) direction: vec3<f32>,
    @location(1) @interpolate(flat) o: vec3<f32>,
) -> Shaded {
    let start = textureLoad(beams, vec2<u32>(position.xy * (1.0 / BEAM)), view, 0).x;
    if start < 0.0 {
        discard;
    }
    // The ray in the density's coordinates by depth in voxels, and the depth that a voxel along it
    // takes.
    let voxel = 1.0 / (length(direction) * frame.sun_room.w);
    let end = end_of(o, direction);
    let met = march(o, direction, start, end, voxel);
    var t = met.t - f32(met.back) * voxel;
    var coverage = part(1.0);
    if met.full < part(0.5) || met.t >= end {
        if !COVERAGE || met.behind == 0.0 {
            discard;
        } else {
            // Back to where the ray came nearest, in small steps; it is drawn in part.
            var fullest = part(0.0);
            var at = min(met.behind, end);
            for (var left = part(12.0); left > part(0.0); left -= part(1.0)) {
                let full = part(dense(o + direction * at, 0.0));
                if full > fullest {
                    fullest = full;
                    t = at;
                }
                at -= 0.8 * voxel;
            }
            coverage -= part(saturate((0.5 - f32(fullest)) / margin(t)));
        }
    }
    let p = o + direction * t;
    let fall = fall(p);
    let normal = fall * inverseSqrt(max(dot(fall, fall), part(1e-4)));
    let depth = frame.depth.x / t + frame.depth.y;
    return Shaded(vec4<f32>(vec3<f32>(lit(p, normal)), f32(coverage)), depth);
}

// Where a march ended: at the first sample of a half or more, or at the ray's end.
struct Met {
    t: f32,
    full: part,
    // How far before that sample the density is a half, in voxels.
    back: part,
    // A little behind where the ray last came as near as a pixel; zero if it did nowhere.
    behind: f32,
}

fn march(o: vec3<f32>, d: vec3<f32>, start: f32, end: f32, voxel: f32) -> Met {
    var t = start;
    var full = part(0.0);
    var reach = part(2.6);
    var behind = 0.0;
    while t < end {
        // Near the surface.
        var peak = part(0.0);
        for (var left = part(8.0); left > part(0.0); left -= spent(reach)) {
            full = part(dense(o + d * t, 0.0));
            if full >= part(0.5) { break; }
            if COVERAGE {
                peak = max(peak, full);
            }
            reach = step(full);
            t += f32(reach) * voxel;
        }
        // The same test, but not the same number: the loop needn't keep what it found.
        if full > part(0.4998) { break; }
        if COVERAGE && f32(peak) > max(0.5 - margin(t), 0.4) {
            behind = t;
        }
        // Empty cells.
        while t < end {
            let free = textureSampleLevel(cells, nearest, o + d * t, 0.0).x;
            if free == 0.0 { break; }
            t += free * frame.cells.x * voxel;
        }
    }
    // What the sample before was, from how far its step reached.
    let before = max((part(2.6) - reach) * part(1.0 / 16.0), (part(1.65) - reach) * part(0.4));
    let inside = apart(full - part(0.5));
    let outside = apart(part(0.5) - before);
    return Met(t, full, reach * inside / (inside + outside), behind);
}

// What a sample takes of a stretch of 8 near the surface: voxels, or just one of 8 samples where
// registers are few.
fn spent(reach: part) -> part {
#ifdef HALF
    return part(1.0);
#else
    return reach;
#endif
}

// How far below a half the density may be for a ray at a depth to pass within a pixel: it rises by
// about 0.3 a voxel.
fn margin(t: f32) -> f32 {
    return 0.3 * frame.sun_color.w * t;
}

// What a plane's blurred edge makes of a distance from it, undone but for a factor.
fn apart(above: part) -> part {
    return above + part(2.0) * above * above * above;
}

// A step in voxels reaches a little past where a plane would be met: what is one voxel thick is
// not leapt over.
fn step(full: part) -> part {
    return max(part(2.6) - full * part(16.0), part(1.65) - full * part(2.5));
}

// Where a ray ends: a voxel behind the grid, or on the ground.
fn end_of(o: vec3<f32>, d: vec3<f32>) -> f32 {
    let side = frame.sun_room.w;
    let pad = 0.5 * (side - frame.sun_grid.w);
    let low = vec3<f32>(pad - 1.0, pad, pad - 1.0) / side;
    let far = (select(low, vec3<f32>(1.0 - low.x), d > vec3<f32>(0.0)) - o) / d;
    return min(far.x, min(far.y, far.z));
}

fn dense(p: vec3<f32>, level: f32) -> f32 {
    return textureSampleLevel(density, clamped, p, level).x;
}

// Marble under the sun and the ambient light.
fn lit(p: vec3<f32>, normal: color) -> color {
    let n = frame.sun_grid.w;
    // Lengths are meant for 128 voxels.
    let voxel = n / (128.0 * frame.sun_room.w);
    let facing = dot(normal, color(frame.sun_grid.xyz));
    var direct = color(frame.sun_color.xyz);
    if facing > part(0.0) {
        direct *= facing * visibility(p, voxel);
    } else {
        // What comes through the stone where it is thin is warm.
        let through = p + (frame.sun_grid.xyz * 3.0 - vec3<f32>(normal)) * voxel;
        let thin = part(1.0) - part(dense(through, 1.0));
        direct *= color(0.14, 0.08, 0.05) * (thin * -facing);
    }
    let around = ambient(normal) * open(p, normal, voxel);
    let grid = (p - 0.5) * (frame.sun_room.w / n) + 0.5;
    let grey = part(textureSampleLevel(marble_texture, clamped, grid, 0.0).x);
    let stone = mix(color(marble::WHITE), color(marble::GREY), grey);
    let radiance = stone * (direct + around);
    return radiance * (radiance * part(0.25) + part(1.0)) / (radiance + part(1.0));
}

// How the blurred density falls, 4 times a voxel's worth: samples on a tetrahedron's corners.
fn fall(p: vec3<f32>) -> color {
    let voxel = 1.0 / frame.sun_room.w;
    let a = part(dense(p + vec3<f32>(1.0, 1.0, 1.0) * voxel, 1.0));
    let b = part(dense(p + vec3<f32>(1.0, -1.0, -1.0) * voxel, 1.0));
    let c = part(dense(p + vec3<f32>(-1.0, 1.0, -1.0) * voxel, 1.0));
    let d = part(dense(p + vec3<f32>(-1.0, -1.0, 1.0) * voxel, 1.0));
    return color(c + d - a - b, b + d - a - c, b + c - a - d);
}

// Three samples towards the sun, blurred as they are far.
fn visibility(p: vec3<f32>, voxel: f32) -> part {
    var seen = part(1.0);
    var far = 2.8 * voxel;
    for (var level = 1.0; level < 4.0; level += 1.0) {
        seen -= seen * part(0.9) * part(dense(p + frame.sun_grid.xyz * far, level));
        far *= 2.5;
    }
    let grid = (p - 0.5) * frame.sun_room.w + 0.5 * frame.sun_grid.w;
    return seen * part(shadow::beyond(grid));
}

// How open the point is to the ambient light: what is empty above it.
fn open(p: vec3<f32>, normal: color, voxel: f32) -> part {
    let full = part(dense(p + vec3<f32>(normal) * (5.0 * voxel), 2.0));
    return part(1.15) - part(1.15) * min(full, part(0.9));
}

// `light::ambient`, in these numbers.
fn ambient(n: color) -> color {
    var sum = color(frame.ambient[0].xyz);
    sum += color(frame.ambient[1].xyz) * n.x + color(frame.ambient[2].xyz) * n.y;
    sum += color(frame.ambient[3].xyz) * n.z + color(frame.ambient[4].xyz) * (n.x * n.y);
    sum += color(frame.ambient[5].xyz) * (n.y * n.z) + color(frame.ambient[6].xyz) * (n.x * n.z);
    sum += color(frame.ambient[7].xyz) * (n.x * n.x) + color(frame.ambient[8].xyz) * (n.y * n.y);
    return max(sum, color(0.0));
}
