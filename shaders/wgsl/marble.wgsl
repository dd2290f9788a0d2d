// White marble with grey veins (Perlin 1985). The constants are `constants.rs`'s.
#define_import_path paros::marble

const SCALE: f32 = 2.6;
const BEND: f32 = 2.4;
const VEINS: f32 = 2.2;
const ACROSS: vec3<f32> = vec3<f32>(0.62, 0.55, -0.56);
const WHITE: vec3<f32> = vec3<f32>(0.86, 0.845, 0.82);
const GREY: vec3<f32> = vec3<f32>(0.40, 0.41, 0.44);
// Noise cells along a side of the noise texture.
const CELLS: f32 = 16.0;

// Reflectance at a point of the unit cube, with four octaves of noise.
fn reflectance(noise: texture_3d<f32>, repeat: sampler, point: vec3<f32>) -> vec3<f32> {
    let at = point * (SCALE / CELLS);
    let cloud = textureSampleLevel(noise, repeat, at, 0.0).x;
    let turbulence = 0.5 * cloud
        + 0.25 * textureSampleLevel(noise, repeat, 2.0 * at, 0.0).x
        + 0.125 * textureSampleLevel(noise, repeat, 4.0 * at, 0.0).x
        + 0.0625 * textureSampleLevel(noise, repeat, 8.0 * at, 0.0).x;
    return mix(WHITE, GREY, grey(cloud, dot(point, ACROSS) * VEINS + BEND * turbulence));
}

// How grey it is, 0 to 1, at a phase of the wave between the veins.
fn grey(cloud: f32, phase: f32) -> f32 {
    let away = 2.0 * abs(phase - floor(phase + 0.5));
    let open = saturate(0.5 + cloud);
    let vein = exp(-away * away * 60.0) * (0.35 + 0.65 * open);
    let haze = 0.16 * saturate(0.5 - cloud) * (1.0 - away);
    return saturate(0.8 * vein + haze);
}
