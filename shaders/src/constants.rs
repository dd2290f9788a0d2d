//! Every number that Rust and the shader programs must agree on. The build writes those that WGSL
//! needs into one module, `paros::constants`, which the programs import (`build/shared.rs`).

/// Radius of an occupied voxel's blob, in voxels (section 4.2).
pub const BLOB_RADIUS: f32 = 0.5;
/// Width of the exponential smooth minimum that joins blobs, in voxels.
pub const BLOB_BLEND_WIDTH: f32 = 0.3;
/// 1 / (`BLOB_BLEND_WIDTH` * ln 2), in 1 / voxels: turns the smooth minimum's `exp` and `ln` into
/// `exp2` and `log2`.
pub const BLOB_SHARPNESS: f32 = 4.808_983_5;
/// Distance before the hit sample at which sphere tracing starts, in voxels (section 4.2).
pub const BLOB_START_BACK: f32 = 0.5;
/// Most steps of sphere tracing.
pub const BLOB_MAX_STEPS: u32 = 8;
/// Distance to the surface at which sphere tracing stops, in voxels.
pub const BLOB_HIT_DISTANCE: f32 = 0.01;

/// Samples of a shadow ray (section 4.3).
pub const SHADOW_SAMPLES: u32 = 10;
/// Factor of the visibility for each occupied sample (section 4.3).
pub const SHADOW_DAMPING: f32 = 0.7;
/// Radius of the shadow cone at the shaded point, in voxels (section 4.3).
pub const SHADOW_RADIUS_NEAR: f32 = 2.0;
/// Radius of the shadow cone where it leaves the cube, in voxels (section 4.3).
pub const SHADOW_RADIUS_FAR: f32 = 0.25;
/// Stride through the disc's rings from one sample to the next, modulo `SHADOW_SAMPLES`:
/// neighbours along the ray lie at unlike radii.
pub const SHADOW_DISC_STRIDE: u32 = 7;
/// Cosine and sine of the golden angle, the rotation from one sample to the next.
pub const GOLDEN_ANGLE_COS_SIN: [f32; 2] = [-0.737_368_9, 0.675_490_3];

/// Fraction bits of the fixed-point voxel coordinates that the paper's path steps.
pub const MARCH_FRACTION_BITS: u32 = 16;

/// Ray marching step by density, in voxels: the greater of two lines `offset - slope * density`,
/// each as (offset, slope). This line holds far from the surface, at low density.
pub const FAST_STEP_FAR: [f32; 2] = [2.6, 16.0];
/// The line that holds near the surface; see [`FAST_STEP_FAR`].
pub const FAST_STEP_NEAR: [f32; 2] = [1.75, 2.6];
/// Distance marched by density between two tries of empty-space skipping, in voxels.
pub const FAST_SKIP_INTERVAL: f32 = 8.0;
/// Cubic coefficient, relative to the linear one, of the distance to a plane as a function of its
/// blurred density less a half.
pub const FAST_EDGE_CUBIC: f32 = 2.0;
/// Grid side, in voxels, for which the lengths below are given; they scale with the grid.
pub const FAST_REFERENCE_SIDE: f32 = 128.0;
/// Distance towards the sun of the shadow's density sample of mip level 3, in voxels of the reference grid.
/// The sky's occlusion sample, nearer to the surface, is the other one: see [`FAST_AO_LEAN`].
pub const FAST_SHADOW_DISTANCE: f32 = 16.0;
/// Part of the sunlight that a sample of density 1 absorbs.
pub const FAST_SHADOW_OPACITY: f32 = 0.95;
/// Translucency: part of the sunlight, by colour, that passes thin stone to the side away from
/// the sun. What passes is warm.
pub const FAST_TRANSLUCENCY: [f32; 3] = [0.34, 0.20, 0.12];
/// Distance towards the sun of the density sample, of mip level 2, that measures the stone's thickness, in
/// voxels of the reference grid.
pub const FAST_TRANSLUCENCY_DEPTH: f32 = 5.0;
/// Wear: change of the reflectance, by colour, at the sharpest edge. Worn edges are lighter; cavities,
/// where the change is negative, are darker and warmer.
pub const FAST_WEAR: [f32; 3] = [0.52, 0.57, 0.65];
/// Upper bound of the wear at edges.
pub const FAST_WEAR_AT_EDGES: f32 = 0.25;
/// Factor of the reflectance, by colour, where the hidden figure is bared: its stone is warm.
pub const FIGURE_WARMTH: [f32; 3] = [1.0, 0.80, 0.52];
/// Radiance that the bared figure emits.
pub const FIGURE_GLOW: [f32; 3] = [0.15, 0.08, 0.025];
/// The figure's share of the stone above which it counts as bared: a voxel of stone over it leaves a
/// smaller share.
pub const FIGURE_LEAST_SHARE: f32 = 0.2;
/// Slope of the fade-in: the figure shows in full where its share is greater by 1 / this.
pub const FIGURE_SHARE_RISE: f32 = 4.0;
/// Sharpness of the sun's highlight on smooth stone, and on rough: the binary logarithm of its falloff with the
/// cosine from its middle.
pub const FAST_GLOSS_SHARPNESS: [f32; 2] = [56.0, 9.0];
/// The highlight's radiance for each unit of sharpness, as a part of the sunlight: a sharp highlight is
/// brighter than a broad one, which covers more.
pub const FAST_GLOSS: f32 = 0.0065;
/// Roughness for a convexity of 1, either positive or negative; clamped to 1.
pub const FAST_ROUGHNESS: f32 = 3.0;
/// Sparkle of the crystals: periods of the noise along the cube's side, and how far it shifts with the eye, in
/// periods.
pub const FAST_CRYSTAL_NOISE: [f32; 2] = [7.0, 0.5];
/// The least noise that sparkles, and the radiance for each unit above it, as a part of the sunlight.
pub const FAST_SPARKLE: [f32; 2] = [0.2, 0.5];
/// Squared cosine to the highlight's middle at which crystals begin to sparkle: beyond, no noise is fetched.
pub const FAST_SPARKLE_RIM: f32 = 0.4;
/// Ambient occlusion: height above the surface of its density sample, of mip level 2, in voxels of the reference grid.
pub const FAST_AO_HEIGHT: f32 = 5.0;
/// Shift of the occlusion sample towards the sun where the surface faces the sun, in voxels of the reference
/// grid. There the sample also serves the sun's shadow.
pub const FAST_AO_LEAN: f32 = 3.0;
/// Factor of the ambient light where the occlusion sample is empty. Above 1, since a flat surface's sample
/// isn't empty.
pub const FAST_AO_SCALE: f32 = 1.15;
/// Upper bound of the occlusion sample's density, so that some ambient light is left.
pub const FAST_AO_MAX_DENSITY: f32 = 0.9;

/// Contact shadow of the stone on the stool and on nearby things: height of its density sample of mip level
/// 3, in voxels.
pub const CONTACT_HEIGHT: f32 = 5.0;
/// Part of the light that the contact shadow takes where its sample is full.
pub const CONTACT_OPACITY: f32 = 0.8;
/// Fade-out of the contact shadow: it ends within 1 / this of the cube's side around the cube.
pub const CONTACT_FADE: f32 = 12.0;

/// White point of Reinhard's tone curve: the radiance that a display shows as 1. White stone that faces the sun
/// reaches about 2.3 and keeps its shading.
pub const TONE_WHITE_POINT: f32 = 3.0;
/// sRGB transfer function (IEC 61966-2-1): slope of the linear part.
pub const SRGB_LINEAR_SLOPE: f32 = 12.92;
/// sRGB transfer function: offset of the power part.
pub const SRGB_OFFSET: f32 = 0.055;
/// sRGB transfer function: exponent of the power part.
pub const SRGB_EXPONENT: f32 = 2.4;

/// Unit vector towards the sun, in the studio.
pub const SUN_DIRECTION: [f32; 3] = [-0.680_386_4, 0.600_340_9, 0.420_238_6];
/// Irradiance from the sun at normal incidence, over pi.
pub const SUN_COLOR: [f32; 3] = [2.05, 1.80, 1.48];

/// Ambient light, without the sun: radiance in the nine real spherical harmonics of bands 0 to 2,
/// in the order 00, 1-1, 10, 11, 2-2, 2-1, 20, 21, 22 with z as polar axis. The projection of
/// `light::environment_radiance`.
pub const AMBIENT_HARMONICS: [[f32; 3]; 9] = [
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

/// Range of the signed distances in the panels' atlas, on either side of an edge, in texels: enough for
/// pixels as wide as four texels.
pub const PANEL_REACH_TEXELS: f32 = 2.0;
/// Height of a capital letter in the atlas, in texels: a pixel each on a headset of 20 pixels a degree.
pub const PANEL_CAPITAL_TEXELS: f32 = 23.0;
/// Side of a pictogram or icon in the atlas, in texels.
pub const PANEL_PICTURE_TEXELS: f32 = 48.0;
/// Length of a badge's rim in the atlas, in texels.
pub const PANEL_RIM_TEXELS: f32 = 128.0;
/// Kind of a panel's quad: a rounded box.
pub const PANEL_BOX: u32 = 0;
/// Kind of a panel's quad: a shape from the atlas.
pub const PANEL_SHAPE: u32 = 1;
/// Kind of a panel's quad: a part of a ring.
pub const PANEL_RING: u32 = 2;
/// Kind of a panel's quad: a picture from the shell, in a cell of its own.
pub const PANEL_IMAGE: u32 = 3;
/// Margin of a quad around its shape, in millimetres, so that its edge has room to be smooth.
pub const PANEL_QUAD_MARGIN: f32 = 3.0;

/// Texels along a side of the noise texture; a power of two.
pub const NOISE_TEXELS: usize = 64;
/// Noise lattice cells along a side of the texture, which is its period.
pub const NOISE_CELLS: usize = 16;
/// Noise lattice cells along the cube's side, for the first octave.
pub const MARBLE_NOISE_SCALE: f32 = 2.6;
/// Octaves of the turbulence that bends the veins.
pub const MARBLE_OCTAVES: u32 = 4;
/// Amplitude of the turbulence, in periods of the veins.
pub const MARBLE_TURBULENCE: f32 = 2.4;
/// Veins along the cube's side.
pub const MARBLE_VEIN_COUNT: f32 = 2.2;
/// Gaussian falloff of a vein's grey with the squared distance from its middle; 1 is halfway to
/// the next vein.
pub const MARBLE_VEIN_FALLOFF: f32 = 60.0;
/// Greyness of a vein's middle, 0 to 1.
pub const MARBLE_VEIN_GREY: f32 = 0.8;
/// Modulation of the veins by noise, as (least, gain): `least + gain * noise` with the noise in
/// 0..1.
pub const MARBLE_VEIN_CONTRAST: [f32; 2] = [0.35, 0.65];
/// Greyness of the haze between the veins, 0 to 1.
pub const MARBLE_HAZE_GREY: f32 = 0.16;
/// Direction across the veins.
pub const MARBLE_VEIN_NORMAL: [f32; 3] = [0.62, 0.55, -0.56];
/// Reflectance between the veins.
pub const MARBLE_BASE_COLOR: [f32; 3] = [0.86, 0.845, 0.82];
/// Reflectance in a vein's middle.
pub const MARBLE_VEIN_COLOR: [f32; 3] = [0.40, 0.41, 0.44];
/// The fast path's stone: reflectance between the veins, a cool white.
pub const CARRARA_BASE_COLOR: [f32; 3] = [0.85, 0.85, 0.845];
/// Reflectance in a vein's middle.
pub const CARRARA_VEIN_COLOR: [f32; 3] = [0.29, 0.315, 0.35];

/// Pixels along a side of the screen tiles whose rays share a first empty-space test.
pub const TILE_PIXELS: u32 = 64;
/// Pixels along a side of the beams that refine a tile's start.
pub const BEAM_PIXELS: u32 = 8;
/// Binding of the frame's uniform buffer, in the drawing programs' only descriptor set.
pub const BINDING_FRAME: u32 = 0;
/// Range maps.
pub const BINDING_MAPS: u32 = 1;
/// Density.
pub const BINDING_DENSITY: u32 = 2;
/// Distances of cells.
pub const BINDING_CELLS: u32 = 3;
/// Noise of the marble.
pub const BINDING_NOISE: u32 = 4;
/// Linear sampler, clamped.
pub const BINDING_CLAMPED: u32 = 5;
/// Nearest sampler, clamped.
pub const BINDING_NEAREST: u32 = 6;
/// March starts of tiles.
pub const BINDING_TILE_STARTS: u32 = 7;
/// Greyness of the marble.
pub const BINDING_MARBLE: u32 = 8;
/// Linear sampler, repeating.
pub const BINDING_REPEAT: u32 = 9;
/// March starts of beams.
pub const BINDING_BEAM_STARTS: u32 = 10;
/// The sun's map.
pub const BINDING_SUN_MAP: u32 = 11;
/// Sampler that compares depths.
pub const BINDING_DEPTH_COMPARE: u32 = 12;
/// Directions out of the stone.
pub const BINDING_GRADIENT: u32 = 13;
/// The panels' atlas.
pub const BINDING_PANEL_ATLAS: u32 = 14;
/// The panels' pictures.
pub const BINDING_PANEL_PICTURES: u32 = 15;
/// Number of bindings.
pub const BINDING_COUNT: u32 = 16;
/// Binding of the atlas in the overlay's descriptor set.
pub const BINDING_ATLAS: u32 = 0;
/// The sampler of the atlas.
pub const BINDING_ATLAS_SAMPLER: u32 = 1;
/// Binding of the scatter program's patches: which texels to copy where.
pub const BINDING_PATCHES: u32 = 0;
/// Binding of the texels to copy.
pub const BINDING_STAGED: u32 = 1;
/// Binding of the first density level; the other levels follow.
pub const BINDING_LEVELS: u32 = 2;
/// Binding of the cells to write, after the levels.
pub const BINDING_CELL_IMAGE: u32 = BINDING_LEVELS + DENSITY_LEVELS;
/// Binding of the directions to write, after the cells.
pub const BINDING_GRADIENT_IMAGE: u32 = BINDING_CELL_IMAGE + 1;
/// Mip levels of the density.
pub const DENSITY_LEVELS: u32 = 4;
/// Width of the empty border around each range map's texture, in columns.
pub const MAP_BORDER_COLUMNS: u32 = 1;
