//! Fixed foveated rendering through OpenXR. The level is chosen in [`paros_shell::headset::foveation`].

pub use paros_shell::headset::foveation::{Foveation, FoveationLevel};

/// The OpenXR extensions that foveation needs, all of them.
pub const FOVEATION_EXTENSIONS: [&str; 4] = [
    "XR_FB_foveation",
    "XR_FB_foveation_configuration",
    "XR_FB_foveation_vulkan",
    "XR_FB_swapchain_update_state",
];
