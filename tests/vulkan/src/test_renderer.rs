//! A renderer with an offscreen target, under the validation layer.

use glam::{Quat, Vec3};
use paros_core::World;
use paros_core::volume::{Grid, Size};
use paros_shaders::field::{Budget, DensityField};
use paros_shaders::gpu::{
    Eye, Fov, FrameRequest, FrameSemaphores, Gpu, OffscreenTarget, Options, RenderStyle, Renderer,
    SculpturePlacement, SharedGpu, TargetFormat,
};
use paros_shaders::upload::VolumeFormat;
use paros_shell::require::require_or_skip;

/// Returns a device with validation, or `None` if the machine has no device.
///
/// # Panics
/// A device is required and missing.
pub fn test_device() -> Option<SharedGpu> {
    test_device_with(Options::default())
}

/// Returns a device with validation and these options, or `None` if the machine has no device.
///
/// # Panics
/// As [`test_device`].
pub fn test_device_with(options: Options) -> Option<SharedGpu> {
    let options = Options { validation: true, ..options };
    require_or_skip(Gpu::headless(&options)).expect("a Vulkan device and its validation")
}

/// The views of a picture, each as pixels in red, green, blue, alpha.
pub type Layers = Vec<Vec<[u8; 4]>>;

/// A renderer with an offscreen target. Dropping it panics if validation reported anything.
#[derive(Debug)]
pub struct TestRenderer {
    // Declared first, so that it is dropped before the renderer that made it.
    /// The offscreen target.
    pub screen: OffscreenTarget,
    /// The renderer.
    pub renderer: Renderer,
    gpu: SharedGpu,
}

impl TestRenderer {
    /// Creates a renderer for volumes of a format, and pictures of an extent in pixels. Depth is stored with
    /// one sample.
    ///
    /// # Panics
    /// A Vulkan call fails, here and below.
    pub fn new(
        gpu: &SharedGpu,
        volume: VolumeFormat,
        [samples, views]: [u32; 2],
        extent: [u32; 2],
    ) -> Self {
        let format = OffscreenTarget::readback_format(samples, views, samples == 1);
        Self::with_format(gpu, volume, format, extent)
    }

    /// Creates a renderer with a target format that can be read back.
    pub fn with_format(
        gpu: &SharedGpu,
        volume: VolumeFormat,
        format: TargetFormat,
        extent: [u32; 2],
    ) -> Self {
        let renderer = Renderer::new(gpu, format, volume, &[]).expect("a renderer");
        let screen = OffscreenTarget::new(gpu, &renderer, extent).expect("an image");
        TestRenderer { screen, renderer, gpu: gpu.clone() }
    }

    /// Uploads all textures of a sculpture at once.
    pub fn upload_field<const N: usize, const K: usize>(&mut self, field: &DensityField<N, K>) {
        field.emit_all_regions(|region, bytes| {
            self.renderer.submit_upload_between_frames(region, bytes).expect("an upload");
        });
    }

    /// Draws a frame and reads back the pixels of each view.
    pub fn draw_picture(&mut self, picture: &FrameRequest<'_>) -> Layers {
        self.renderer.wait_and_begin_frame().expect("a frame");
        self.draw_begun_picture(picture)
    }

    /// Draws the frame that has begun and reads back the pixels of each view.
    pub fn draw_begun_picture(&mut self, picture: &FrameRequest<'_>) -> Layers {
        let target = &self.screen.target;
        self.renderer
            .draw_frame(picture, target, 0, FrameSemaphores::default())
            .expect("a picture");
        self.renderer.wait_for_frames().expect("the device");
        let views = self.renderer.format().views;
        (0..views).map(|view| self.screen.read_pixels(view).expect("pixels")).collect()
    }

    /// Draws a frame, with as many pending uploads as the budget allows.
    pub fn draw_with_pending_uploads<const N: usize, const K: usize>(
        &mut self,
        field: &mut DensityField<N, K>,
    ) {
        self.renderer.wait_and_begin_frame().expect("a frame");
        let (budget, mut bytes) = (Budget::per_frame(N), 0);
        field.update_textures(budget, &mut |region, texels| {
            bytes += texels.len();
            assert!(
                self.renderer.try_stage_upload(region, texels),
                "a frame's budget is more than it takes"
            );
        });
        assert!(bytes <= budget.bytes, "{bytes} bytes in a frame");
        let target = &self.screen.target;
        self.renderer
            .draw_frame(
                &metre_wide_sculpture_at_origin(&[AHEAD]),
                target,
                0,
                FrameSemaphores::default(),
            )
            .expect("a picture");
    }

    /// Asserts that the device's textures equal a rebuild from a world's volume.
    pub fn assert_textures_match<const N: usize, const K: usize>(
        &self,
        world: &World<N, K>,
        scratch: &mut DensityField<N, K>,
        context: &str,
    ) where
        Grid<N>: Size,
    {
        scratch.rebuild_from(world.volume().maps());
        scratch.emit_all_regions(|region, bytes| {
            let held = self.screen.read_texels(&self.renderer, region).expect("texels");
            assert_eq!(held.len(), bytes.len());
            let wrong = held.iter().zip(bytes).filter(|(held, right)| held != right).count();
            assert_eq!(wrong, 0, "{context}: of {} bytes of {:?}", bytes.len(), region.texture);
        });
    }
}

impl Drop for TestRenderer {
    fn drop(&mut self) {
        if !std::thread::panicking() {
            assert_eq!(self.gpu.instance.validation_messages(), Vec::<String>::new());
        }
    }
}

/// An eye in front of the lone sculpture.
pub const AHEAD: Eye = Eye {
    position: Vec3::new(0.0, 0.5, 2.0),
    rotation: Quat::IDENTITY,
    fov: Fov { left: -0.5, right: 0.5, up: 0.5, down: -0.5 },
};

/// Returns a request for a sculpture a metre wide, without a scene.
#[must_use]
pub fn metre_wide_sculpture_at_origin(eyes: &[Eye]) -> FrameRequest<'_> {
    let stand = SculpturePlacement { foot: Vec3::ZERO, side: 1.0, turn_radians: 0.0 };
    FrameRequest {
        eyes,
        placement: stand,
        style: RenderStyle::default(),
        backdrop: [0.0; 3],
        scene: None,
        panels: &[],
    }
}
