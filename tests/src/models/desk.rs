//! A renderer with an image of its own, on a device that validation looks at.

use glam::{Quat, Vec3};
use paros_core::size::{Grid, Size};
use paros_core::world::World;
use paros_shaders::field::{Budget, Field};
use paros_shaders::gpu::{
    Context, Eye, Fov, Gpu, Look, Offscreen, Options, Picture, Renderer, Stand, Sync,
};
use paros_shell::require::require;

/// A device that validation looks at, or none where there is none.
///
/// # Panics
/// One is required and missing.
pub fn device() -> Option<Context> {
    device_with(Options::default())
}

/// The same, made in some other way.
///
/// # Panics
/// As [`device`].
pub fn device_with(options: Options) -> Option<Context> {
    let options = Options { validation: true, ..options };
    require(Gpu::headless(&options)).expect("a Vulkan device and its validation")
}

/// The layers of a picture: red, green, blue, alpha.
pub type Layers = Vec<Vec<[u8; 4]>>;

/// A renderer with an image to draw into. Validation must have been silent when it is dropped.
#[derive(Debug)]
pub struct Desk {
    // Goes before the renderer that it was made with.
    /// What is drawn into.
    pub screen: Offscreen,
    /// What draws.
    pub renderer: Renderer,
    gpu: Context,
}

impl Desk {
    /// For volumes of `n` voxels a side, samples of a pixel, eyes, and pixels across and down. Depth
    /// is kept where there is one sample.
    ///
    /// # Panics
    /// A call that fails, here and below.
    pub fn new(gpu: &Context, n: usize, [samples, views]: [u32; 2], size: [u32; 2]) -> Self {
        let format = Offscreen::format(samples, views, samples == 1);
        let renderer = Renderer::new(gpu, format, n, &[]).expect("a renderer");
        let screen = Offscreen::new(gpu, &renderer, size).expect("an image");
        Desk { screen, renderer, gpu: gpu.clone() }
    }

    /// Uploads all textures of a sculpture at once.
    pub fn load<const N: usize>(&mut self, field: &Field<N>) {
        field.whole(|region, bytes| self.renderer.load(region, bytes).expect("an upload"));
    }

    /// Draws a picture; what each eye sees.
    pub fn draw(&mut self, picture: &Picture<'_>) -> Layers {
        self.renderer.begin().expect("a frame");
        let surface = &self.screen.surface;
        self.renderer.draw(picture, surface, 0, Sync::default()).expect("a picture");
        self.renderer.finish().expect("the device");
        let views = self.renderer.format().views;
        (0..views).map(|view| self.screen.pixels(view).expect("pixels")).collect()
    }

    /// Draws a frame after as much of what is to be uploaded as a frame's budget allows.
    pub fn follow<const N: usize>(&mut self, field: &mut Field<N>) {
        self.renderer.begin().expect("a frame");
        let (budget, mut bytes) = (Budget::frame(N), 0);
        field.advance(budget, &mut |region, texels| {
            bytes += texels.len();
            assert!(self.renderer.upload(region, texels), "a frame's budget is more than it takes");
        });
        assert!(bytes <= budget.bytes, "{bytes} bytes in a frame");
        let surface = &self.screen.surface;
        self.renderer.draw(&alone(&[AHEAD]), surface, 0, Sync::default()).expect("a picture");
    }

    /// What the device holds is what a rebuild from nothing makes of a world's volume.
    pub fn check<const N: usize>(&self, world: &World<N>, rebuilt: &mut Field<N>, when: &str)
    where
        Grid<N>: Size,
    {
        rebuilt.rebuild(world.volume().maps());
        rebuilt.whole(|region, bytes| {
            let held = self.screen.texels(&self.renderer, region).expect("texels");
            assert_eq!(held.len(), bytes.len());
            let wrong = held.iter().zip(bytes).filter(|(held, right)| held != right).count();
            assert_eq!(wrong, 0, "{when}: of {} bytes of {:?}", bytes.len(), region.texture);
        });
    }
}

impl Drop for Desk {
    fn drop(&mut self) {
        if !std::thread::panicking() {
            assert_eq!(self.gpu.instance.messages(), Vec::<String>::new());
        }
    }
}

/// An eye before a sculpture that stands alone.
pub const AHEAD: Eye = Eye {
    position: Vec3::new(0.0, 0.5, 2.0),
    rotation: Quat::IDENTITY,
    fov: Fov { left: -0.5, right: 0.5, up: 0.5, down: -0.5 },
};

/// A sculpture a metre wide, and nothing else.
#[must_use]
pub fn alone(eyes: &[Eye]) -> Picture<'_> {
    let stand = Stand { foot: Vec3::ZERO, side: 1.0, turn: 0.0 };
    Picture { eyes, stand, look: Look::default(), backdrop: [0.0; 3], scene: None }
}
