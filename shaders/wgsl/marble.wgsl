// Procedural marble: a plane wave's veins, bent by turbulence (Perlin 1985).
#define_import_path paros::marble
#import paros::constants::{
    MARBLE_BASE_COLOR, MARBLE_HAZE_GREY, MARBLE_NOISE_SCALE, MARBLE_TURBULENCE, MARBLE_VEIN_COLOR,
    MARBLE_VEIN_CONTRAST, MARBLE_VEIN_COUNT, MARBLE_VEIN_FALLOFF, MARBLE_VEIN_GREY,
    MARBLE_VEIN_NORMAL, NOISE_CELLS,
}

// Diffuse reflectance at a point of the unit cube, with four octaves of noise.
fn reflectance(noise: texture_3d<f32>, repeat: sampler, point: vec3<f32>) -> vec3<f32> {
    let cell = point * (MARBLE_NOISE_SCALE / f32(NOISE_CELLS));
    let cloud = textureSampleLevel(noise, repeat, cell, 0.0).x;
    let turbulence = 0.5 * cloud
        + 0.25 * textureSampleLevel(noise, repeat, 2.0 * cell, 0.0).x
        + 0.125 * textureSampleLevel(noise, repeat, 4.0 * cell, 0.0).x
        + 0.0625 * textureSampleLevel(noise, repeat, 8.0 * cell, 0.0).x;
    let phase = dot(point, MARBLE_VEIN_NORMAL) * MARBLE_VEIN_COUNT + MARBLE_TURBULENCE * turbulence;
    return mix(MARBLE_BASE_COLOR, MARBLE_VEIN_COLOR, vein_grey(cloud, phase));
}

// Greyness, 0 to 1, at a phase of the wave, whose veins lie at whole numbers.
fn vein_grey(cloud: f32, phase: f32) -> f32 {
    let distance_to_vein = 2.0 * abs(phase - floor(phase + 0.5));
    let open = saturate(0.5 + cloud);
    let vein = exp(-distance_to_vein * distance_to_vein * MARBLE_VEIN_FALLOFF)
        * (MARBLE_VEIN_CONTRAST.x + MARBLE_VEIN_CONTRAST.y * open);
    let haze = MARBLE_HAZE_GREY * saturate(0.5 - cloud) * (1.0 - distance_to_vein);
    return saturate(MARBLE_VEIN_GREY * vein + haze);
}
