//! A world on show: its volume's textures and its scene, kept up tick by tick, drawn frame by frame.

use std::sync::Arc;

use paros_core::events::Event;
use paros_core::size::{Grid, Size};
use paros_core::world::World;

use super::context::Gpu;
use super::error::Error;
use super::frame::{Eye, Look, Path, Picture, Stand};
use super::pass::Format;
use super::renderer::{Renderer, Sync};
use super::surface::Surface;
use crate::field::{Budget, Field};
use crate::scene::{Assembly, Fresh, SKY, SculpturePose};

/// A renderer and what it draws.
#[derive(Debug)]
pub struct Show<const N: usize>
where
    Grid<N>: Size,
{
    /// What draws, with panels of text.
    pub renderer: Renderer,
    field: Box<Field<N>>,
    /// The volume is another one: its textures are made anew at once, a hitch that no one sees.
    anew: bool,
    scene: Box<Assembly>,
}

/// What a frame shows, besides the world.
#[derive(Clone, Copy, Debug)]
pub struct Seen<'a> {
    /// Whence: as many eyes as the format has views.
    pub eyes: &'a [Eye],
    /// What is newer than the last tick.
    pub fresh: Fresh,
    /// By which path.
    pub path: Path,
}

impl<const N: usize> Show<N>
where
    Grid<N>: Size,
{
    /// Shows a world as it is. `cache` is what [`Renderer::cache`] gave at an earlier start, or
    /// nothing.
    ///
    /// # Errors
    /// A call that failed; out of memory, most likely.
    pub fn new(
        gpu: &Arc<Gpu>,
        format: Format,
        world: &World<N>,
        cache: &[u8],
    ) -> Result<Self, Error> {
        let renderer = Renderer::new(gpu, format, N, cache)?;
        let mut scene = Box::new(Assembly::new());
        scene.follow(world);
        let mut show = Show { renderer, field: Box::new(Field::new()), anew: false, scene };
        show.load(world)?;
        Ok(show)
    }

    /// Takes in what a tick changed; to be called after each.
    pub fn note(&mut self, world: &World<N>) {
        self.field.note(world.volume().maps(), world.dirty());
        self.anew |= world.events().iter().any(|event| matches!(event, Event::Started(_)));
        self.scene.follow(world);
    }

    /// Begins a frame: waits until the one before the last is done.
    ///
    /// # Errors
    /// A lost device.
    pub fn begin(&mut self, world: &World<N>) -> Result<(), Error> {
        if core::mem::take(&mut self.anew) {
            self.load(world)?;
        }
        self.renderer.begin()
    }

    /// Draws the frame that has begun into an image of a surface.
    ///
    /// # Errors
    /// A lost device.
    pub fn draw(
        &mut self,
        world: &World<N>,
        seen: &Seen<'_>,
        surface: &Surface,
        image: usize,
        sync: Sync,
    ) -> Result<(), Error> {
        let renderer = &mut self.renderer;
        self.field.advance(Budget::frame(N), &mut |region, bytes| {
            let fits = renderer.upload(region, bytes);
            debug_assert!(fits, "a frame's budget is within what it can upload");
        });
        self.scene.assemble(world, &seen.fresh);
        let SculpturePose { turn, side, foot } = self.scene.sculpture();
        let picture = Picture {
            eyes: seen.eyes,
            stand: Stand { foot, side, turn },
            look: Look::studio(seen.path),
            backdrop: SKY.map(|c| c * (1.0 + 0.25 * c) / (1.0 + c)),
            scene: Some(self.scene.list()),
        };
        self.renderer.draw(&picture, surface, image, sync)
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
