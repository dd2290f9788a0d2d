//! The window: a studio to sculpt in with mouse and keyboard.
//!
//! `hands` turns what the devices do into the core's input, `paros_shell`'s studio steps the world and
//! keeps its files, `view` draws it, `panels` ask and tell; `app` ties them to a window. Only `app`,
//! `keys`, `screen` and `view` know `winit` or Vulkan.

mod app;
mod camera;
mod cast;
mod display;
mod hands;
mod keys;
mod libraries;
mod opening;
mod paint;
mod panels;
mod screen;
mod script;
mod view;

use std::path::PathBuf;

use paros_core::size::{Grid, Size};
use paros_shaders::portrait;
use paros_shell::places::Places;
use paros_shell::print::{HEIGHT_MM, Printer};
use paros_shell::statics::Resident;
use paros_shell::studio::Studio;
use winit::error::EventLoopError;
use winit::event_loop::EventLoop;

use crate::error::Error;
use app::App;
use script::Script;

/// What a window is opened with.
#[derive(Clone, Default, Debug)]
pub struct Options {
    /// A mesh or a volume to begin with.
    pub file: Option<PathBuf>,
    /// Where sculptures go, instead of the user's own folder.
    pub folder: Option<PathBuf>,
    /// Where the trace of the last session goes.
    pub record: Option<PathBuf>,
    /// What is done instead of by hand.
    pub script: Option<PathBuf>,
    /// Whether Vulkan's validation looks on; what it says is an error.
    pub validation: bool,
}

/// Why a window closed other than by the visitor's wish.
#[derive(Debug)]
pub enum Closed {
    /// It never opened: no display, or no Vulkan that fits. What is missing.
    Unavailable(String),
    /// Something failed later, or was wrong with what it was given.
    Failed(Error),
}

/// Opens the window, and comes back when it is closed: with where the last print is, if there is
/// one.
///
/// # Errors
/// See [`Closed`]. The session has been saved in any case.
pub fn open<const N: usize>(options: &Options) -> Result<String, Closed>
where
    Grid<N>: Size + Resident<N>,
{
    if let Some(file) = &options.file {
        // Whether or not there can be a window, and before one is there.
        opening::load::<N>(file).map_err(|why| Closed::Failed(Error::Input(why)))?;
    }
    libraries::probe().map_err(Closed::Unavailable)?;
    let script = options.script.as_deref().map(Script::open).transpose().map_err(Closed::Failed)?;
    let events =
        EventLoop::new().map_err(|error| Closed::Unavailable(format!("no window: {error}")))?;
    let mut volumes = Grid::<N>::start_volumes();
    volumes.make(&mut Grid::<N>::plane(), |_| {});
    let (mut world, mut press) = (Grid::<N>::world(), Grid::<N>::press());
    let printer = Printer::new(&mut press, HEIGHT_MM);
    let printer = printer.map_err(|error| Closed::Failed(error.into()))?;
    let places = Places::of_user(options.folder.as_deref());
    let mut studio = Studio::new(&mut world, &mut volumes, printer, places, portrait);
    studio.record_to(options.record.clone());
    let mut app = App::new(studio, script, options);
    let run = events.run_app(&mut app);
    if let Err(EventLoopError::ExitFailure(_)) = run {
        app.display_gone();
    }
    let closed = app.close();
    if let Err(EventLoopError::Os(error)) = run {
        return Err(Closed::Failed(Error::failure(error)));
    }
    if let Err(Closed::Unavailable(_)) = closed {
        // Whoever comes next finds the world as it was.
        world.clear();
    }
    closed
}
