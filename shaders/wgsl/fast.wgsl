// The smooth surface where the blurred volume is half full, its normal, and its light.
#import paros::layout::{frame, BEAM}
#import paros::box
#import paros::marble
#import paros::light
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
    @location(1) @interpolate(flat) eye: vec3<f32>,
) -> Shaded {
    let start = textureLoad(beams, vec2<u32>(position.xy * (1.0 / BEAM)), view, 0).x;
    if start < 0.0 {
        discard;
    }
    let side = frame.sun_room.w;
    let pad = 0.5 * (side - frame.sun_grid.w);
    let speed = length(direction);
    // Lengths along the ray are voxels; points are the density texture's coordinates.
    let d = direction / (speed * side);
    let o = (eye + pad) / side;
    // A voxel more than the grid on every side but the ground's.
    let low = vec3<f32>(pad - 1.0, pad, pad - 1.0) / side;
    let span = box::span(o, d, low, vec3<f32>(1.0 - low.x));
    let size = abs(d);
    let leap = 1020.0 / (max(size.x, max(size.y, size.z)) * side);
    var t = max(start * speed, span.x);
    var full = part(0.0);
    var best = part(0.0);
    var at = t;
    while t < span.y {
        // Four voxels near the surface. Steps reach a little past where a plane would be met:
        // what is one voxel thick is not leapt over.
        let until = min(t + 4.0, span.y);
        while t < until {
            full = part(dense(o + d * t, 0.0));
            if full > best {
                best = full;
                at = t;
            }
            if full >= part(0.5) { break; }
            t += f32(max(part(2.9) - full * part(16.0), part(1.65) - full * part(2.5)));
        }
        if full >= part(0.5) { break; }
        // Empty cells.
        while t < span.y {
            let free = textureSampleLevel(cells, nearest, o + d * t, 0.0).x;
            if free == 0.0 { break; }
            t += free * leap;
        }
    }
    // What a ray that just misses covers of its pixel; the density rises by about 0.3 a voxel at
    // the surface.
    var coverage = part(1.0);
    if best < part(0.5) {
        if !COVERAGE {
            discard;
        }
        let gap = (0.5 - f32(best)) / (0.3 * frame.sun_color.w * at / speed);
        if gap >= 1.0 {
            discard;
        }
        coverage = part(1.0 - gap);
    }
    let fall = fall(o + d * at);
    if best >= part(0.5) {
        // Back to where the density is a half: twice along its slope at the first point inside.
        let slope = 1.0 / min(dot(vec3<f32>(fall), d) * (side / -4.8), -0.05);
        at += clamp((f32(best) - 0.5) * slope, -1.2, 0.0);
        at += clamp((dense(o + d * at, 0.0) - 0.5) * slope, -0.5, 0.5);
    }
    let normal = fall * inverseSqrt(max(dot(fall, fall), part(1e-4)));
    let depth = frame.depth.x * speed / at + frame.depth.y;
    return Shaded(vec4<f32>(vec3<f32>(lit(o + d * at, normal)), f32(coverage)), depth);
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
    let in_room = (frame.room_from_grid * vec4<f32>(vec3<f32>(normal), 0.0)).xyz;
    let around = ambient(color(normalize(in_room))) * open(p, normal, voxel);
    let grid = (p - 0.5) * (frame.sun_room.w / n) + 0.5;
    let grey = part(textureSampleLevel(marble_texture, clamped, grid, 0.0).x);
    let stone = mix(color(marble::WHITE), color(marble::GREY), grey);
    let radiance = stone * (direct + around);
    return radiance * (radiance * part(0.25) + part(1.0)) / (radiance + part(1.0));
}

// How the density falls, 4.8 times a voxel's worth: four samples on a tetrahedron's corners.
fn fall(p: vec3<f32>) -> color {
    let e = vec2<f32>(1.2, -1.2) / frame.sun_room.w;
    let a = part(dense(p + e.xyy, 0.0));
    let b = part(dense(p + e.yyx, 0.0));
    let c = part(dense(p + e.yxy, 0.0));
    let f = part(dense(p + e.xxx, 0.0));
    return color(b + c - a - f, a + b - c - f, a + c - b - f);
}

// Four samples towards the sun, blurred as they are far.
fn visibility(p: vec3<f32>, voxel: f32) -> part {
    let towards = frame.sun_grid.xyz * voxel;
    let a = part(1.0) - part(0.9) * part(dense(p + towards * 2.3, 0.0));
    let b = part(1.0) - part(0.9) * part(dense(p + towards * 5.0, 1.0));
    let c = part(1.0) - part(0.9) * part(dense(p + towards * 11.0, 2.0));
    let f = part(1.0) - part(0.9) * part(dense(p + towards * 24.0, 3.0));
    let grid = (p - 0.5) * frame.sun_room.w + 0.5 * frame.sun_grid.w;
    return a * b * c * f * part(shadow::beyond(grid));
}

// How open the point is to the ambient light: what is empty above it.
fn open(p: vec3<f32>, normal: color, voxel: f32) -> part {
    let full = part(dense(p + vec3<f32>(normal) * (5.0 * voxel), 2.0));
    return part(1.15) - part(1.15) * min(full, part(0.9));
}

fn ambient(n: color) -> color {
    var sum = color(frame.ambient[0].xyz);
    sum += color(frame.ambient[1].xyz) * n.y + color(frame.ambient[2].xyz) * n.z;
    sum += color(frame.ambient[3].xyz) * n.x + color(frame.ambient[4].xyz) * (n.x * n.y);
    sum += color(frame.ambient[5].xyz) * (n.y * n.z) + color(frame.ambient[7].xyz) * (n.x * n.z);
    sum += color(frame.ambient[6].xyz) * (part(3.0) * n.z * n.z - part(1.0));
    sum += color(frame.ambient[8].xyz) * (n.x * n.x - n.y * n.y);
    return max(sum, color(0.0));
}
