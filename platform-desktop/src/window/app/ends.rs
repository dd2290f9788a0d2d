//! How it ends, and what is saved before: by wish, with the device or with the display.

use core::fmt::Display as Reason;

use paros_core::size::{Grid, Size};
use paros_shaders::gpu;
use paros_shell::statics::Resident;
use winit::event_loop::ActiveEventLoop;

use super::App;
use crate::error::Error;
use crate::window::Closed;
use crate::window::display::Display;
use crate::window::view::View;
use paros_shell::studio::Note;

/// Losses of the device within a run before it is given up.
const LOSSES: u32 = 3;

/// What is said when the window's display has ended.
const DISPLAY_GONE: &str = "the display is gone";

impl<const N: usize> App<'_, N>
where
    Grid<N>: Size + Resident<N>,
{
    /// The device or the window's surface is gone: saves, then begins anew with both.
    pub(super) fn lost(&mut self, error: &gpu::Error) -> Result<(), Closed> {
        let kept = self.kept();
        let failed = |why: &dyn Reason| Closed::Failed(Error::Failure(format!("{why}; {kept}")));
        self.losses += 1;
        if let Some(view) = self.view.take() {
            self.messages.extend(view.messages());
        }
        self.painted.forget_device();
        if self.display.as_ref().is_some_and(Display::has_gone) {
            return Err(failed(&DISPLAY_GONE));
        }
        let Some(window) = self.window.as_ref().filter(|_| self.losses <= LOSSES) else {
            return Err(failed(error));
        };
        let places = self.studio.places();
        let view = View::new(window, self.studio.world(), places, self.validation);
        self.view = Some(view.map_err(|again| failed(&again))?);
        let text = "The picture was lost and is back; nothing else was.";
        self.studio.note(Note::Good(text.into()));
        Ok(())
    }

    /// The display has ended, and the window with it.
    pub(in crate::window) fn display_gone(&mut self) {
        if self.done.is_ok() {
            let kept = self.kept();
            let text = format!("{DISPLAY_GONE}; {kept}");
            self.done = Err(Closed::Failed(Error::Failure(text)));
        }
    }

    /// Saves the session: where, or why not.
    fn kept(&mut self) -> String {
        match self.studio.close() {
            Ok(()) => {
                let folder = self.studio.places().sessions.display();
                format!("the session is saved in {folder}")
            }
            Err(error) => error.to_string(),
        }
    }

    /// Closes the window, but for the first time that something would be lost by it.
    pub(super) fn asked_to_close(&mut self, events: &ActiveEventLoop) {
        match self.studio.close() {
            Err(error) if !self.warned => {
                self.warned = true;
                let text = format!("{error}. Close the window again to go without it.");
                self.studio.note(Note::Bad(text));
            }
            _ => self.stop(events, Ok(())),
        }
    }
}
