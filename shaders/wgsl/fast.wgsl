// The fast path: ray marching of the blurred density to its level set of a half, gradient normal,
// shading. The twin is `src/twin/fast.rs`.
//
// Coordinates `p` and `o` are those of the density texture, 0 to 1; depths `t` are in voxels.
#import paros::layout::frame
#import paros::constants::{
    BEAM_PIXELS, BINDING_BEAM_STARTS, BINDING_CELLS, BINDING_CLAMPED, BINDING_DENSITY,
    BINDING_GRADIENT, BINDING_MARBLE, BINDING_NEAREST, BINDING_NOISE, BINDING_REPEAT,
    CARRARA_BASE_COLOR, CARRARA_VEIN_COLOR, FAST_AO_HEIGHT, FAST_AO_LEAN, FAST_AO_MAX_DENSITY,
    FAST_AO_SCALE, FAST_CRYSTAL_NOISE, FAST_EDGE_CUBIC, FAST_GLOSS, FAST_GLOSS_SHARPNESS, FAST_REFERENCE_SIDE,
    FAST_ROUGHNESS, FAST_SHADOW_OPACITY, FAST_SHADOW_DISTANCE, FAST_SKIP_INTERVAL, FAST_SPARKLE, FAST_SPARKLE_RIM,
    FAST_STEP_FAR, FAST_STEP_NEAR, FAST_TRANSLUCENCY, FAST_TRANSLUCENCY_DEPTH, FAST_WEAR,
    FAST_WEAR_AT_EDGES, FIGURE_GLOW, FIGURE_LEAST_SHARE, FIGURE_SHARE_RISE, FIGURE_WARMTH, TONE_WHITE_POINT,
}
#import paros::box
#import paros::shadow

// Precision of colours, normals and densities: half where the device has it.
#ifdef HALF
alias real = f16;
alias real2 = vec2<f16>;
alias real3 = vec3<f16>;
alias real4 = vec4<f16>;
#else
alias real = f32;
alias real2 = vec2<f32>;
alias real3 = vec3<f32>;
alias real4 = vec4<f32>;
#endif

// Alpha to coverage: with several samples a pixel, a fragment's coverage is its alpha.
override COVERAGE: bool = false;

// A march that ends at a density above this has met the surface. The constant is less than a half, at which
// the march's loop ends: with an equal number the compiler would hold the loop's result in a register. A
// march whose steps run out at a density between the two has met the surface, too.
const ALMOST_HALF: f32 = 0.4998;

// Greatest rise of density in half a pixel: walls of two voxels are not denser than 5/8.
const MOST_RISE: f32 = 0.12;

@group(0) @binding(BINDING_DENSITY) var density: texture_3d<f32>;
@group(0) @binding(BINDING_GRADIENT) var gradient: texture_3d<f32>;
@group(0) @binding(BINDING_CELLS) var cells: texture_3d<f32>;
@group(0) @binding(BINDING_MARBLE) var marble_and_figure: texture_3d<f32>;
@group(0) @binding(BINDING_NOISE) var noise: texture_3d<f32>;
@group(0) @binding(BINDING_CLAMPED) var clamped: sampler;
@group(0) @binding(BINDING_NEAREST) var nearest: sampler;
@group(0) @binding(BINDING_REPEAT) var repeat: sampler;
@group(0) @binding(BINDING_BEAM_STARTS) var beams: texture_2d_array<f32>;

struct FragmentOutput {
    @location(0) color: vec4<f32>,
    @builtin(frag_depth) depth: f32,
}

@early_depth_test(less_equal)
@fragment
fn fragment(
    @builtin(position) position: vec4<f32>,
    @builtin(view_index) view: u32,
    @location(0) direction: vec3<f32>,
    @location(1) @interpolate(flat) o: vec3<f32>,
) -> FragmentOutput {
    // The depth at which this pixel's beam stopped; negative if the beam misses the surface.
    let start = textureLoad(beams, vec2<u32>(position.xy * (1.0 / f32(BEAM_PIXELS))), view, 0).x;
    // In foveated pictures a fragment is several pixels wide, and edges are softened to its width.
    let width = frame.pixel_width * dpdx(position.x);
    if start < 0.0 {
        discard;
    }
    // The depth in which the ray passes one voxel.
    let voxel = 1.0 / (length(direction) * frame.density_side);
#ifdef FLOOR
    // The variant without a march: two fetches of shading at the beam's end.
    let at = o + direction * start;
    let outward = real4(textureSampleLevel(gradient, clamped, at, 0.0));
    let grey = real(textureSampleLevel(marble_and_figure, clamped, at, 0.0).x);
    let lit = max(dot(outward.xyz, real3(frame.sun_in_grid)), real(0.1));
    let lit_stone = mix(real3(CARRARA_BASE_COLOR), real3(CARRARA_VEIN_COLOR), grey) * lit;
    let floor_depth = frame.depth_scale / start + frame.depth_offset;
    return FragmentOutput(vec4<f32>(vec3<f32>(lit_stone), 1.0), floor_depth);
#else
    let end = ray_end(o, direction);
    let hit = march_density(o, direction, start, end, voxel, width);
    var t = hit.t - f32(hit.back) * voxel;
    var coverage = real(1.0);
    let missed = hit.density <= real(ALMOST_HALF) || hit.t >= end;
    if missed && (!COVERAGE || hit.near_miss == 0.0) {
        discard;
    }
    if COVERAGE {
        // A pixel that the outline passes through is covered in part: by half where the ray only just
        // reaches the surface. Find the ray's densest point in small steps: on from a hit, to half a
        // pixel behind the surface, or back from a near miss.
        var at = select(hit.t, min(hit.near_miss, end), missed);
        let margin = half_pixel_rise(at, width);
        let step = select(0.8, -0.8, missed) * voxel;
        var densest = select(hit.density, real(0.0), missed);
        for (var left = real(12.0); left > real(0.0); left -= real(1.0)) {
            if densest >= real(0.5) + margin { break; }
            at += step;
            let here = real(sample_density(o + direction * at, 0.0));
            if here > densest {
                densest = here;
                if missed {
                    t = at;
                }
            }
        }
        coverage = saturate((densest - real(0.5)) / (real(2.0) * margin) + real(0.5));
    }
    let p = o + direction * t;
    let stored = real4(textureSampleLevel(gradient, clamped, p, 0.0));
    let normal = stored.xyz * inverseSqrt(max(dot(stored.xyz, stored.xyz), real(1e-4)));
    let depth = frame.depth_scale / t + frame.depth_offset;
    let color = shade_point(p, normal, stored.w);
    return FragmentOutput(vec4<f32>(vec3<f32>(color), f32(coverage)), depth);
#endif
}

// The end of a march: the first sample of density a half or more, or the ray's end.
struct DensityHit {
    t: f32,
    density: real,
    // Distance back along the ray to the level set of a half, in voxels.
    back: real,
    // A depth shortly after the ray last passed the surface within half a pixel; 0 if it never did.
    near_miss: f32,
}

// Ray marching with steps by density near the surface, and empty-space skipping by the cells'
// Chebyshev distances elsewhere.
fn march_density(
    o: vec3<f32>,
    d: vec3<f32>,
    start: f32,
    end: f32,
    voxel: f32,
    pixel_width: f32,
) -> DensityHit {
    var t = start;
    var full = real(0.0);
    var reach = real(FAST_STEP_FAR.x);
    var near_miss = 0.0;
    while t < end {
        // Steps by density.
        var peak = real(0.0);
        for (var left = real(FAST_SKIP_INTERVAL); left > real(0.0); left -= interval_spent(reach)) {
            full = real(sample_density(o + d * t, 0.0));
            if full >= real(0.5) { break; }
            if COVERAGE {
                peak = max(peak, full);
            }
            reach = overshooting_step_voxels(full);
            t += f32(reach) * voxel;
        }
        if full > real(ALMOST_HALF) { break; }
        if COVERAGE && peak > real(0.5) - half_pixel_rise(t, pixel_width) {
            near_miss = t;
        }
        // Empty-space skipping.
        while t < end {
            let free = textureSampleLevel(cells, nearest, o + d * t, 0.0).x;
            if free == 0.0 { break; }
            t += free * frame.cell_reach * voxel;
        }
    }
    // The sample before the last: `overshooting_step_voxels` inverted.
    let before = max(
        (real(FAST_STEP_FAR.x) - reach) * real(1.0 / FAST_STEP_FAR.y),
        (real(FAST_STEP_NEAR.x) - reach) * real(1.0 / FAST_STEP_NEAR.y),
    );
    // Linear interpolation between both samples, by their distances to a plane of that density.
    let inside = edge_distance(full - real(0.5));
    // Along a surface both densities may be close to a half; rounding must not make their distance zero.
    let outside = max(edge_distance(real(0.5) - before), real(0.001));
    return DensityHit(t, full, reach * inside / (inside + outside), near_miss);
}

// The part of FAST_SKIP_INTERVAL that a step uses up: its length in voxels. In half precision, on devices
// with few registers, each step counts as one voxel.
fn interval_spent(reach: real) -> real {
#ifdef HALF
    return real(1.0);
#else
    return reach;
#endif
}

// The rise of the density towards the surface in half a pixel of this width, at a depth: about 0.3 a voxel.
fn half_pixel_rise(t: f32, pixel_width: f32) -> real {
    return real(min(0.15 * pixel_width * t, MOST_RISE));
}

// Distance to a plane, up to a factor, from its blurred density less a half.
fn edge_distance(excess: real) -> real {
    return excess + real(FAST_EDGE_CUBIC) * excess * excess * excess;
}

// The march's step at a density, in voxels. The step ends a little behind a plane of that density, but
// can't step over a wall one voxel thick.
fn overshooting_step_voxels(density_here: real) -> real {
    return max(
        real(FAST_STEP_FAR.x) - density_here * real(FAST_STEP_FAR.y),
        real(FAST_STEP_NEAR.x) - density_here * real(FAST_STEP_NEAR.y),
    );
}

// The depth where a ray leaves the grid's box, one voxel larger except at the ground.
fn ray_end(o: vec3<f32>, d: vec3<f32>) -> f32 {
    let side = frame.density_side;
    let pad = 0.5 * (side - frame.grid_side);
    let low = vec3<f32>(pad - 1.0, pad, pad - 1.0) / side;
    return box::exit_depth(o, d, low, vec3<f32>(1.0 - low.x));
}

// Trilinear sample of a mip level, 0 to 1.
fn sample_density(p: vec3<f32>, mip_level: f32) -> f32 {
    return textureSampleLevel(density, clamped, p, mip_level).x;
}

// The mip level of the sample above the surface: the same size in the stone at either size of the grid.
fn level_above() -> f32 {
    return select(2.0, 3.0, frame.grid_side > FAST_REFERENCE_SIDE);
}

// Marble under the sun and the ambient light, tone mapped.
fn shade_point(p: vec3<f32>, normal: real3, convexity: real) -> real3 {
    let n = frame.grid_side;
    let voxel = n / (FAST_REFERENCE_SIDE * frame.density_side);
    let facing = dot(normal, real3(frame.sun_in_grid));
    // The part of the sunlight that comes from its side, or through the stone.
    var lit = real(0.0);
    var gloss = real(0.0);
    if facing > real(0.0) {
        lit = sun_visibility(p, voxel);
        gloss = highlight(p, normal, convexity);
    } else {
        // Translucency where the stone is thin towards the sun.
        let through = p + (frame.sun_in_grid * FAST_TRANSLUCENCY_DEPTH - vec3<f32>(normal)) * voxel;
        lit = real(1.0) - real(sample_density(through, level_above()));
    }
    // Density above the surface, shifted towards the sun the more the surface faces the sun. It hides the
    // sky, and blocks the sun as well. Sampled after the branch, where fewer registers are held.
    let lean = FAST_AO_LEAN * f32(max(facing, real(0.0)));
    let offset = vec3<f32>(normal) * FAST_AO_HEIGHT + frame.sun_in_grid * lean;
    let above = real(sample_density(p + offset * voxel, level_above()));
    let clear = lit - lit * real(FAST_SHADOW_OPACITY) * above;
    gloss *= clear;
    let shade = real3(FAST_TRANSLUCENCY) * (lit * -facing);
    let direct = real3(frame.sun_color) * select(shade, real3(facing * clear), facing > real(0.0));
    // Ambient occlusion: the factor of the ambient light.
    let open = real(FAST_AO_SCALE) - real(FAST_AO_SCALE) * min(above, real(FAST_AO_MAX_DENSITY));
    let around = ambient_over_pi(normal) * open;
    let grid = (p - 0.5) * (frame.density_side / n) + 0.5;
    // The marble's greyness, and the hidden figure's share.
    let marble = real2(textureSampleLevel(marble_and_figure, clamped, grid, 0.0).xy);
    let bared = saturate((marble.y - real(FIGURE_LEAST_SHARE)) * real(FIGURE_SHARE_RISE));
    let stone = mix(real3(CARRARA_BASE_COLOR), real3(CARRARA_VEIN_COLOR), marble.x)
        * (real3(1.0) + real3(FIGURE_WARMTH - 1.0) * bared);
    let worn = real3(1.0) + real3(FAST_WEAR) * min(convexity, real(FAST_WEAR_AT_EDGES));
    let radiance = stone * worn * (direct + around) + real3(frame.sun_color) * gloss
        + real3(FIGURE_GLOW) * bared;
    // `light::tone_map` in this precision.
    return radiance * (radiance * real(1.0 / (TONE_WHITE_POINT * TONE_WHITE_POINT)) + real(1.0))
        / (radiance + real(1.0));
}

// The sun's highlight at a point, as a part of the sunlight: a spherical Gaussian around the
// direction between sun and eye, broad where the stone is rough, with the sparkle of its crystals.
fn highlight(p: vec3<f32>, normal: real3, convexity: real) -> real {
    let roughness = saturate(abs(convexity) * real(FAST_ROUGHNESS));
    let sharpness = mix(real(FAST_GLOSS_SHARPNESS.x), real(FAST_GLOSS_SHARPNESS.y), roughness);
    let toward = dot(normal, real3(frame.halfway_in_grid));
    let lobe = exp2((toward - real(1.0)) * sharpness) * (sharpness * real(FAST_GLOSS));
    let near = toward * max(toward, real(0.0)) - real(FAST_SPARKLE_RIM);
    if near <= real(0.0) {
        return lobe;
    }
    let grain = p * (FAST_CRYSTAL_NOISE.x * frame.density_side / frame.grid_side)
        + frame.halfway_in_grid * FAST_CRYSTAL_NOISE.y;
    let crystal = real(textureSampleLevel(noise, repeat, grain, 0.0).x);
    let sparkle = real(FAST_SPARKLE.y / ((1.0 - FAST_SPARKLE_RIM) * (1.0 - FAST_SPARKLE_RIM)));
    return lobe + max(crystal - real(FAST_SPARKLE.x), real(0.0)) * (sparkle * near * near);
}

// Soft shadow by cone tracing: the second of two samples towards the sun, farther and of a coarser mip level than the
// one above the surface. Times the shadow map's visibility outside the box.
fn sun_visibility(p: vec3<f32>, voxel: f32) -> real {
    let far = real(sample_density(p + frame.sun_in_grid * (FAST_SHADOW_DISTANCE * voxel), 3.0));
    let seen = real(1.0) - real(FAST_SHADOW_OPACITY) * far;
    let grid = (p - 0.5) * frame.density_side + 0.5 * frame.grid_side;
    return seen * real(shadow::visibility_beyond_box(grid));
}

// `light::ambient_over_pi` in this precision.
fn ambient_over_pi(n: real3) -> real3 {
    var sum = real3(frame.ambient[0]);
    sum += real3(frame.ambient[1]) * n.x + real3(frame.ambient[2]) * n.y;
    sum += real3(frame.ambient[3]) * n.z + real3(frame.ambient[4]) * (n.x * n.y);
    sum += real3(frame.ambient[5]) * (n.y * n.z) + real3(frame.ambient[6]) * (n.x * n.z);
    sum += real3(frame.ambient[7]) * (n.x * n.x) + real3(frame.ambient[8]) * (n.y * n.y);
    return max(sum, real3(0.0));
}
