//! Every number that the twin and the shader programs must agree on.

/// Radius of the blob that stands for an occupied voxel, in voxels (section 4.2).
pub const BLOB_RADIUS: f32 = 0.5;
/// Width of the blobs' smooth union, in voxels.
pub const BLOB_BLEND: f32 = 0.3;
/// How far back along the ray the sphere tracing starts, in voxels (section 4.2).
pub const BLOB_BACK: f32 = 0.5;
/// Steps of the sphere tracing.
pub const BLOB_STEPS: u32 = 8;
/// Distance to the blobs that counts as touching them, in voxels.
pub const BLOB_TOUCH: f32 = 0.01;

/// Samples of a shadow ray (section 4.3).
pub const SHADOW_SAMPLES: u32 = 10;
/// What each occupied sample leaves of the visibility (section 4.3).
pub const SHADOW_DAMPING: f32 = 0.7;
/// Radius of the shadow cone at the shaded point, in voxels (section 4.3).
pub const SHADOW_RADIUS_NEAR: f32 = 2.0;
/// Radius of the shadow cone where it leaves the cube, in voxels (section 4.3).
pub const SHADOW_RADIUS_FAR: f32 = 0.25;
/// Cosine and sine of the golden angle, by which one shadow sample turns from the one before.
pub const GOLDEN_TURN: [f32; 2] = [-0.737_368_9, 0.675_490_3];

/// The fast path's step outside of the surface, in voxels: the greater of two lines in the density.
pub const FAST_STEP: [[f32; 2]; 2] = [[2.6, 16.0], [1.65, 2.5]];
/// How far its first sample towards the sun is, in voxels of 128 to a side, and how much farther
/// each is than the one before.
pub const FAST_SHADOW: [f32; 2] = [2.8, 2.5];
/// What a full sample towards the sun takes of the light.
pub const FAST_SEEN: f32 = 0.9;
/// What comes through thin stone on the side away from the sun, of its light.
pub const FAST_THIN: [f32; 3] = [0.14, 0.08, 0.05];
/// How far above the surface the sample lies that tells how open it is, in voxels of 128 to a side.
pub const FAST_FAR_OPEN: f32 = 5.0;
/// What is left of the ambient light where that sample is empty; a flat surface's isn't.
pub const FAST_OPEN: f32 = 1.15;

/// Unit vector towards the sun, in the studio.
pub const SUN_DIRECTION: [f32; 3] = [-0.680_386_4, 0.600_340_9, 0.420_238_6];
/// Irradiance of a surface that faces the sun, over pi.
pub const SUN_COLOR: [f32; 3] = [2.05, 1.80, 1.48];

/// The studio's light but for the sun: radiance in the nine real spherical harmonics of bands 0
/// to 2, in the order 00, 1-1, 10, 11, 2-2, 2-1, 20, 21, 22 with z as polar axis. They are the
/// projection of `light::environment`.
pub const AMBIENT: [[f32; 3]; 9] = [
    [0.795404, 0.867949, 1.020178],
    [0.242003, 0.357038, 0.517623],
    [-0.093763, -0.121341, -0.165464],
    [0.175024, 0.226502, 0.308866],
    [0.073451, 0.095054, 0.129619],
    [-0.039349, -0.050922, -0.069439],
    [-0.052917, -0.073383, -0.103504],
    [-0.110176, -0.142581, -0.194429],
    [0.054978, 0.062660, 0.079494],
];

/// Texels along a side of the noise texture; a power of two.
pub const NOISE_SIZE: usize = 64;
/// Noise lattice cells along a side of the texture; the texture repeats after them.
pub const NOISE_CELLS: usize = 16;
/// Noise lattice cells along the cube's side, for the first octave.
pub const MARBLE_SCALE: f32 = 2.6;
/// Octaves of the turbulence that bends the veins.
pub const MARBLE_OCTAVES: u32 = 4;
/// How far the turbulence bends the veins.
pub const MARBLE_BEND: f32 = 2.4;
/// Veins along the cube's side.
pub const MARBLE_VEINS: f32 = 2.2;
/// Direction across the veins.
pub const MARBLE_ACROSS: [f32; 3] = [0.62, 0.55, -0.56];
/// Reflectance between the veins.
pub const MARBLE_WHITE: [f32; 3] = [0.86, 0.845, 0.82];
/// Reflectance in a vein's middle.
pub const MARBLE_GREY: [f32; 3] = [0.40, 0.41, 0.44];
