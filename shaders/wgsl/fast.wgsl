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
    // A ray that comes as near as a pixel is drawn in part if it meets no surface; the density rises
    // by about 0.3 a voxel.
    let margin = 0.3 * frame.sun_color.w;
    var level = part(select(0.5, max(0.5 - margin * start, 0.4), COVERAGE));
    var rim = -1.0;
    var t = start;
    var full = part(0.0);
    var before = part(0.0);
    loop {
        while t < end {
            // Four voxels near the surface.
            let until = min(t + 4.0 * voxel, end);
            while t < until {
                full = part(dense(o + direction * t, 0.0));
                if full >= level { break; }
                before = full;
                t += f32(step(full)) * voxel;
            }
            if full >= level { break; }
            // Empty cells.
            while t < end {
                let free = textureSampleLevel(cells, nearest, o + direction * t, 0.0).x;
                if free == 0.0 { break; }
                t += free * frame.cells.x * voxel;
            }
        }
        if !COVERAGE || full < level || full >= part(0.5) { break; }
        // The nearest so far: on, to what is behind or nearer still.
        rim = t;
        level = full + part(0.004);
        before = full;
        t += f32(step(full)) * voxel;
    }
    var coverage = part(1.0);
    if full >= part(0.5) {
        // Back to where the density is a half, by false position twice.
        let length = f32(step(before)) * voxel;
        let near = f32(before) - 0.5;
        let far = f32(full) - 0.5;
        let first = length * far / (far - near);
        let middle = dense(o + direction * (t - first), 0.0) - 0.5;
        let outer = vec2<f32>(length, near);
        let inner = select(vec2<f32>(0.0, far), vec2<f32>(first, middle), middle >= 0.0);
        let outside = select(vec2<f32>(first, middle), outer, middle >= 0.0);
        t -= mix(inner.x, outside.x, inner.y / max(inner.y - outside.y, 1e-4));
    } else {
        if !COVERAGE || rim < 0.0 {
            discard;
        }
        t = rim;
        coverage -= part(saturate((0.504 - f32(level)) / (margin * t)));
    }
    let p = o + direction * t;
    let fall = fall(p);
    let normal = fall * inverseSqrt(max(dot(fall, fall), part(1e-4)));
    let depth = frame.depth.x / t + frame.depth.y;
    return Shaded(vec4<f32>(vec3<f32>(lit(p, normal)), f32(coverage)), depth);
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
    var sum = color(0.0);
    // Both signs of y with both of z, and x their product.
    for (var i = part(-1.5); i < part(2.0); i += part(1.0)) {
        let y = sign(i);
        let z = part(2.0) * (i - y);
        let corner = color(y * z, y, z);
        sum -= part(dense(p + vec3<f32>(corner) * voxel, 1.0)) * corner;
    }
    return sum;
}

// Four samples towards the sun, blurred as they are far.
fn visibility(p: vec3<f32>, voxel: f32) -> part {
    var seen = part(1.0);
    var far = 2.3 * voxel;
    for (var level = 0.0; level < 4.0; level += 1.0) {
        seen -= seen * part(0.9) * part(dense(p + frame.sun_grid.xyz * far, level));
        far *= 2.2;
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
