//! What is shown: a frame of the world, and panels over it.

use paros_core::input::TICK_RATE;
use paros_core::size::{Grid, Size};
use paros_core::world::World;
use paros_shaders::gpu::{Error, Eye, Path, Seen, Show, Times};
use paros_shaders::scene::Fresh;
use paros_shell::durable;
use paros_shell::keeper::{Keeper, What};
use paros_shell::places::Places;
use winit::window::Window;

use super::paint::Painted;
use super::screen::Screen;

/// Samples of a pixel.
const SAMPLES: u32 = 4;

/// A window's renderer and what it draws.
pub(super) struct View<const N: usize>
where
    Grid<N>: Size,
{
    // Before the screen: it goes first.
    show: Show<N>,
    screen: Screen,
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
        let show = Show::new(screen.gpu(), screen.format(SAMPLES), world, &cache)?;
        Ok(View { show, screen })
    }

    /// Has what makes the next start faster written.
    pub(super) fn keep_cache(&self, places: &Places, keeper: &mut Keeper) {
        if let Ok(bytes) = self.show.renderer.cache() {
            keeper.keep(What::Cache, vec![(places.pipelines(), bytes)]);
        }
    }

    /// Takes in what a tick changed.
    pub(super) fn note(&mut self, world: &World<N>) {
        self.show.note(world);
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
        self.show.renderer.times()
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
        size: [u32; 2],
        world: &World<N>,
        shown: &Shown,
        painted: &mut Painted,
    ) -> Result<bool, Error> {
        if size.contains(&0) {
            return Ok(false);
        }
        self.show.begin(world)?;
        let renderer = &mut self.show.renderer;
        let Some(target) = self.screen.acquire(renderer, size)? else { return Ok(false) };
        let Some(surface) = self.screen.surface() else { return Ok(false) };
        painted.hand_over(&mut renderer.overlay, surface.extent);
        let time = (world.tick() as f64 + f64::from(shown.between)) / f64::from(TICK_RATE);
        // The mouse is in no hand that one would see.
        let fresh = Fresh { grips: [None; 2], hands: false, fraction: shown.between, time };
        let seen = Seen { eyes: &[shown.eye], fresh, path: shown.path };
        self.show.draw(world, &seen, surface, target.image, target.sync)?;
        self.screen.present(target)?;
        Ok(true)
    }
}
