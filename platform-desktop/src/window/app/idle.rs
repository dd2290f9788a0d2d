//! Idle time of the window. Kiosks and visits derive from it that their visitor has left.

use std::time::Duration;

use paros_core::session::TICK_RATE;
use winit::event::WindowEvent;

/// Ticks after the last event during which a window counts as used: the mouse rests while its visitor looks
/// or reads.
const REST_TICKS: u32 = 15 * TICK_RATE;

/// Counts the ticks since mouse, keys or touch were last used. Time is counted in ticks, so that idle times
/// of scripts are reproducible.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
pub(super) struct IdleWatch {
    /// Ticks since the last use, or since the window was opened.
    ticks: u32,
    has_been_used: bool,
    cursor: Option<[f32; 2]>,
}

impl IdleWatch {
    /// Advances the idle time by `ticks`, dropped ticks included.
    pub(super) const fn pass(&mut self, ticks: u32) {
        self.ticks = self.ticks.saturating_add(ticks);
    }

    /// Returns the time since the last use, or since the window was opened.
    pub(super) fn time(&self) -> Duration {
        Duration::from_secs(self.ticks.into()) / TICK_RATE
    }

    /// Notes a window event. A cursor event without movement, as when the window opens under the cursor, is
    /// no use.
    pub(super) fn note_event(&mut self, event: &WindowEvent) {
        let is_use = match event {
            WindowEvent::CursorMoved { position, .. } => {
                let at = [position.x as f32, position.y as f32];
                self.cursor.replace(at).is_some_and(|before| before != at)
            }
            WindowEvent::MouseInput { .. }
            | WindowEvent::MouseWheel { .. }
            | WindowEvent::KeyboardInput { .. }
            | WindowEvent::Touch(_) => true,
            _ => false,
        };
        if is_use {
            self.note_use();
        }
    }

    /// Restarts the idle time.
    pub(super) const fn note_use(&mut self) {
        (self.ticks, self.has_been_used) = (0, true);
    }

    /// Returns `true` while the visitor is active. A window that was never used has no visitor.
    pub(super) const fn is_in_use(&self) -> bool {
        self.has_been_used && self.ticks < REST_TICKS
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use winit::dpi::PhysicalPosition;
    use winit::event::{DeviceId, WindowEvent};

    use super::{IdleWatch, REST_TICKS};

    #[test]
    fn a_window_is_in_use_until_its_visitor_has_rested_for_long() {
        let mut watch = IdleWatch::default();
        watch.pass(72);
        assert!(!watch.is_in_use(), "nobody yet");
        assert_eq!(watch.time(), Duration::from_secs(1));
        watch.note_use();
        watch.pass(REST_TICKS - 1);
        assert!(watch.is_in_use());
        watch.pass(1);
        assert!(!watch.is_in_use());
        assert_eq!(watch.time(), Duration::from_secs(15));
    }

    #[test]
    fn a_cursor_that_moves_is_a_use_and_one_that_is_found_or_stays_is_not() {
        let mut watch = IdleWatch::default();
        let uses = [3.0, 3.0, 4.0].map(|x| {
            let position = PhysicalPosition::new(x, 7.0);
            let device_id = DeviceId::dummy();
            watch.note_event(&WindowEvent::CursorMoved { device_id, position });
            watch.is_in_use()
        });
        assert_eq!(uses, [false, false, true]);
        watch.pass(REST_TICKS);
        watch.note_event(&WindowEvent::Focused(true));
        assert!(!watch.is_in_use());
    }
}
