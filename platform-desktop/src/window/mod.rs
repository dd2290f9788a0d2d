//! The window: a studio to sculpt in with mouse and keyboard.
//!
//! `hands` turns mouse and keys into the core's input, `paros_shell`'s studio steps the world and saves
//! its files, `view` draws it, `panels` are the user interface; `app` handles the window's events. Only
//! `app`, `display`, `keys`, `screen` and `view` use `winit` or Vulkan.

mod app;
mod booth;
mod camera;
mod display;
mod first_size;
mod hands;
mod keys;
mod libraries;
mod opening;
mod os_error;
mod paint;
mod panels;
mod picture_scale;
mod raycast;
mod screen;
mod script;
mod size_choice;
mod slowness;
mod start_pictures;
mod view;

use std::path::PathBuf;
use std::time::Duration;

use paros_core::limits::INTERVALS;
use paros_core::volume::{Grid, Size};
use paros_headless::Error;
use paros_shell::settings::BoothSettings;
use paros_shell::statics::Resident;
use paros_shell::studio::{DrawPicture, Studio};
use paros_shell::studio_paths::StudioPaths;
use paros_visit::VisitOptions;
use winit::error::EventLoopError;
use winit::event_loop::EventLoop;

use app::App;
use os_error::strip_source_location;
use script::Script;
pub use size_choice::SizeChoice;

/// How a window is opened.
#[derive(Clone, Default, Debug)]
pub struct WindowOptions {
    /// A mesh or a volume to begin with.
    pub file: Option<PathBuf>,
    /// How the studio's size was chosen, where nobody said it.
    pub size_choice: Option<SizeChoice>,
    /// Where sculptures go, instead of the user's own folder.
    pub folder: Option<PathBuf>,
    /// Where the trace of the last session goes.
    pub record: Option<PathBuf>,
    /// A script of input, in place of mouse and keys.
    pub script: Option<PathBuf>,
    /// Where visitors use it one after the other, on a full screen, without files and developer's tools: how long it must be
    /// left alone for its visitor to have gone.
    pub kiosk: Option<Duration>,
    /// Where sessions are visits of an exhibition: what it sets of them.
    pub visits: Option<VisitOptions>,
    /// How sculptures go to a booth, where this machine is enrolled at one; `None` where none goes.
    pub booth: Option<BoothSettings>,
    /// How loud it is, in hundredths; 0 for no sound.
    pub sound_percent: u32,
    /// What is wrong with the settings, a line for each fault.
    pub settings_faults: Vec<String>,
    /// Whether Vulkan's validation layer is enabled; its messages are errors.
    pub validation: bool,
}

/// Why a window could not open, or closed by itself.
#[derive(Debug)]
pub enum WindowError {
    /// No display, or no suitable Vulkan device: what is missing.
    Unavailable(String),
    /// Bad input, or a later failure.
    Failed(Error),
}

/// Opens the window and runs its event loop. Blocks until the window is closed. Returns the last
/// print's path as a line, or nothing without a print. `draw_picture` draws finished sculptures, in a thread.
///
/// # Errors
/// See [`WindowError`]. The session has been saved in any case.
pub fn run_window<const N: usize>(
    options: &WindowOptions,
    draw_picture: DrawPicture<N>,
) -> Result<String, WindowError>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    if let Some(file) = &options.file {
        // Read before the window opens: a bad file is an error even without a display.
        opening::read_into_resident_maps::<N>(file)
            .map_err(|why| WindowError::Failed(Error::Input(why)))?;
    }
    libraries::check_display_and_libraries().map_err(WindowError::Unavailable)?;
    let script =
        options.script.as_deref().map(Script::open).transpose().map_err(WindowError::Failed)?;
    let events = EventLoop::new().map_err(|error| {
        WindowError::Unavailable(format!("no window: {}", strip_source_location(&error)))
    })?;
    let (mut resident, mut stl_buffers) = (Grid::<N>::lock_world(), Grid::<N>::lock_stl_buffers());
    resident.generate_starts();
    let pictures = start_pictures::render_start_pictures(&resident.start_volumes);
    let paths = StudioPaths::for_user(options.folder.as_deref());
    let mut studio = Studio::new(&mut resident, &mut stl_buffers, paths, draw_picture);
    studio.set_trace_path_at_exit(options.record.clone());
    let (booth, visits) = (options.booth.as_ref(), options.visits.as_ref());
    let courier = booth.and_then(|booth| booth::bring_to_booth(&mut studio, booth, visits));
    let mut app = App::new((studio, courier), script, &pictures, options);
    let run = events.run_app(&mut app);
    if let Err(EventLoopError::ExitFailure(_)) = run {
        app.on_display_lost();
    }
    let closed = app.close_and_report();
    if let Err(EventLoopError::Os(error)) = run {
        return Err(WindowError::Failed(Error::failure(strip_source_location(&error))));
    }
    if let Err(WindowError::Unavailable(_)) = closed {
        // The demo may follow, on an empty world.
        resident.world.clear();
    }
    closed
}
