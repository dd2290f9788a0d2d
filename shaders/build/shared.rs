//! The constants that Rust and WGSL share, as the text of one WGSL module.

use std::fmt::Write as _;

use crate::constants;

/// A constant's type and value, as WGSL text.
struct WgslConstant {
    ty: &'static str,
    value: String,
}

trait InWgsl {
    fn in_wgsl(&self) -> WgslConstant;
}

impl InWgsl for f32 {
    fn in_wgsl(&self) -> WgslConstant {
        // The fewest digits that identify the number.
        WgslConstant { ty: "f32", value: format!("{self:?}") }
    }
}

impl InWgsl for u32 {
    fn in_wgsl(&self) -> WgslConstant {
        WgslConstant { ty: "u32", value: format!("{self}u") }
    }
}

impl InWgsl for usize {
    fn in_wgsl(&self) -> WgslConstant {
        WgslConstant { ty: "u32", value: format!("{self}u") }
    }
}

impl InWgsl for [f32; 2] {
    fn in_wgsl(&self) -> WgslConstant {
        let [x, y] = self;
        WgslConstant { ty: "vec2<f32>", value: format!("vec2<f32>({x:?}, {y:?})") }
    }
}

impl InWgsl for [f32; 3] {
    fn in_wgsl(&self) -> WgslConstant {
        let [x, y, z] = self;
        WgslConstant { ty: "vec3<f32>", value: format!("vec3<f32>({x:?}, {y:?}, {z:?})") }
    }
}

/// Declares constants of `src/constants.rs` in WGSL.
macro_rules! declare {
    ($($name:ident),* $(,)?) => {{
        let mut text = String::from("#define_import_path paros::constants\n");
        $(
            let WgslConstant { ty, value } = constants::$name.in_wgsl();
            writeln!(text, "const {}: {ty} = {value};", stringify!($name))
                .expect("strings take text");
        )*
        text
    }};
}

/// Returns the text of the module `paros::constants`.
pub(crate) fn constants_module() -> String {
    declare!(
        BEAM_PIXELS,
        BINDING_ATLAS,
        BINDING_ATLAS_SAMPLER,
        BINDING_BEAM_STARTS,
        BINDING_CELLS,
        BINDING_CELL_IMAGE,
        BINDING_CLAMPED,
        BINDING_DENSITY,
        BINDING_DEPTH_COMPARE,
        BINDING_FRAME,
        BINDING_GRADIENT,
        BINDING_GRADIENT_IMAGE,
        BINDING_LEVELS,
        BINDING_MAPS,
        BINDING_MARBLE,
        BINDING_NEAREST,
        BINDING_NOISE,
        BINDING_PANEL_ATLAS,
        BINDING_PANEL_PICTURES,
        BINDING_PATCHES,
        BINDING_REPEAT,
        BINDING_STAGED,
        BINDING_SUN_MAP,
        BINDING_TILE_STARTS,
        BLOB_START_BACK,
        BLOB_RADIUS,
        BLOB_SHARPNESS,
        BLOB_MAX_STEPS,
        BLOB_HIT_DISTANCE,
        CARRARA_BASE_COLOR,
        CARRARA_VEIN_COLOR,
        CONTACT_FADE,
        CONTACT_HEIGHT,
        CONTACT_OPACITY,
        DENSITY_LEVELS,
        FAST_AO_MAX_DENSITY,
        FAST_CRYSTAL_NOISE,
        FAST_EDGE_CUBIC,
        FAST_GLOSS,
        FAST_GLOSS_SHARPNESS,
        FAST_ROUGHNESS,
        FAST_SPARKLE,
        FAST_WEAR,
        FAST_WEAR_AT_EDGES,
        FAST_AO_HEIGHT,
        FAST_AO_LEAN,
        FAST_SPARKLE_RIM,
        FAST_AO_SCALE,
        FAST_SHADOW_OPACITY,
        FAST_SHADOW_DISTANCE,
        FAST_REFERENCE_SIDE,
        FAST_STEP_FAR,
        FAST_STEP_NEAR,
        FAST_SKIP_INTERVAL,
        FAST_TRANSLUCENCY,
        FAST_TRANSLUCENCY_DEPTH,
        FIGURE_GLOW,
        FIGURE_LEAST_SHARE,
        FIGURE_SHARE_RISE,
        FIGURE_WARMTH,
        GOLDEN_ANGLE_COS_SIN,
        MAP_BORDER_COLUMNS,
        MARBLE_VEIN_NORMAL,
        MARBLE_TURBULENCE,
        MARBLE_VEIN_CONTRAST,
        MARBLE_VEIN_FALLOFF,
        MARBLE_VEIN_COLOR,
        MARBLE_HAZE_GREY,
        MARBLE_NOISE_SCALE,
        MARBLE_VEIN_GREY,
        MARBLE_VEIN_COUNT,
        MARBLE_BASE_COLOR,
        MARCH_FRACTION_BITS,
        NOISE_CELLS,
        PANEL_BOX,
        PANEL_IMAGE,
        PANEL_QUAD_MARGIN,
        PANEL_REACH_TEXELS,
        PANEL_RING,
        PANEL_SHAPE,
        SHADOW_DAMPING,
        SHADOW_RADIUS_FAR,
        SHADOW_RADIUS_NEAR,
        SHADOW_SAMPLES,
        SHADOW_DISC_STRIDE,
        SRGB_LINEAR_SLOPE,
        SRGB_OFFSET,
        SRGB_EXPONENT,
        TILE_PIXELS,
        TONE_WHITE_POINT,
    )
}

// Checks of constants that the programs have written out, term by term or binding by binding.
const _: () = {
    assert!(constants::MARBLE_OCTAVES == 4, "marble.wgsl adds four octaves");
    assert!(constants::DENSITY_LEVELS == 4, "scatter.wgsl binds four levels");
    let product = constants::BLOB_SHARPNESS * constants::BLOB_BLEND_WIDTH * std::f32::consts::LN_2;
    assert!(
        product > 0.999_999 && product < 1.000_001,
        "BLOB_SHARPNESS is made of BLOB_BLEND_WIDTH"
    );
};
