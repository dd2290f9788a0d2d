// The smooth surface where the blurred volume is half full, its normal, and its light.
#import paros::layout::frame
#import paros::box
#import paros::marble
#import paros::light

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

struct Shaded {
    @location(0) shown: vec4<f32>,
    @builtin(frag_depth) depth: f32,
}

@early_depth_test(less_equal)
@fragment
fn fragment(
    @location(0) direction: vec3<f32>,
    @location(1) @interpolate(flat) eye: vec3<f32>,
    @location(2) @interpolate(flat) start: f32,
) -> Shaded {
    let side = frame.sun_room.w;
    let pad = 0.5 * (side - frame.sun_grid.w);
    let speed = length(direction);
    // Lengths along the ray are voxels; points are the density texture's coordinates.
    let d = direction / (speed * side);
    let o = (eye + pad) / side;
    let end = box::span(o, d, (pad - 1.0) / side, 1.0 - (pad - 1.0) / side).y;
    let leap = 1020.0 / (max(abs(d.x), max(abs(d.y), abs(d.z))) * side);
    var t = start * speed;
    var full = part(0.0);
    var best = part(0.0);
    var at = 0.0;
    while t < end {
        // Through empty cells.
        loop {
            let free = textureSampleLevel(cells, nearest, o + d * t, 0.0).x;
            t += free * leap;
            if free == 0.0 || t >= end { break; }
        }
        // Through four voxels near the surface.
        let until = t + 4.0;
        while t < until {
            full = part(textureSampleLevel(density, clamped, o + d * t, 0.0).x);
            if full > best {
                best = full;
                at = t;
            }
            if full >= part(0.5) { break; }
            t += f32(max(part(2.2) - full * part(6.0), part(0.35)));
        }
        if full >= part(0.5) { break; }
    }
    // What a ray that just misses leaves uncovered of its pixel; the density rises by about 0.3 a
    // voxel at the surface.
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
    } else {
        at = refined(o, d, at, best);
    }
    let depth = frame.depth.x * speed / at + frame.depth.y;
    return Shaded(vec4<f32>(vec3<f32>(lit(o + d * at)), f32(coverage)), depth);
}

// Where the density is a half, between the step before and a point inside: two false positions.
fn refined(o: vec3<f32>, d: vec3<f32>, inside: f32, full: part) -> f32 {
    var high = vec2<f32>(inside, f32(full) - 0.5);
    var low = vec2<f32>(inside - 0.5, dense(o + d * (inside - 0.5), 0.0) - 0.5);
    if low.y >= 0.0 {
        return inside;
    }
    for (var i = 0; i < 2; i++) {
        let t = mix(low.x, high.x, low.y / (low.y - high.y));
        let middle = vec2<f32>(t, dense(o + d * t, 0.0) - 0.5);
        if middle.y >= 0.0 { high = middle; } else { low = middle; }
    }
    return mix(low.x, high.x, low.y / (low.y - high.y));
}

fn dense(p: vec3<f32>, level: f32) -> f32 {
    return textureSampleLevel(density, clamped, p, level).x;
}

// Marble under the sun and the ambient light.
fn lit(p: vec3<f32>) -> color {
    let normal = outward(p);
    let voxel = 1.0 / frame.sun_room.w;
    let sun = color(frame.sun_grid.xyz);
    // A little light goes around the terminator, and through what is thin.
    let facing = max((dot(normal, sun) + part(0.1)) / part(1.1), part(0.0));
    let seen = facing * visibility(p, voxel);
    let thin = part(1.0) - part(dense(p + (frame.sun_grid.xyz * 4.0 - vec3<f32>(normal)) * voxel, 2.0));
    let direct = color(frame.sun_color.xyz) * seen + color(0.20, 0.11, 0.06) * (thin * thin);
    let in_room = (frame.room_from_grid * vec4<f32>(vec3<f32>(normal), 0.0)).xyz;
    let ambient = ambient(color(normalize(in_room))) * open(p, normal, voxel);
    let n = frame.sun_grid.w;
    let grid = (p - 0.5) * (frame.sun_room.w / n) + 0.5;
    let grey = part(textureSampleLevel(marble_texture, clamped, grid, 0.0).x);
    let radiance = mix(color(marble::WHITE), color(marble::GREY), grey) * (direct + ambient);
    return radiance * (radiance * part(0.25) + part(1.0)) / (radiance + part(1.0));
}

// The density's steepest fall, by four samples on a tetrahedron's corners.
fn outward(p: vec3<f32>) -> color {
    let e = vec2<f32>(1.2, -1.2) / frame.sun_room.w;
    let a = part(dense(p + e.xyy, 0.0));
    let b = part(dense(p + e.yyx, 0.0));
    let c = part(dense(p + e.yxy, 0.0));
    let f = part(dense(p + e.xxx, 0.0));
    let fall = color(b + c - a - f, a + b - c - f, a + c - b - f);
    return fall * inverseSqrt(max(dot(fall, fall), part(1e-4)));
}

// Six samples towards the sun, each twice as blurred and as far as two before.
fn visibility(p: vec3<f32>, voxel: f32) -> part {
    let towards = frame.sun_grid.xyz * voxel;
    var visible = part(1.0);
    var far = 2.5;
    for (var level = 0.0; level < 3.0; level += 0.5) {
        visible *= part(1.0) - part(0.85) * part(dense(p + towards * far, level));
        far *= 1.6;
    }
    return visible;
}

// How open the point is to the ambient light: what is empty above it, near and far.
fn open(p: vec3<f32>, normal: color, voxel: f32) -> part {
    let up = vec3<f32>(normal) * voxel;
    let near = part(dense(p + up * 3.0, 1.5));
    let far = part(dense(p + up * 9.0, 3.0));
    return (part(1.0) - part(0.5) * near) * (part(1.0) - part(0.8) * far);
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
