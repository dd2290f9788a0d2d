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

/// Options of a window.
#[derive(Clone, Default, Debug)]
pub struct WindowOptions {
    /// A mesh or a volume to start from.
    pub file: Option<PathBuf>,
    /// The automatic choice of the studio's size; `None` if the user set the size.
    pub size_choice: Option<SizeChoice>,
    /// Folder for finished sculptures, instead of the user's own.
    pub folder: Option<PathBuf>,
    /// File for the trace of the last session.
    pub record: Option<PathBuf>,
    /// Script of input, in place of mouse and keys.
    pub script: Option<PathBuf>,
    /// Idle time after which a visitor counts as gone. `Some` for a kiosk: visitors in turn, full screen, no
    /// files and no developer tools.
    pub kiosk: Option<Duration>,
    /// Settings of an exhibition's visits; `None` without visits.
    pub visits: Option<VisitOptions>,
    /// Settings for uploads to a booth at which this machine is enrolled; `None` for no uploads.
    pub booth: Option<BoothSettings>,
    /// Loudness in percent; 0 for no sound.
    pub sound_percent: u32,
    /// Faults of the settings, a line each.
    pub settings_faults: Vec<String>,
    /// `true` to enable Vulkan's validation layer. Its messages are errors.
    pub validation: bool,
}

/// The reason why a window could not open, or closed by itself.
#[derive(Debug)]
pub enum WindowError {
    /// No display, or no suitable Vulkan device. The text names what is missing.
    Unavailable(String),
    /// Bad input, or a later failure.
    Failed(Error),
}

/// Opens the window and runs its event loop. Blocks until the window is closed. Returns a line with the last
/// print's path, or nothing without a print. `draw_picture` draws finished sculptures, on a thread.
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
        // Read the file before the window opens: a bad file is an error even without a display.
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
        // The demo may follow, and needs an empty world.
        resident.world.clear();
    }
    closed
}
