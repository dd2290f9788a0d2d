// The light of the studio, and how a display shows it.
#define_import_path paros::light
#import paros::layout::frame

// The ambient light that a surface with this normal of the grid receives, over pi.
fn ambient(n: vec3<f32>) -> vec3<f32> {
    var sum = frame.ambient[0].xyz;
    sum += frame.ambient[1].xyz * n.x + frame.ambient[2].xyz * n.y + frame.ambient[3].xyz * n.z;
    sum += frame.ambient[4].xyz * (n.x * n.y) + frame.ambient[5].xyz * (n.y * n.z);
    sum += frame.ambient[6].xyz * (n.x * n.z) + frame.ambient[7].xyz * (n.x * n.x);
    sum += frame.ambient[8].xyz * (n.y * n.y);
    return max(sum, vec3<f32>(0.0));
}

// Radiance to what a display shows: Reinhard's curve, in which 2 comes out as 1.
fn shown(color: vec3<f32>) -> vec3<f32> {
    return color * (1.0 + color * 0.25) / (1.0 + color);
}

// Two unit vectors across a unit vector and each other (Duff et al. 2017).
fn across(d: vec3<f32>) -> mat2x3<f32> {
    let sign = select(1.0, -1.0, d.z < 0.0);
    let a = -1.0 / (sign + d.z);
    let b = d.x * d.y * a;
    return mat2x3<f32>(
        vec3<f32>(1.0 + sign * d.x * d.x * a, sign * b, -sign * d.x),
        vec3<f32>(b, sign + d.y * d.y * a, -d.y),
    );
}

// A number in 0..1 that differs from pixel to pixel (Jimenez 2014).
fn dither(pixel: vec2<f32>) -> f32 {
    return fract(52.9829189 * fract(dot(floor(pixel), vec2<f32>(0.06711056, 0.00583715))));
}

// A point of the unit circle for a number in 0..1. Sines differ from GPU to GPU, this doesn't.
fn circle(part: f32) -> vec2<f32> {
    let quarter = floor(part * 4.0);
    let t = part * 4.0 - quarter;
    let v = vec2<f32>(1.0 - t * t, 2.0 * t) / (1.0 + t * t);
    let odd = quarter == 1.0 || quarter == 3.0;
    return select(v, vec2<f32>(-v.y, v.x), odd) * select(1.0, -1.0, quarter >= 2.0);
}
