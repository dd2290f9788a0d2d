//! Touch screens: one finger acts as the cursor with the left button down, two fingers orbit the view.

use std::collections::VecDeque;

use paros_core::limits::INTERVALS;
use paros_core::volume::{Grid, Size};
use paros_shell::statics::Resident;
use winit::event::{MouseButton, Touch, TouchPhase};

use super::App;

/// The tracked fingers, and their button events that no frame has processed yet.
#[derive(Debug, Default)]
pub(super) struct Fingers {
    /// The finger that the cursor follows.
    first: Option<u64>,
    second: Option<u64>,
    /// Button events, delivered one a frame: the panels know what is under a finger only a frame after it has
    /// touched.
    clicks: VecDeque<(MouseButton, bool)>,
}

impl Fingers {
    /// Handles a finger's event. Returns `true` if the cursor follows the finger to its position.
    fn note(&mut self, finger: u64, phase: TouchPhase) -> bool {
        let (is_first, is_second) = (self.first == Some(finger), self.second == Some(finger));
        match phase {
            TouchPhase::Started if self.first.is_none() => {
                self.first = Some(finger);
                self.clicks.push_back((MouseButton::Left, true));
                return true;
            }
            TouchPhase::Started if self.second.is_none() && !is_first => {
                self.second = Some(finger);
                self.clicks.extend([(MouseButton::Left, false), (MouseButton::Right, true)]);
            }
            TouchPhase::Ended | TouchPhase::Cancelled if is_first => {
                let button =
                    if self.second.is_some() { MouseButton::Right } else { MouseButton::Left };
                self.clicks.push_back((button, false));
                (self.first, self.second) = (None, None);
                return true;
            }
            TouchPhase::Ended | TouchPhase::Cancelled if is_second => {
                self.clicks.push_back((MouseButton::Right, false));
                self.second = None;
            }
            _ => {}
        }
        is_first && phase == TouchPhase::Moved
    }
}

impl<const N: usize> App<'_, N>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    pub(super) fn handle_touch(&mut self, touch: &Touch) {
        if self.fingers.note(touch.id, touch.phase) {
            self.move_cursor([touch.location.x as f32, touch.location.y as f32]);
        }
    }

    /// Delivers the next queued button event after a frame.
    pub(super) fn click_by_touch(&mut self) {
        if let Some((button, is_down)) = self.fingers.clicks.pop_front() {
            self.handle_button(button, is_down);
            if self.fingers.first.is_none() && self.fingers.clicks.is_empty() {
                // Panels don't stay highlighted after the finger is lifted.
                self.panels.remove_cursor();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use winit::event::MouseButton::{Left, Right};
    use winit::event::TouchPhase::{Cancelled, Ended, Moved, Started};

    use super::Fingers;

    #[test]
    fn a_finger_presses_and_two_look_around() {
        let mut fingers = Fingers::default();
        let events = [(7, Started), (7, Moved), (9, Moved), (7, Ended)];
        assert_eq!(events.map(|(id, phase)| fingers.note(id, phase)), [true, true, false, true]);
        assert_eq!(fingers.clicks, [(Left, true), (Left, false)]);
        fingers.clicks.clear();
        let events =
            [(1, Started), (2, Started), (3, Started), (2, Moved), (1, Moved), (2, Cancelled)];
        let moves = events.map(|(id, phase)| fingers.note(id, phase));
        assert_eq!(moves, [true, false, false, false, true, false]);
        assert_eq!(fingers.clicks, [(Left, true), (Left, false), (Right, true), (Right, false)]);
        fingers.clicks.clear();
        // The first finger is still down, and presses nothing until it is lifted and put down again.
        assert!(fingers.note(1, Ended) && fingers.note(2, Started));
        assert_eq!(fingers.clicks, [(Left, false), (Left, true)]);
    }
}
