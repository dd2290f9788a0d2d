// The paper's path (section 4): ray marching of the range maps, sphere traced blobs, a sampled
// shadow ray. The twin is `src/twin/fragment.rs`.
#import paros::layout::frame
#import paros::constants::{
    BINDING_MAPS, BINDING_NOISE, BINDING_REPEAT, BLOB_HIT_DISTANCE, BLOB_MAX_STEPS, BLOB_RADIUS,
    BLOB_SHARPNESS, BLOB_START_BACK, GOLDEN_ANGLE_COS_SIN, MAP_BORDER_COLUMNS,
    MARCH_FRACTION_BITS, SHADOW_DAMPING, SHADOW_DISC_STRIDE, SHADOW_RADIUS_FAR,
    SHADOW_RADIUS_NEAR, SHADOW_SAMPLES,
}
#import paros::light
#import paros::marble
#import paros::box
#import paros::shadow

override FULL_MARCH: bool = false;
override SDF: bool = true;
override SHADING: bool = true;

// A layer for each axis, with a border of empty columns. The texel of a column, at (place, line),
// holds 255 less the first voxel of its range, and the last one, 0 and 0 of an empty range. With
// TWO_INTERVALS it is one word of four bytes, lowest first: these two, and those of a second range.
@group(0) @binding(BINDING_MAPS) var maps: texture_2d_array<u32>;
@group(0) @binding(BINDING_NOISE) var noise: texture_3d<f32>;
@group(0) @binding(BINDING_REPEAT) var repeat: sampler;

// Fixed point coordinates: one voxel.
const ONE_VOXEL: f32 = f32(1u << MARCH_FRACTION_BITS);
const FRACTION_BITS: vec2<u32> = vec2<u32>(MARCH_FRACTION_BITS);
// Empty columns around each map.
const BORDER: i32 = i32(MAP_BORDER_COLUMNS);

struct FragmentOutput {
    @location(0) color: vec4<f32>,
    @builtin(frag_depth) depth: f32,
}

struct VoxelHit {
    voxel: vec3<i32>,
    // The ray's parameter; negative if nothing was hit.
    t: f32,
}

struct SurfacePoint {
    // From the hit voxel's centre, in voxels.
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
) -> FragmentOutput {
    let span = box::clip_ray(eye, direction, vec3<f32>(0.0), vec3<f32>(frame.grid_side));
    let hit = march_maps(eye, direction, span);
    if hit.t < 0.0 {
        discard;
    }
    let centre = vec3<f32>(hit.voxel) + 0.5;
    var at: SurfacePoint;
    if SDF {
        at = trace_blobs_or_closest_approach(eye - centre, direction, hit);
    } else {
        at = entry_face_point(eye - centre, direction);
    }
    var color: vec3<f32>;
    if SHADING {
        color = light::tone_map(
            shade_point(centre + at.offset, at.normal, light::pixel_dither(position.xy)),
        );
    } else {
        let normal = (frame.room_from_grid * vec4<f32>(at.normal, 0.0)).xyz / frame.voxel_size;
        color = normal * 0.5 + 0.5;
    }
    let depth = frame.depth_scale * frame.voxel_size * position.w / at.t + frame.depth_offset;
    return FragmentOutput(vec4<f32>(color, 1.0), depth);
}

// Ray marching of the range maps (section 4.1): one fetch a voxel layer of the ray's dominant axis, at the
// layer's centre. The other two maps are fetched only if that map holds the sample.
fn march_maps(eye: vec3<f32>, direction: vec3<f32>, span: vec2<f32>) -> VoxelHit {
    // The ray with its components permuted to (place, line, layer) of the dominant axis.
    let size = abs(direction);
    let is_x = size.x >= size.y && size.x >= size.z;
    let is_y = !is_x && size.y >= size.z;
    let axis = select(select(2, 1, is_y), 0, is_x);
    let o = select(select(eye, eye.xzy, is_y), eye.zyx, is_x);
    let d = select(select(direction, direction.xzy, is_y), direction.zyx, is_x);

    let n = i32(frame.grid_side);
    let step = select(-1, 1, d.z > 0.0);
    var w = clamp(i32(o.z + d.z * span.x), 0, n - 1);
    let layer_step = 1.0 / abs(d.z);
    var t = (f32(w) + 0.5 - o.z) / d.z;
    if t < span.x {
        w += step;
        t += layer_step;
    }
    // Layers left in the grid whose centres lie before the far side.
    let layers = select(w + 1, n - w, step > 0);
    let end = w + step * clamp(i32(ceil((span.y - t) / layer_step)), 0, layers);
    var place = vec2<i32>((o.xy + d.xy * t + f32(MAP_BORDER_COLUMNS)) * ONE_VOXEL);
    let place_step = vec2<i32>(d.xy * (layer_step * ONE_VOXEL));
    if FULL_MARCH {
        return march_all_maps(eye, direction, t, layer_step, (end - w) * step);
    }
    let end_key = key_of_voxel(end);
    let key_step = key_of_voxel(step) - key_of_voxel(0);
    var key = key_of_voxel(w);
    while key != end_key {
        let column = place >> FRACTION_BITS;
        if column_holds(textureLoad(maps, column, axis, 0), key) {
            let layer = voxel_of_key(key);
            let voxel = voxel_of_layer(column, layer, axis);
            if other_maps_hold(voxel, axis) {
                return VoxelHit(voxel, t + layer_step * f32(abs(layer - w)));
            }
        }
        place += place_step;
        key += key_step;
    }
    return VoxelHit(vec3<i32>(0), -1.0);
}

// The baseline of section 5: fetches the maps in turn on every layer, until one doesn't hold it.
fn march_all_maps(eye: vec3<f32>, direction: vec3<f32>, t: f32, layer_step: f32, layers: i32) -> VoxelHit {
    var place = vec3<i32>((eye + direction * t + f32(MAP_BORDER_COLUMNS)) * ONE_VOXEL);
    let place_step = vec3<i32>(direction * (layer_step * ONE_VOXEL));
    for (var i = 0; i < layers; i++) {
        let voxel = (place >> FRACTION_BITS.xxx) - BORDER;
        if all_maps_hold(voxel) {
            return VoxelHit(voxel, t + layer_step * f32(i));
        }
        place += place_step;
    }
    return VoxelHit(vec3<i32>(0), -1.0);
}

// The voxel at a texture column and a layer of an axis.
fn voxel_of_layer(column: vec2<i32>, w: i32, axis: i32) -> vec3<i32> {
    let p = vec3<i32>(column - BORDER, w);
    return select(select(p, p.xzy, axis == 1), p.zyx, axis == 0);
}

fn map_holds(column: vec2<i32>, axis: i32, i: i32) -> bool {
    return column_holds(textureLoad(maps, column + BORDER, axis, 0), key_of_voxel(i));
}

#ifdef TWO_INTERVALS

// A voxel's number plus 1 in either half of a word, to compare it with both ranges of a column at once.
fn key_of_voxel(i: i32) -> u32 {
    let number = u32(i + 1);
    return number | (number << 16u);
}

fn voxel_of_key(key: u32) -> i32 {
    return i32(key & 0xffffu) - 1;
}

// `true` if a voxel is in one of a column's ranges. In either half, `first` comes to 256 or more if the
// half's range begins at the voxel or before it, `last` if the range ends at the voxel or behind it. Only
// at voxel 256, outside the grid, `first` may come to 512, which lacks that bit.
fn column_holds(texel: vec4<u32>, key: u32) -> bool {
    let first = (texel.x & 0xff00ffu) + key;
    let last = (texel.x >> 8u & 0xff00ffu) + (0x1010101u - key);
    return (first & last & 0x1000100u) != 0u;
}

#else

fn key_of_voxel(i: i32) -> u32 {
    return u32(i);
}

fn voxel_of_key(key: u32) -> i32 {
    return i32(key);
}

// `true` if a voxel is in the column's range.
fn column_holds(texel: vec4<u32>, key: u32) -> bool {
    return key <= texel.y && key + texel.x >= 255u;
}

#endif

// Nested, since drivers evaluate a chain of `&&` without branches, with all three fetches.
fn all_maps_hold(v: vec3<i32>) -> bool {
    if map_holds(v.zy, 0, v.x) {
        if map_holds(v.xz, 1, v.y) {
            return map_holds(v.xy, 2, v.z);
        }
    }
    return false;
}

fn other_maps_hold(v: vec3<i32>, axis: i32) -> bool {
    let next = select(axis + 1, 0, axis == 2);
    let last = select(axis - 1, 2, axis == 0);
    return axis_map_holds(v, next) && axis_map_holds(v, last);
}

fn axis_map_holds(v: vec3<i32>, axis: i32) -> bool {
    let column = select(select(v.xy, v.xz, axis == 1), v.zy, axis == 0);
    return map_holds(column, axis, select(select(v.z, v.y, axis == 1), v.x, axis == 0));
}

fn is_voxel_occupied(v: vec3<i32>) -> bool {
    let a = textureLoad(maps, v.zy + BORDER, 0, 0);
    let b = textureLoad(maps, v.xz + BORDER, 1, 0);
    let c = textureLoad(maps, v.xy + BORDER, 2, 0);
#ifdef TWO_INTERVALS
    return column_holds(a, key_of_voxel(v.x)) & column_holds(b, key_of_voxel(v.y))
        & column_holds(c, key_of_voxel(v.z));
#else
    let u = vec3<u32>(v);
    let high = vec3<u32>(a.y, b.y, c.y);
    let low = vec3<u32>(a.x, b.x, c.x);
    return all(u <= high) && all(u + low >= vec3<u32>(255u));
#endif
}

fn is_point_occupied(point: vec3<f32>) -> bool {
    let n = frame.grid_side;
    if any(point < vec3<f32>(0.0)) || any(point >= vec3<f32>(n)) {
        return false;
    }
    return is_voxel_occupied(vec3<i32>(point));
}

// Sphere tracing (Hart 1995) of the smooth union of the hit voxel's blob and its occupied
// neighbours', from half a voxel before the sample (section 4.2). If the ray misses, its closest
// point is taken.
fn trace_blobs_or_closest_approach(eye: vec3<f32>, direction: vec3<f32>, hit: VoxelHit) -> SurfacePoint {
    let around = find_neighbours(hit.voxel);
    let speed = length(direction);
    let unit = direction / speed;
    var t = hit.t * speed - BLOB_START_BACK;
    var closest = t;
    var gap = 1e9;
    for (var i = 0u; i < BLOB_MAX_STEPS; i++) {
        let d = blob_distance(eye + t * unit, around);
        if abs(d) < gap {
            closest = t;
            gap = abs(d);
        }
        if gap < BLOB_HIT_DISTANCE {
            break;
        }
        t += d;
    }
    let offset = eye + closest * unit;
    return SurfacePoint(offset, shepard_normal(offset, around), closest / speed);
}

// The six face neighbours, 1 where occupied: -x, -y, -z and +x, +y, +z.
struct Neighbours {
    low: vec3<f32>,
    high: vec3<f32>,
}

fn find_neighbours(v: vec3<i32>) -> Neighbours {
#ifdef TWO_INTERVALS
    // One side after the other: both at once take twice the registers.
    var low: vec3<f32>;
    var high: vec3<f32>;
    for (var side = -1; side <= 1; side += 2) {
        low = high;
        high = vec3<f32>(
            f32(is_voxel_occupied(v + vec3<i32>(side, 0, 0))),
            f32(is_voxel_occupied(v + vec3<i32>(0, side, 0))),
            f32(is_voxel_occupied(v + vec3<i32>(0, 0, side))),
        );
    }
    return Neighbours(low, high);
#else
    let e = vec2<i32>(1, 0);
    return Neighbours(
        vec3<f32>(
            f32(is_voxel_occupied(v - e.xyy)),
            f32(is_voxel_occupied(v - e.yxy)),
            f32(is_voxel_occupied(v - e.yyx)),
        ),
        vec3<f32>(
            f32(is_voxel_occupied(v + e.xyy)),
            f32(is_voxel_occupied(v + e.yxy)),
            f32(is_voxel_occupied(v + e.yyx)),
        ),
    );
#endif
}

fn blob_distance(p: vec3<f32>, around: Neighbours) -> f32 {
    let square = dot(p, p);
    let low = exp2((BLOB_RADIUS - sqrt(max(square + 1.0 + 2.0 * p, vec3<f32>(0.0)))) * BLOB_SHARPNESS);
    let high = exp2((BLOB_RADIUS - sqrt(max(square + 1.0 - 2.0 * p, vec3<f32>(0.0)))) * BLOB_SHARPNESS);
    let sum = exp2((BLOB_RADIUS - sqrt(square)) * BLOB_SHARPNESS)
        + dot(low, around.low) + dot(high, around.high);
    return -log2(sum) / BLOB_SHARPNESS;
}

// The normal of equation 1: directions from the occupied neighbours, by inverse square distance
// weighting (Shepard 1968).
fn shepard_normal(p: vec3<f32>, around: Neighbours) -> vec3<f32> {
    let square = dot(p, p);
    let low = around.low / max(square + 1.0 + 2.0 * p, vec3<f32>(1e-6));
    let high = around.high / max(square + 1.0 - 2.0 * p, vec3<f32>(1e-6));
    let sum = p * (dot(low, vec3<f32>(1.0)) + dot(high, vec3<f32>(1.0))) + low - high;
    let alone = dot(sum, sum) < 1e-12;
    return normalize(select(sum, p + vec3<f32>(0.0, 1e-9, 0.0), alone));
}

// The point where the ray enters the voxel, with the normal of that face, without the blobs.
fn entry_face_point(eye: vec3<f32>, direction: vec3<f32>) -> SurfacePoint {
    let towards = sign(direction);
    let entry = select((-0.5 * towards - eye) / direction, vec3<f32>(-1e9), direction == vec3<f32>(0.0));
    let t = max(entry.x, max(entry.y, entry.z));
    let first = vec3<bool>(
        entry.x == t,
        entry.y == t && entry.x != t,
        entry.z == t && entry.x != t && entry.y != t,
    );
    return SurfacePoint(eye + t * direction, select(vec3<f32>(0.0), -towards, first), t);
}

// Lambertian marble under the sun and the ambient light (section 4.3).
fn shade_point(point: vec3<f32>, normal: vec3<f32>, dither: f32) -> vec3<f32> {
    let facing = dot(normal, frame.sun_in_grid);
    var direct = 0.0;
    if facing > 0.0 {
        direct = facing * sun_visibility(point, dither);
    }
    let radiance = frame.sun_color * direct + light::ambient_over_pi(normal);
    return marble::reflectance(noise, repeat, point / frame.grid_side) * radiance;
}

// Stochastic soft shadow (section 4.3): ten samples up to the box's border, dispersed in a cone
// that is wide at the point, each damping the light where it's occupied; the shadow map has the
// rest.
fn sun_visibility(point: vec3<f32>, dither: f32) -> f32 {
    const SAMPLES: f32 = f32(SHADOW_SAMPLES);
    let towards = frame.sun_in_grid;
    let way = box::clip_ray(point, towards, vec3<f32>(0.0), vec3<f32>(frame.grid_side));
    if way.x >= way.y {
        return 1.0;
    }
    let length = way.y;
    let axes = light::tangent_basis(towards);
    var turn = light::rational_circle_point(dither);
    var visible = 1.0;
    var ring = 0.0;
    for (var i = 0.0; i < SAMPLES; i += 1.0) {
        let fraction = (i + 0.5) / SAMPLES;
        let cone = SHADOW_RADIUS_NEAR - (SHADOW_RADIUS_NEAR - SHADOW_RADIUS_FAR) * fraction;
        let radius = cone * sqrt((ring + 0.5) / SAMPLES);
        if is_point_occupied(point + towards * (fraction * length) + axes * (turn * radius)) {
            visible *= SHADOW_DAMPING;
        }
        ring += f32(SHADOW_DISC_STRIDE);
        ring -= select(0.0, SAMPLES, ring >= SAMPLES);
        turn = mat2x2<f32>(
            GOLDEN_ANGLE_COS_SIN.x,
            GOLDEN_ANGLE_COS_SIN.y,
            -GOLDEN_ANGLE_COS_SIN.y,
            GOLDEN_ANGLE_COS_SIN.x,
        ) * turn;
    }
    return visible * shadow::visibility_beyond_box(point);
}
