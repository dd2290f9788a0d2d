//! What is shown: the sculpture's textures kept up with its volume, and a frame of them.

use paros_core::events::Event;
use paros_core::frame::{BOX, STOOL};
use paros_core::size::{Grid, Size};
use paros_core::world::World;
use paros_shaders::field::{Budget, Field};
use paros_shaders::gpu::{Error, Eye, Look, Path, Picture, Renderer, Stand, Times};
use paros_shell::durable;
use winit::window::Window;

use super::keeper::{Keeper, What};
use super::paint::Painted;
use super::places::Places;
use super::screen::Screen;

/// Samples of a pixel.
const SAMPLES: u32 = 4;

/// Linear colour of what nothing covers.
const BACKDROP: [f32; 3] = [0.043, 0.046, 0.053];

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
    /// The stool's turn after the last tick and the one before, in radians.
    turns: [f32; 2],
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
        let mut view = View { renderer, screen, field, anew: false, turns: [turn(world); 2] };
        view.load(world)?;
        Ok(view)
    }

    /// Has what makes the next start faster written.
    pub(super) fn keep_cache(&self, places: &Places, keeper: &mut Keeper) {
        if let Ok(bytes) = self.renderer.cache() {
            keeper.keep(What::Cache, vec![(places.pipelines(), bytes)]);
        }
    }

    /// Takes in what a tick changed.
    pub(super) fn note(&mut self, world: &World<N>) {
        self.field.note(world.volume().maps(), world.dirty());
        self.anew |= world.events().iter().any(|event| matches!(event, Event::Started(_)));
        self.turns = [self.turns[1], turn(world)];
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
        let [before, now] = self.turns;
        let around = core::f32::consts::TAU;
        let by = (now - before + 0.5 * around).rem_euclid(around) - 0.5 * around;
        // What a scene brings besides the sculpture (room, bench, tools, chips) goes in here.
        let picture = Picture {
            eyes: &[shown.eye],
            stand: Stand { foot: STOOL, side: BOX, turn: before + by * shown.between },
            look: Look { path: shown.path, ..Look::default() },
            backdrop: BACKDROP,
        };
        self.renderer.draw(&picture, surface, target.image, target.sync)?;
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

/// The stool's turn in radians.
fn turn<const N: usize>(world: &World<N>) -> f32
where
    Grid<N>: Size,
{
    let (_, rotation) = world.frame().to_room(&paros_core::pose::Pose::ZERO);
    2.0 * rotation.y.atan2(rotation.w)
}
