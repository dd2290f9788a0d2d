//! What the window tells of mouse, keys and files.

use paros_core::size::{Grid, Size};
use paros_core::world::Session;
use paros_shaders::gpu::{Parts, Path};
use paros_shell::statics::Resident;
use winit::event::{ElementState, MouseButton, MouseScrollDelta, WindowEvent};

use super::App;
use crate::window::hands::{Button, Event};
use crate::window::keys::{self, Command};
use crate::window::opening;

/// Pixels of a touchpad that count as a notch of a wheel.
const NOTCH: f64 = 40.0;

impl<const N: usize> App<'_, N>
where
    Grid<N>: Size + Resident<N>,
{
    /// Takes in an event of a device, or of the window itself.
    pub(super) fn device(&mut self, event: WindowEvent) {
        match event {
            WindowEvent::Resized(size) => {
                self.hands.size = size.into();
                self.seen = true;
                if let Some(view) = &mut self.view {
                    view.resized();
                }
            }
            WindowEvent::ScaleFactorChanged { scale_factor, .. } => {
                self.scale = scale_factor as f32;
            }
            WindowEvent::Occluded(false) => self.seen = true,
            WindowEvent::DroppedFile(path) => self.studio.open(&path, opening::load::<N>),
            WindowEvent::Focused(false) => self.hand(Event::LetGo),
            WindowEvent::ModifiersChanged(modifiers) => self.modifiers = modifiers.state(),
            WindowEvent::CursorMoved { position, .. } => {
                self.moved([position.x as f32, position.y as f32]);
            }
            WindowEvent::CursorLeft { .. } => {
                self.hand(Event::Gone);
                self.panels.input.events.push(egui::Event::PointerGone);
            }
            WindowEvent::MouseInput { state, button, .. } => {
                self.button(button, state == ElementState::Pressed);
            }
            WindowEvent::MouseWheel { delta, .. } => self.wheel(delta),
            WindowEvent::KeyboardInput { event, .. } => {
                let down = event.state == ElementState::Pressed;
                if let Some(command) = keys::command(&event, self.modifiers)
                    && !(event.repeat && down)
                {
                    self.key(command, down);
                }
            }
            _ => {}
        }
    }

    /// The cursor is at a pixel.
    pub(super) fn moved(&mut self, to: [f32; 2]) {
        self.hand(Event::Moved(to));
        let at = egui::Pos2::new(to[0] / self.scale, to[1] / self.scale);
        self.panels.input.events.push(egui::Event::PointerMoved(at));
    }

    /// The hands do something.
    pub(super) fn hand(&mut self, event: Event) {
        self.hands.event(event, self.studio.world());
    }

    /// A key went down or up.
    pub(super) fn key(&mut self, command: Command, down: bool) {
        let session = self.studio.world().session();
        let sculpting = session == Session::Sculpting && self.panels.is_open();
        match command {
            // A key that is let go is let go everywhere.
            Command::Hands(key) if sculpting || !down => self.hand(Event::Key(key, down)),
            _ if !down => {}
            Command::Hands(_) => {}
            Command::Finish => self.panels.finish(session),
            Command::Help => self.panels.switch_help(),
            Command::Graph => self.panels.switch_graph(),
            Command::Path => {
                self.path = match self.path {
                    Path::Fast => Path::Paper(Parts::Whole),
                    Path::Paper(_) => Path::Fast,
                };
            }
            Command::Record => self.studio.write_trace(),
            Command::Back => self.panels.back(session),
        }
    }

    fn button(&mut self, button: MouseButton, down: bool) {
        let (hand, panel) = match button {
            MouseButton::Left => (Button::Left, egui::PointerButton::Primary),
            MouseButton::Middle => (Button::Middle, egui::PointerButton::Middle),
            MouseButton::Right => (Button::Right, egui::PointerButton::Secondary),
            _ => return,
        };
        if let Some(pos) = self.panels.context.input(|input| input.pointer.latest_pos()) {
            let modifiers = egui::Modifiers::NONE;
            let event = egui::Event::PointerButton { pos, button: panel, pressed: down, modifiers };
            self.panels.input.events.push(event);
        }
        let sculpting = self.studio.world().session() == Session::Sculpting;
        let runs = hand != Button::Left || (sculpting && self.panels.is_open());
        if !down {
            self.hand(Event::Released(hand));
        } else if runs && !self.panels.has_cursor() {
            self.hand(Event::Pressed(hand));
        }
    }

    fn wheel(&mut self, delta: MouseScrollDelta) {
        let notches = match delta {
            MouseScrollDelta::LineDelta(_, y) => y,
            MouseScrollDelta::PixelDelta(by) => (by.y / NOTCH) as f32,
        };
        if self.panels.has_cursor() {
            self.panels.input.events.push(egui::Event::MouseWheel {
                unit: egui::MouseWheelUnit::Line,
                delta: egui::Vec2::new(0.0, notches),
                modifiers: egui::Modifiers::NONE,
            });
        } else if self.modifiers.control_key() {
            self.hand(Event::Zoom(notches));
        } else {
            self.hand(Event::Wheel(notches));
        }
    }
}
