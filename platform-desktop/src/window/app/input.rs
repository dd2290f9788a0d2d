//! Window events of the mouse, the keyboard and dropped files.

use paros_core::limits::INTERVALS;
use paros_core::session::SessionState;
use paros_core::volume::{Grid, Size};
use paros_shaders::gpu::{PaperVariant, RenderPath};
use paros_shell::statics::Resident;
use paros_shell::studio::Notice;
use winit::event::{ElementState, MouseButton, MouseScrollDelta, WindowEvent};

use super::App;
use crate::window::hands::{HandAction, HandButton, InputEvent};
use crate::window::keys::{self, KeyCommand};
use crate::window::opening;

/// Touchpad scroll distance that counts as one wheel notch, in pixels.
const NOTCH_PIXELS: f64 = 40.0;

/// Notice shown when a sculpting key is pressed on a finished sculpture.
const FINISHED_HELP: &str = "It is finished: \"Carve on\" goes on with it.";

/// Returns `true` if a key of the hands has an effect in a session of this state.
fn is_key_of_use(key: HandAction, session: SessionState) -> bool {
    match session {
        SessionState::Waiting => false,
        SessionState::Sculpting => true,
        SessionState::Finished => key.is_for_looking(),
    }
}

impl<const N: usize> App<'_, N>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    /// Handles an event of an input device or of the window itself.
    pub(super) fn handle_event(&mut self, event: WindowEvent) {
        self.idle.note_event(&event);
        match event {
            WindowEvent::Touch(touch) => self.handle_touch(&touch),
            WindowEvent::Resized(size) => {
                self.hands.size = size.into();
                self.seen = true;
                if let Some(view) = &mut self.view {
                    view.mark_resized();
                }
            }
            WindowEvent::ScaleFactorChanged { scale_factor, .. } => {
                self.scale = scale_factor as f32;
            }
            WindowEvent::Occluded(false) => self.seen = true,
            WindowEvent::DroppedFile(path) if !self.kiosk.is_on && self.visits.is_none() => {
                self.studio.open_file(&path, opening::read_into_resident_maps::<N>);
            }
            WindowEvent::Focused(false) => self.send_to_hands(InputEvent::LetGo),
            WindowEvent::ModifiersChanged(modifiers) => {
                self.modifiers = modifiers.state();
                self.send_to_hands(InputEvent::Lightly(self.modifiers.shift_key()));
            }
            WindowEvent::CursorMoved { position, .. } => {
                self.move_cursor([position.x as f32, position.y as f32]);
            }
            WindowEvent::CursorLeft { .. } => {
                self.send_to_hands(InputEvent::Gone);
                self.panels.remove_cursor();
            }
            WindowEvent::MouseInput { state, button, .. } => {
                self.handle_button(button, state == ElementState::Pressed);
            }
            WindowEvent::MouseWheel { delta, .. } => self.handle_wheel(delta),
            WindowEvent::KeyboardInput { event, .. } => {
                let down = event.state == ElementState::Pressed;
                if let Some(command) = keys::command_of_pressed_key(&event, self.modifiers)
                    && !(event.repeat && down)
                {
                    self.handle_key(command, down);
                }
            }
            _ => {}
        }
    }

    /// Passes on the cursor's position, in pixels from the upper left.
    pub(super) fn move_cursor(&mut self, to: [f32; 2]) {
        self.send_to_hands(InputEvent::Moved(to));
        self.panels.move_cursor(to);
    }

    /// Passes an input event to the hands.
    pub(super) fn send_to_hands(&mut self, event: InputEvent) {
        self.hands.handle_event(event, self.studio.world());
    }

    /// Runs the command of a key that was pressed or released.
    pub(super) fn handle_key(&mut self, command: KeyCommand, down: bool) {
        let session = self.studio.world().session_state();
        let uncovered = self.panels.is_sculpture_uncovered();
        if !self.kiosk.allows(command) {
            return;
        }
        match command {
            // Releases always count, even over a panel. While a visit's panel asks a question, pressed keys
            // don't change the tools behind it.
            KeyCommand::Hands(_) if down && self.is_visit_asking() => {}
            KeyCommand::Hands(key) if !down || uncovered && is_key_of_use(key, session) => {
                self.send_to_hands(InputEvent::Key(key, down));
            }
            _ if !down => {}
            KeyCommand::Hands(_)
                if uncovered && session == SessionState::Finished && self.visits.is_none() =>
            {
                self.panels.show_notice(Notice::Good(FINISHED_HELP.into()));
            }
            KeyCommand::Hands(_) => {}
            KeyCommand::Finish if self.visits.is_some() => self.ask_visitor_to_finish(),
            KeyCommand::Staff => self.ask_staff(),
            KeyCommand::Finish => self.panels.confirm_start_or_ask_to_finish(session),
            KeyCommand::Help => self.panels.toggle_help(),
            KeyCommand::Graph => self.panels.toggle_graph(),
            KeyCommand::Path => {
                self.path = match self.path {
                    RenderPath::Fast => RenderPath::Paper(PaperVariant::Whole),
                    RenderPath::Paper(_) => RenderPath::Fast,
                };
            }
            KeyCommand::Record => self.studio.submit_trace_and_own_volume(),
            // Visits have no start panel.
            KeyCommand::Back if self.visits.is_some() => self.close_topmost_in_visit(),
            KeyCommand::Back => self.panels.close_topmost_or_toggle_start(session),
        }
    }

    pub(super) fn handle_button(&mut self, button: MouseButton, down: bool) {
        let (hand, panel) = match button {
            MouseButton::Left => (HandButton::Left, egui::PointerButton::Primary),
            MouseButton::Middle => (HandButton::Middle, egui::PointerButton::Middle),
            MouseButton::Right => (HandButton::Right, egui::PointerButton::Secondary),
            _ => return,
        };
        self.panels.press_button(panel, down);
        let is_on_panel = self.is_cursor_on_visit_panel();
        if hand == HandButton::Left && !(down && self.panels.wants_pointer()) {
            self.press_in_visit(down);
        }
        let has_sculpture = self.studio.world().session_state() != SessionState::Waiting;
        let runs =
            hand != HandButton::Left || (has_sculpture && self.panels.is_sculpture_uncovered());
        if !down {
            self.send_to_hands(InputEvent::Released(hand));
        } else if runs && !self.panels.wants_pointer() && !is_on_panel {
            self.send_to_hands(InputEvent::Pressed(hand));
        }
    }

    fn handle_wheel(&mut self, delta: MouseScrollDelta) {
        let notches = match delta {
            MouseScrollDelta::LineDelta(_, y) => y,
            MouseScrollDelta::PixelDelta(by) => (by.y / NOTCH_PIXELS) as f32,
        };
        if self.panels.wants_pointer() {
            self.panels.input.events.push(egui::Event::MouseWheel {
                unit: egui::MouseWheelUnit::Line,
                delta: egui::Vec2::new(0.0, notches),
                modifiers: egui::Modifiers::NONE,
            });
        } else if self.modifiers.control_key() {
            self.send_to_hands(InputEvent::Zoom(notches));
        } else {
            self.send_to_hands(InputEvent::Wheel(notches));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_finished_can_be_looked_at_by_keys_and_not_be_worked_on() {
        let of_use = |key| {
            use SessionState::{Finished, Sculpting, Waiting};
            [Waiting, Sculpting, Finished].map(|session| is_key_of_use(key, session))
        };
        for key in [HandAction::Nearer, HandAction::Farther] {
            assert_eq!(of_use(key), [false, true, true], "{key:?}");
        }
        for key in [HandAction::Tool(1), HandAction::Undo, HandAction::Turn { left: true }] {
            assert_eq!(of_use(key), [false, true, false], "{key:?}");
        }
    }
}
