// Ambient light, tone mapping, and the helpers of stochastic sampling.
#define_import_path paros::light
#import paros::layout::frame
#import paros::constants::TONE_WHITE_POINT

// Ambient irradiance over pi for a normal of the grid: a quadratic polynomial of the normal, equivalent to
// bands 0 to 2 of spherical harmonics (Ramamoorthi and Hanrahan 2001).
fn ambient_over_pi(n: vec3<f32>) -> vec3<f32> {
    var sum = frame.ambient[0];
    sum += frame.ambient[1] * n.x + frame.ambient[2] * n.y + frame.ambient[3] * n.z;
    sum += frame.ambient[4] * (n.x * n.y) + frame.ambient[5] * (n.y * n.z);
    sum += frame.ambient[6] * (n.x * n.z) + frame.ambient[7] * (n.x * n.x);
    sum += frame.ambient[8] * (n.y * n.y);
    return max(sum, vec3<f32>(0.0));
}

// Reinhard's tone curve: maps radiance to display intensity, and TONE_WHITE_POINT to 1.
fn tone_map(radiance: vec3<f32>) -> vec3<f32> {
    return radiance * (1.0 + radiance * (1.0 / (TONE_WHITE_POINT * TONE_WHITE_POINT))) / (1.0 + radiance);
}

// Orthonormal basis: two unit vectors at right angles to a unit vector (Duff et al. 2017).
fn tangent_basis(unit_normal: vec3<f32>) -> mat2x3<f32> {
    let d = unit_normal;
    let sign = select(1.0, -1.0, d.z < 0.0);
    let a = -1.0 / (sign + d.z);
    let b = d.x * d.y * a;
    return mat2x3<f32>(
        vec3<f32>(1.0 + sign * d.x * d.x * a, sign * b, -sign * d.x),
        vec3<f32>(b, sign + d.y * d.y * a, -d.y),
    );
}

// Interleaved gradient noise of a pixel, 0 to 1 (Jimenez 2014).
fn pixel_dither(pixel: vec2<f32>) -> f32 {
    return fract(52.9829189 * fract(dot(floor(pixel), vec2<f32>(0.06711056, 0.00583715))));
}

// The unit circle's point at an angle of about `turns`, 0 to 1, by its rational parametrisation for
// each quadrant. Unlike sine and cosine it's the same on every GPU.
fn rational_circle_point(turns: f32) -> vec2<f32> {
    let quarter = floor(turns * 4.0);
    let t = turns * 4.0 - quarter;
    let v = vec2<f32>(1.0 - t * t, 2.0 * t) / (1.0 + t * t);
    let odd = quarter == 1.0 || quarter == 3.0;
    return select(v, vec2<f32>(-v.y, v.x), odd) * select(1.0, -1.0, quarter >= 2.0);
}
