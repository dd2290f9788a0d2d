//! What is shown: the sculpture's textures kept up with its volume, and a frame of them.

use paros_core::events::Event;
use paros_core::input::TICK_RATE;
use paros_core::size::{Grid, Size};
use paros_core::world::World;
use paros_shaders::field::{Budget, Field};
use paros_shaders::gpu::{Error, Eye, Look, Path, Picture, Renderer, Stand, Times};
use paros_shaders::scene::{Assembly, Fresh, SKY, SculpturePose};
use paros_shell::durable;
use winit::window::Window;

use super::keeper::{Keeper, What};
use super::paint::Painted;
use super::places::Places;
use super::screen::Screen;

/// Samples of a pixel.
const SAMPLES: u32 = 4;

/// A window's renderer and what it draws.
pub(super) struct View<const N: usize>
where
    Grid<N>: Size,
{
    // Before the screen: it goes first.
    renderer: Renderer,
    screen: Screen,
    field: Box<Field<N>>,
    /// The volume is another one: its textures are made anew at once, a hitch that no one sees.
    anew: bool,
    scene: Box<Assembly>,
}

/// What a frame shows besides the sculpture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shown {
    /// Whence.
    pub(super) eye: Eye,
    /// How far the time is from the last tick to the next.
    pub(super) between: f32,
    /// By which path.
    pub(super) path: Path,
}

impl<const N: usize> View<N>
where
    Grid<N>: Size,
{
    /// The view into a window, of a world as it is.
    ///
    /// # Errors
    /// No Vulkan, no device that fits, or a call that failed.
    pub(super) fn new(
        window: &Window,
        world: &World<N>,
        places: &Places,
        validation: bool,
    ) -> Result<Self, Error> {
        let screen = Screen::new(window, validation)?;
        // Without it the start takes longer, that is all.
        let cache = durable::read(&places.pipelines()).unwrap_or_default();
        let renderer = Renderer::new(screen.gpu(), screen.format(SAMPLES), N, &cache)?;
        let field = Box::new(Field::new());
        let mut scene = Box::new(Assembly::new());
        scene.follow(world);
        let mut view = View { renderer, screen, field, anew: false, scene };
        view.load(world)?;
        Ok(view)
    }

    /// Has what makes the next start faster written.
    pub(super) fn keep_cache(&self, places: &Places, keeper: &mut Keeper) {
        if let Ok(bytes) = self.renderer.cache() {
            keeper.keep(What::Cache, places.pipelines(), bytes);
        }
    }

    /// Takes in what a tick changed.
    pub(super) fn note(&mut self, world: &World<N>) {
        self.field.note(world.volume().maps(), world.dirty());
        self.anew |= world.events().iter().any(|event| matches!(event, Event::Started(_)));
        self.scene.follow(world);
    }

    /// The window has another size.
    pub(super) fn resized(&mut self) {
        self.screen.resized();
    }

    /// The device's name.
    #[must_use]
    pub(super) fn device(&self) -> &str {
        &self.screen.gpu().name
    }

    /// How long the device took for the latest frame known to be done.
    #[must_use]
    pub(super) const fn times(&self) -> Times {
        self.renderer.times()
    }

    /// What validation has complained of.
    #[must_use]
    pub(super) fn messages(&self) -> Vec<String> {
        self.screen.gpu().instance.messages()
    }

    /// Draws a frame into a window of a size in pixels. Whether there was anything to draw into.
    ///
    /// # Errors
    /// A lost device or window.
    pub(super) fn draw(
        &mut self,
        window: &Window,
        size: [u32; 2],
        world: &World<N>,
        shown: &Shown,
        painted: &mut Painted,
    ) -> Result<bool, Error> {
        if size.contains(&0) {
            return Ok(false);
        }
        if core::mem::take(&mut self.anew) {
            self.load(world)?;
        }
        self.renderer.begin()?;
        let Some(target) = self.screen.acquire(&self.renderer, size)? else { return Ok(false) };
        let renderer = &mut self.renderer;
        self.field.advance(Budget::frame(N), &mut |region, bytes| {
            let fits = renderer.upload(region, bytes);
            debug_assert!(fits, "a frame's budget is within what it can upload");
        });
        let Some(surface) = self.screen.surface() else { return Ok(false) };
        painted.hand_over(&mut self.renderer.overlay, surface.extent);
        let time = (world.tick() as f64 + f64::from(shown.between)) / f64::from(TICK_RATE);
        // The mouse is in no hand that one would see.
        let fresh = Fresh { grips: [None; 2], hands: false, fraction: shown.between, time };
        self.scene.assemble(world, &fresh);
        let SculpturePose { turn, side, foot } = self.scene.sculpture();
        let picture = Picture {
            eyes: &[shown.eye],
            stand: Stand { foot, side, turn },
            look: Look::studio(shown.path),
            backdrop: SKY.map(|c| c * (1.0 + 0.25 * c) / (1.0 + c)),
            scene: Some(self.scene.list()),
        };
        self.renderer.draw(&picture, surface, target.image, target.sync)?;
        // From here on the next frame is asked for when the compositor wants it.
        window.pre_present_notify();
        self.screen.present(target)?;
        Ok(true)
    }

    /// Makes all textures of a world's volume.
    fn load(&mut self, world: &World<N>) -> Result<(), Error> {
        self.field.rebuild(world.volume().maps());
        let mut loaded = Ok(());
        self.field.whole(|region, bytes| {
            if loaded.is_ok() {
                loaded = self.renderer.load(region, bytes);
            }
        });
        loaded
    }
}
