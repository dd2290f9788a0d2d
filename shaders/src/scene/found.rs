//! The light of a find: once the hidden figure is found, the sun warms and the room around it dims.

use paros_core::session::FOUND_PERCENT;
use paros_core::volume::{Grid, Size};
use paros_core::{World, WorldEvent};

/// Time that the light takes to change, in seconds.
const CHANGE_SECONDS: f32 = 2.5;

/// State of the light: whether the session's figure is found, and how far the light has changed since.
#[derive(Clone, Copy, Debug)]
pub(super) struct FoundLight {
    is_found: bool,
    part: f32,
}

impl FoundLight {
    pub(super) const fn new() -> Self {
        FoundLight { is_found: false, part: 0.0 }
    }

    /// Follows a tick. A figure found before the first tick that is seen is lit at once.
    pub(super) fn follow_tick<const N: usize, const K: usize>(
        &mut self,
        world: &World<N, K>,
        is_first: bool,
    ) where
        Grid<N>: Size,
    {
        if is_first && world.bared_ends().percent() >= FOUND_PERCENT {
            *self = FoundLight { is_found: true, part: 1.0 };
        }
        for event in world.events() {
            match event {
                WorldEvent::Started(_) => *self = Self::new(),
                WorldEvent::Found => self.is_found = true,
                _ => {}
            }
        }
    }

    pub(super) fn advance_time(&mut self, seconds: f32) {
        if self.is_found {
            self.part = (self.part + seconds.max(0.0) / CHANGE_SECONDS).min(1.0);
        }
    }

    /// Returns how far the light has changed, 0 to 1, smoothed at both ends.
    pub(super) fn smooth_part(&self) -> f32 {
        self.part * self.part * (3.0 - 2.0 * self.part)
    }
}

#[cfg(test)]
mod tests {
    use super::{CHANGE_SECONDS, FoundLight};

    #[test]
    fn the_light_changes_once_the_figure_is_found() {
        let mut light = FoundLight::new();
        light.advance_time(CHANGE_SECONDS);
        assert_eq!(light.smooth_part(), 0.0);
        light.is_found = true;
        light.advance_time(0.5 * CHANGE_SECONDS);
        assert!((light.smooth_part() - 0.5).abs() < 1e-3);
        light.advance_time(CHANGE_SECONDS);
        assert_eq!(light.smooth_part(), 1.0);
    }
}
