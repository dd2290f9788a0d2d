// Section 4 of the paper: the range maps marched layer by layer, blobs, damped samples to the sun.
#import paros::layout::frame
#import paros::light
#import paros::marble
#import paros::box
#import paros::shadow

override FULL_MARCH: bool = false;
override SDF: bool = true;
override SHADING: bool = true;

// A layer an axis, with a border of empty columns: (place, line) -> complemented low end, high end.
@group(0) @binding(1) var maps: texture_2d_array<u32>;
@group(0) @binding(4) var noise: texture_3d<f32>;
@group(0) @binding(9) var repeat: sampler;

// Fixed point: one voxel.
const ONE: f32 = 65536.0;
const BITS: vec2<u32> = vec2<u32>(16u);

struct Shaded {
    @location(0) color: vec4<f32>,
    @builtin(frag_depth) depth: f32,
}

struct Sample {
    voxel: vec3<i32>,
    // Along the ray; negative if nothing was hit.
    t: f32,
}

struct Surface {
    // From the hit voxel's centre.
    offset: vec3<f32>,
    normal: vec3<f32>,
    t: f32,
}

@early_depth_test(less_equal)
@fragment
fn fragment(
    @builtin(position) position: vec4<f32>,
    @location(0) direction: vec3<f32>,
    @location(1) @interpolate(flat) eye: vec3<f32>,
) -> Shaded {
    let span = box::span(eye, direction, vec3<f32>(0.0), vec3<f32>(frame.sun_grid.w));
    let hit = march(eye, direction, span);
    if hit.t < 0.0 {
        discard;
    }
    let centre = vec3<f32>(hit.voxel) + 0.5;
    var at: Surface;
    if SDF {
        at = blobs(eye - centre, direction, hit);
    } else {
        at = face(eye - centre, direction);
    }
    var color: vec3<f32>;
    if SHADING {
        color = light::shown(lit(centre + at.offset, at.normal, light::dither(position.xy)));
    } else {
        let normal = (frame.room_from_grid * vec4<f32>(at.normal, 0.0)).xyz / frame.depth.w;
        color = normal * 0.5 + 0.5;
    }
    return Shaded(vec4<f32>(color, 1.0), frame.depth.x * frame.depth.w * position.w / at.t + frame.depth.y);
}

// Section 4.1: one fetch a layer of the axis most parallel to the ray, at the layer's centre; the
// other two maps only where that one holds the sample.
fn march(eye: vec3<f32>, direction: vec3<f32>, span: vec2<f32>) -> Sample {
    // The ray in the dominant axis's own order: (place, line, layer).
    let size = abs(direction);
    let is_x = size.x >= size.y && size.x >= size.z;
    let is_y = !is_x && size.y >= size.z;
    let axis = select(select(2, 1, is_y), 0, is_x);
    let o = select(select(eye, eye.xzy, is_y), eye.zyx, is_x);
    let d = select(select(direction, direction.xzy, is_y), direction.zyx, is_x);

    let n = i32(frame.sun_grid.w);
    let step = select(-1, 1, d.z > 0.0);
    var w = clamp(i32(o.z + d.z * span.x), 0, n - 1);
    let each = 1.0 / abs(d.z);
    var t = (f32(w) + 0.5 - o.z) / d.z;
    if t < span.x {
        w += step;
        t += each;
    }
    // The layers left whose centres lie before the far side.
    let layers = select(w + 1, n - w, step > 0);
    let end = w + step * clamp(i32(ceil((span.y - t) / each)), 0, layers);
    var place = vec2<i32>((o.xy + d.xy * t + 1.0) * ONE);
    let slide = vec2<i32>(d.xy * (each * ONE));
    if FULL_MARCH {
        return march_all(eye, direction, t, each, (end - w) * step);
    }
    let begin = w;
    while w != end {
        let column = place >> BITS;
        let range = textureLoad(maps, column, axis, 0).xy;
        if u32(w) <= range.y && u32(w) + range.x >= 255u {
            let voxel = unordered(column, w, axis);
            if others_hold(voxel, axis) {
                return Sample(voxel, t + each * f32(abs(w - begin)));
            }
        }
        place += slide;
        w += step;
    }
    return Sample(vec3<i32>(0), -1.0);
}

// The experiment of section 5: every map is asked on every layer, until one says no.
fn march_all(eye: vec3<f32>, direction: vec3<f32>, t: f32, each: f32, layers: i32) -> Sample {
    var place = vec3<i32>((eye + direction * t + 1.0) * ONE);
    let slide = vec3<i32>(direction * (each * ONE));
    for (var i = 0; i < layers; i++) {
        let voxel = (place >> BITS.xxx) - 1;
        if all_hold(voxel) {
            return Sample(voxel, t + each * f32(i));
        }
        place += slide;
    }
    return Sample(vec3<i32>(0), -1.0);
}

// The voxel of a layer of an axis, in the texture's column.
fn unordered(column: vec2<i32>, w: i32, axis: i32) -> vec3<i32> {
    let p = vec3<i32>(column - 1, w);
    return select(select(p, p.xzy, axis == 1), p.zyx, axis == 0);
}

fn holds(column: vec2<i32>, axis: i32, i: i32) -> bool {
    let range = textureLoad(maps, column + 1, axis, 0).xy;
    return u32(i) <= range.y && u32(i) + range.x >= 255u;
}

// Drivers leave a chain of conditions in one piece, and fetch from all three.
fn all_hold(v: vec3<i32>) -> bool {
    if holds(v.zy, 0, v.x) {
        if holds(v.xz, 1, v.y) {
            return holds(v.xy, 2, v.z);
        }
    }
    return false;
}

fn others_hold(v: vec3<i32>, axis: i32) -> bool {
    let next = select(axis + 1, 0, axis == 2);
    let last = select(axis - 1, 2, axis == 0);
    return along(v, next) && along(v, last);
}

fn along(v: vec3<i32>, axis: i32) -> bool {
    let column = select(select(v.xy, v.xz, axis == 1), v.zy, axis == 0);
    return holds(column, axis, select(select(v.z, v.y, axis == 1), v.x, axis == 0));
}

fn held(v: vec3<i32>) -> bool {
    let a = textureLoad(maps, v.zy + 1, 0, 0).xy;
    let b = textureLoad(maps, v.xz + 1, 1, 0).xy;
    let c = textureLoad(maps, v.xy + 1, 2, 0).xy;
    let u = vec3<u32>(v);
    let high = vec3<u32>(a.y, b.y, c.y);
    let low = vec3<u32>(a.x, b.x, c.x);
    return all(u <= high) && all(u + low >= vec3<u32>(255u));
}

fn occupied(point: vec3<f32>) -> bool {
    let n = frame.sun_grid.w;
    if any(point < vec3<f32>(0.0)) || any(point >= vec3<f32>(n)) {
        return false;
    }
    return held(vec3<i32>(point));
}

// Section 4.2, after Hart (1995): the smooth union of the blobs of the hit voxel and its occupied
// neighbours, sphere traced from half a voxel before the sample.
fn blobs(eye: vec3<f32>, direction: vec3<f32>, hit: Sample) -> Surface {
    let around = neighbours(hit.voxel);
    let speed = length(direction);
    let unit = direction / speed;
    var t = hit.t * speed - 0.5;
    var closest = t;
    var gap = 1e9;
    for (var i = 0u; i < 8u; i++) {
        let d = distance_to(eye + t * unit, around);
        if abs(d) < gap {
            closest = t;
            gap = abs(d);
        }
        if gap < 0.01 {
            break;
        }
        t += d;
    }
    let offset = eye + closest * unit;
    return Surface(offset, equation_one(offset, around), closest / speed);
}

// One if occupied: -x, -y, -z and +x, +y, +z.
struct Neighbours {
    low: vec3<f32>,
    high: vec3<f32>,
}

fn neighbours(v: vec3<i32>) -> Neighbours {
    let e = vec2<i32>(1, 0);
    return Neighbours(
        vec3<f32>(f32(held(v - e.xyy)), f32(held(v - e.yxy)), f32(held(v - e.yyx))),
        vec3<f32>(f32(held(v + e.xyy)), f32(held(v + e.yxy)), f32(held(v + e.yyx))),
    );
}

fn distance_to(p: vec3<f32>, around: Neighbours) -> f32 {
    const BLEND: f32 = 0.3;
    // exp(x / BLEND) as a power of two.
    const SHARP: f32 = 4.8089835;
    let square = dot(p, p);
    let low = exp2((0.5 - sqrt(max(square + 1.0 + 2.0 * p, vec3<f32>(0.0)))) * SHARP);
    let high = exp2((0.5 - sqrt(max(square + 1.0 - 2.0 * p, vec3<f32>(0.0)))) * SHARP);
    let sum = exp2((0.5 - sqrt(square)) * SHARP) + dot(low, around.low) + dot(high, around.high);
    return -log2(sum) / SHARP;
}

// Equation 1, after Shepard (1968).
fn equation_one(p: vec3<f32>, around: Neighbours) -> vec3<f32> {
    let square = dot(p, p);
    let low = around.low / max(square + 1.0 + 2.0 * p, vec3<f32>(1e-6));
    let high = around.high / max(square + 1.0 - 2.0 * p, vec3<f32>(1e-6));
    let sum = p * (dot(low, vec3<f32>(1.0)) + dot(high, vec3<f32>(1.0))) + low - high;
    let alone = dot(sum, sum) < 1e-12;
    return normalize(select(sum, p + vec3<f32>(0.0, 1e-9, 0.0), alone));
}

// The face through which the ray enters the voxel.
fn face(eye: vec3<f32>, direction: vec3<f32>) -> Surface {
    let towards = sign(direction);
    let entry = select((-0.5 * towards - eye) / direction, vec3<f32>(-1e9), direction == vec3<f32>(0.0));
    let t = max(entry.x, max(entry.y, entry.z));
    let first = vec3<bool>(entry.x == t, entry.y == t && entry.x != t, entry.z == t && entry.x != t && entry.y != t);
    return Surface(eye + t * direction, select(vec3<f32>(0.0), -towards, first), t);
}

// Section 4.3: Lambertian marble under the sun and the ambient light.
fn lit(point: vec3<f32>, normal: vec3<f32>, dither: f32) -> vec3<f32> {
    let facing = dot(normal, frame.sun_grid.xyz);
    var direct = 0.0;
    if facing > 0.0 {
        direct = facing * visibility(point, dither);
    }
    let radiance = frame.sun_color.xyz * direct + light::ambient(normal);
    return marble::reflectance(noise, repeat, point / frame.sun_grid.w) * radiance;
}

// Ten samples to the box's surface, each damping the light where it is occupied, dispersed in a
// cone that is wide at the point; the shadow map tells of the rest of the way.
fn visibility(point: vec3<f32>, dither: f32) -> f32 {
    const SAMPLES: f32 = 10.0;
    let towards = frame.sun_grid.xyz;
    let way = box::span(point, towards, vec3<f32>(0.0), vec3<f32>(frame.sun_grid.w));
    if way.x >= way.y {
        return 1.0;
    }
    let length = way.y;
    let axes = light::across(towards);
    var turn = light::circle(dither);
    var visible = 1.0;
    var order = 0.0;
    for (var i = 0.0; i < SAMPLES; i += 1.0) {
        let part = (i + 0.5) / SAMPLES;
        let radius = (2.0 - 1.75 * part) * sqrt((order + 0.5) / SAMPLES);
        if occupied(point + towards * (part * length) + axes * (turn * radius)) {
            visible *= 0.7;
        }
        order += 7.0;
        order -= select(0.0, SAMPLES, order >= SAMPLES);
        turn = mat2x2<f32>(-0.7373689, 0.6754903, -0.6754903, -0.7373689) * turn;
    }
    return visible * shadow::beyond(point);
}
