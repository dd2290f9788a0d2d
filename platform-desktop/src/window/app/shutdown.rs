//! Shutdown and recovery, with a save first: window closed, device lost, display lost.

use core::fmt::Display as Reason;

use paros_core::limits::INTERVALS;
use paros_core::volume::{Grid, Size};
use paros_headless::Error;
use paros_shaders::gpu;
use paros_shell::statics::Resident;
use winit::event_loop::ActiveEventLoop;

use super::App;
use crate::window::WindowError;
use crate::window::display::DisplayConnection;
use crate::window::view::WindowRenderer;
use paros_shell::studio::Notice;

/// Maximum number of recovered device losses in a run.
const LOSSES: u32 = 3;

/// The message when the display connection is lost.
const DISPLAY_GONE: &str = "the display is gone";

impl<const N: usize> App<'_, N>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    /// Recovers from a lost device or surface: saves the session, then recreates both.
    ///
    /// # Errors
    /// The display is lost too, there were more than [`LOSSES`] losses, or no device can be opened.
    pub(super) fn recover_device(&mut self, error: &gpu::Error) -> Result<(), WindowError> {
        let kept = self.save_and_describe_where();
        let failed =
            |why: &dyn Reason| WindowError::Failed(Error::Failure(format!("{why}; {kept}")));
        self.losses += 1;
        if let Some(view) = self.view.take() {
            self.messages.extend(view.validation_messages());
        }
        self.egui_buffers.mark_atlas_changed();
        if self.display.as_ref().is_some_and(DisplayConnection::poll_is_lost) {
            return Err(failed(&DISPLAY_GONE));
        }
        let Some(window) = self.window.as_ref().filter(|_| self.losses <= LOSSES) else {
            return Err(failed(error));
        };
        let paths = self.studio.paths();
        let view = WindowRenderer::new(window, self.studio.world(), paths, &self.device);
        self.view = Some(view.map_err(|again| failed(&again))?);
        let text = "The picture was lost and is back; nothing else was.";
        self.studio.push_notice(Notice::Good(text.into()));
        Ok(())
    }

    /// Saves the session when the display connection is lost, and ends the application with that error.
    pub(in crate::window) fn on_display_lost(&mut self) {
        if self.done.is_ok() {
            let kept = self.save_and_describe_where();
            let text = format!("{DISPLAY_GONE}; {kept}");
            self.done = Err(WindowError::Failed(Error::Failure(text)));
        }
    }

    /// Saves the session. Returns a text that names the folder, or the reason of a failure.
    fn save_and_describe_where(&mut self) -> String {
        match self.studio.save_all_and_wait() {
            Ok(()) => {
                let folder = self.studio.paths().sessions.display();
                format!("the session is saved in {folder}")
            }
            Err(error) => error.to_string(),
        }
    }

    /// Closes the window. If the session can't be saved, the first request only warns.
    pub(super) fn close_or_warn(&mut self, events: &ActiveEventLoop) {
        self.keep_last_use_before_end();
        match self.studio.save_all_and_wait() {
            Err(error) if !self.warned => {
                self.warned = true;
                let text = format!("{error}. Close the window again to go without it.");
                self.studio.push_notice(Notice::Bad(text));
            }
            _ => self.exit_loop(events, Ok(())),
        }
    }
}
