//! The cursor over the panels. Button events keep the position at which they occurred, even if frames are
//! slow.

use egui::{Event, Modifiers, Order, PointerButton, Pos2};

use super::Panels;

impl Panels {
    /// Moves the cursor to a pixel of the window.
    pub(in crate::window) fn move_cursor(&mut self, pixel: [f32; 2]) {
        let at = Pos2::new(pixel[0], pixel[1]) / self.pixels_per_point;
        self.cursor = Some(at);
        self.input.events.push(Event::PointerMoved(at));
    }

    /// Notes that the cursor has left the window, or the finger the screen.
    pub(in crate::window) fn remove_cursor(&mut self) {
        self.cursor = None;
        self.input.events.push(Event::PointerGone);
    }

    /// Presses or releases a button at the cursor's position.
    pub(in crate::window) fn press_button(&mut self, button: PointerButton, pressed: bool) {
        let Some(pos) = self.cursor else { return };
        let modifiers = Modifiers::NONE;
        self.input.events.push(Event::PointerButton { pos, button, pressed, modifiers });
    }

    /// Returns `true` if the cursor is over a panel, or a panel is in use.
    #[must_use]
    pub(in crate::window) fn wants_pointer(&self) -> bool {
        let layer = self.cursor.and_then(|at| self.context.layer_id_at(at));
        let is_over = layer.is_some_and(|layer| layer.order != Order::Background);
        is_over || self.context.is_using_pointer()
    }
}

/// Splits events wherever the cursor moves after a button event. Returns at least one part.
pub(super) fn split_by_places(events: &[Event]) -> impl Iterator<Item = &[Event]> {
    let is_button = |event: &Event| matches!(event, Event::PointerButton { .. });
    let parts = events.chunk_by(move |before, after| !is_button(before) || is_button(after));
    let none = events.is_empty().then_some(events);
    parts.chain(none)
}

#[cfg(test)]
mod tests {
    use paros_core::session::{BenchItem, ToolBit};

    use super::*;
    use crate::window::panels::PanelAction;
    use crate::window::panels::tests::{click, frame, in_studio, sculpting_status};

    const CHISEL: PanelAction = PanelAction::Take(BenchItem::Bit(ToolBit::FlatChisel));

    /// Returns a position at which a click takes the flat chisel.
    fn find_chisel() -> Pos2 {
        let places = (0..100).flat_map(|y| (0..50).map(move |x| (x, y)));
        let mut places = places.map(|(x, y)| Pos2::new(20.0 * x as f32, 7.0 * y as f32));
        let takes = |at: &Pos2| {
            let mut panels = in_studio();
            frame(&mut panels, &sculpting_status(), Vec::new());
            click(&mut panels, &sculpting_status(), *at).contains(&CHISEL)
        };
        places.find(takes).expect("it is in the tool bar")
    }

    #[test]
    fn a_click_counts_where_it_was_made_when_the_cursor_goes_on_before_the_next_frame() {
        let (there, elsewhere) = (find_chisel(), Pos2::new(500.0, 300.0));
        let status = sculpting_status();
        let act = |moves: [Pos2; 2]| {
            let mut panels = in_studio();
            for _ in 0..2 {
                frame(&mut panels, &status, Vec::new());
            }
            panels.set_window([1000, 700], 1.0);
            panels.move_cursor(moves[0].into());
            panels.press_button(PointerButton::Primary, true);
            panels.press_button(PointerButton::Primary, false);
            panels.move_cursor(moves[1].into());
            let is_over = panels.wants_pointer();
            (panels.lay_out(&status).1, is_over)
        };
        assert_eq!(act([there, elsewhere]), (vec![CHISEL], false));
        assert_eq!(act([elsewhere, there]), (vec![], true), "it was pressed elsewhere");
    }

    #[test]
    fn events_are_split_where_the_cursor_goes_on_after_a_button() {
        let moved = || Event::PointerMoved(Pos2::ZERO);
        let pressed = |pressed| Event::PointerButton {
            pos: Pos2::ZERO,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        };
        let events =
            [moved(), moved(), pressed(true), moved(), pressed(false), pressed(true), moved()];
        let parts: Vec<usize> = split_by_places(&events).map(<[Event]>::len).collect();
        assert_eq!(parts, [3, 3, 1]);
        assert_eq!(split_by_places(&[]).count(), 1, "there is a frame without events too");
    }
}
