//! The window's events, frame by frame.

mod ends;
mod input;
mod steps;

use std::sync::Arc;
use std::time::{Duration, Instant};

use paros_core::events::Event as Happened;
use paros_core::size::{Grid, Size};
use paros_core::world::Session;
use paros_shaders::gpu::{self, Path};
use paros_shell::stage::Pace;
use paros_shell::statics::Resident;
use paros_shell::studio::{Note, Studio};
use winit::application::ApplicationHandler;
use winit::dpi::LogicalSize;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, ControlFlow};
use winit::keyboard::ModifiersState;
use winit::window::{Window, WindowId};

use super::display::{Display, takes_drops};
use super::hands::{Hands, RIGHT};
use super::paint::Painted;
use super::panels::{Asked, Outline, Panels, Shown as OnPanels};
use super::script::Script;
use super::view::{Shown, View};
use super::{Closed, Options, opening};
use crate::error::Error;

/// The window's size at first, in points.
const SIZE: LogicalSize<f64> = LogicalSize::new(1180.0, 800.0);

/// How often the world ticks while nothing is drawn.
const UNSEEN: Duration = Duration::from_millis(14);

/// After how long without being asked for a frame a window counts as hidden.
const HIDDEN: Duration = Duration::from_millis(150);

/// Everything that a window ties together.
pub(super) struct App<'a, const N: usize>
where
    Grid<N>: Size,
{
    // Before the window, which it draws into.
    view: Option<View<N>>,
    window: Option<Arc<Window>>,
    display: Option<Display>,
    studio: Studio<'a, N>,
    hands: Hands<N>,
    panels: Panels,
    painted: Painted,
    script: Option<Script>,
    path: Path,
    modifiers: ModifiersState,
    scale: f32,
    pace: Pace,
    begun: Instant,
    last: Instant,
    /// When the last frame was done.
    drawn: Instant,
    /// Whether the last frame had something to be drawn into.
    seen: bool,
    frames: u64,
    losses: u32,
    /// The visitor knows what closing the window would lose.
    warned: bool,
    last_note: String,
    validation: bool,
    messages: Vec<String>,
    done: Result<(), Closed>,
}

impl<'a, const N: usize> App<'a, N>
where
    Grid<N>: Size + Resident<N>,
{
    /// Before the window is there.
    pub(super) fn new(
        mut studio: Studio<'a, N>,
        script: Option<Script>,
        options: &Options,
    ) -> Self {
        if let Some(file) = &options.file {
            studio.open(file, opening::load::<N>);
        }
        if script.is_some() {
            gpu::faults::arm();
        }
        App {
            view: None,
            window: None,
            display: None,
            studio,
            hands: Hands::new(),
            panels: Panels::new(),
            painted: Painted::new(),
            script,
            path: Path::Fast,
            modifiers: ModifiersState::empty(),
            scale: 1.0,
            pace: Pace::default(),
            begun: Instant::now(),
            last: Instant::now(),
            drawn: Instant::now(),
            seen: true,
            frames: 0,
            losses: 0,
            warned: false,
            last_note: String::new(),
            validation: options.validation,
            messages: Vec::new(),
            done: Ok(()),
        }
    }

    /// After the last event: what there is to say.
    pub(super) fn close(mut self) -> Result<String, Closed> {
        self.leave();
        let saved = self.studio.close();
        self.done?;
        saved.map_err(|error| Closed::Failed(error.into()))?;
        if !self.messages.is_empty() {
            self.messages.sort();
            self.messages.dedup();
            let complaints = self.messages.join("\n");
            return Err(Closed::Failed(Error::Failure(format!("validation: {complaints}"))));
        }
        let printed = self.studio.printed();
        Ok(printed.map_or(String::new(), |path| format!("{}\n", path.display())))
    }

    /// Opens the window and what draws into it.
    fn open(&mut self, events: &ActiveEventLoop) -> Result<(), Closed> {
        let unavailable = |error: &dyn core::fmt::Display| Closed::Unavailable(error.to_string());
        let attributes = Window::default_attributes().with_title("Paros").with_inner_size(SIZE);
        let window = events.create_window(attributes).map_err(|error| unavailable(&error))?;
        self.scale = window.scale_factor() as f32;
        self.hands.size = window.inner_size().into();
        self.display = Display::of(&window);
        let view = View::new(&window, self.studio.world(), self.studio.places(), self.validation);
        self.view = Some(view.map_err(|error| unavailable(&error))?);
        self.window = Some(Arc::new(window));
        self.last = Instant::now();
        Ok(())
    }

    /// Lets the device and the window go.
    fn leave(&mut self) {
        if let Some(view) = self.view.take() {
            let places = self.studio.places().clone();
            view.keep_cache(&places, self.studio.keeper());
            self.messages.extend(view.messages());
        }
        let window = self.window.take();
        if self.display.as_ref().is_some_and(Display::is_gone) {
            // There is nothing left to close it with.
            core::mem::forget(window);
        }
    }

    /// The ticks that are due, and what they and others led to.
    fn advance(&mut self, events: &ActiveEventLoop) -> Result<(), Closed> {
        let now = Instant::now();
        let elapsed = now - core::mem::replace(&mut self.last, now);
        self.panels.frame_took(elapsed.as_secs_f32());
        let (due, _) = self.pace.ticks(elapsed);
        // A script goes as fast as it can.
        let ticks = if self.script.is_some() { Pace::CATCH_UP } else { due };
        for _ in 0..ticks {
            self.steps(events)?;
            self.tick();
        }
        if let Some(mode) = self.studio.poll() {
            self.hands.start(mode);
        }
        let notes: Vec<Note> = self.studio.notes().collect();
        for note in notes {
            let (Note::Good(text) | Note::Bad(text)) = &note;
            self.last_note.clone_from(text);
            self.panels.note(note);
        }
        Ok(())
    }

    fn tick(&mut self) {
        let input = self.hands.input(self.studio.world());
        self.studio.tick(&input);
        let world = self.studio.world();
        if let Some(view) = &mut self.view {
            view.note(world);
        }
        if world.events().iter().any(|event| matches!(event, Happened::Started(_))) {
            self.panels.started();
        }
        if let Some(script) = &mut self.script {
            script.ticked();
        }
    }

    /// A frame: panels, then all of it.
    fn draw(&mut self) -> Result<(), gpu::Error> {
        let size = self.hands.size;
        self.lay_out(size);
        let (Some(view), Some(window)) = (&mut self.view, &self.window) else { return Ok(()) };
        let shown = Shown {
            eye: self.hands.orbit.eye(size),
            between: self.pace.between(),
            path: self.path,
        };
        self.seen = view.draw(window, size, self.studio.world(), &shown, &mut self.painted)?;
        self.frames += u64::from(self.seen);
        let settled = !self.studio.is_printing()
            && self.studio.opening().is_none()
            && !self.studio.keeper().is_busy();
        if let Some(script) = &mut self.script
            && self.seen
        {
            script.drawn(settled);
        }
        Ok(())
    }

    fn lay_out(&mut self, size: [u32; 2]) {
        self.panels.input.time = Some(self.begun.elapsed().as_secs_f64());
        let [width, height] = size.map(|pixels| pixels as f32 / self.scale);
        let rect = egui::Rect::from_min_size(egui::Pos2::ZERO, egui::Vec2::new(width, height));
        self.panels.input.screen_rect = Some(rect);
        let root = self.panels.input.viewports.entry(egui::ViewportId::ROOT).or_default();
        root.native_pixels_per_point = Some(self.scale);
        let world = self.studio.world();
        let held = world.held(RIGHT);
        let outline = Outline::of(world, &self.hands.orbit, size);
        let (device, times) = match &self.view {
            Some(view) => (view.device(), view.times()),
            None => ("", gpu::Times::default()),
        };
        let shown = OnPanels {
            session: world.session(),
            mode: world.mode(),
            held,
            depth: held.map_or(0.0, |(tool, _)| self.hands.depth(tool)),
            symmetry: world.symmetry(),
            undo: world.undo_counts(),
            printing: self.studio.is_printing(),
            printed: self.studio.printed(),
            unwritten: self.studio.is_unwritten(),
            fault: self.studio.fault(),
            opening: self.studio.opening(),
            drops: self.window.as_deref().is_some_and(takes_drops),
            fast: self.path == Path::Fast,
            device,
            times,
            outline: outline.as_ref(),
        };
        let (output, asked) = self.panels.lay_out(&shown);
        self.painted.take_textures(&output.textures_delta);
        let scale = output.pixels_per_point;
        let triangles = self.panels.context.tessellate(output.shapes, scale);
        self.painted.take_triangles(&triangles, scale);
        asked.into_iter().for_each(|asked| self.carry_out(asked));
    }

    fn carry_out(&mut self, asked: Asked) {
        match asked {
            Asked::Start(mode) => self.hands.start(mode),
            Asked::CarveOn => {
                let mode = self.studio.adopt();
                self.hands.start(mode);
            }
            Asked::Open(path) => self.studio.open(&path, opening::load::<N>),
            Asked::Take(item) => self.hands.take(item),
            Asked::WriteAgain => self.studio.write_again(),
            Asked::Command(command) => self.hands.command(command),
            Asked::Finish => {
                if self.studio.world().session() == Session::Sculpting {
                    self.hands.command(paros_core::input::commands::FINISH);
                }
            }
        }
    }

    /// Ends the loop for a reason.
    fn stop(&mut self, events: &ActiveEventLoop, done: Result<(), Closed>) {
        if self.done.is_ok() {
            self.done = done;
        }
        events.exit();
    }

    fn redraw(&mut self, events: &ActiveEventLoop) {
        let mut done = self.advance(events);
        if done.is_ok()
            && !events.exiting()
            && let Err(error) = self.draw()
        {
            done = self.lost(&error);
        }
        self.drawn = Instant::now();
        if done.is_err() {
            self.stop(events, done);
        }
    }
}

impl<const N: usize> ApplicationHandler for App<'_, N>
where
    Grid<N>: Size + Resident<N>,
{
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.window.is_none() {
            let opened = self.open(events);
            if opened.is_err() {
                self.stop(events, opened);
            }
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        match event {
            WindowEvent::CloseRequested => self.asked_to_close(events),
            WindowEvent::RedrawRequested => self.redraw(events),
            event => self.device(event),
        }
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        if events.exiting() {
            return;
        }
        if self.display.as_ref().is_some_and(Display::is_gone) {
            self.display_gone();
            events.exit();
            return;
        }
        let Some(window) = &self.window else { return };
        let minimised = window.is_minimized().unwrap_or(false);
        if self.seen && !minimised {
            window.request_redraw();
        }
        // Nothing to draw, or into: the world goes on, and a look is taken from time to time. A
        // compositor that has no use for a frame does not ask for one.
        events.set_control_flow(ControlFlow::WaitUntil(Instant::now() + UNSEEN));
        if self.last.elapsed() < UNSEEN {
            return;
        }
        if !self.seen && !minimised {
            self.redraw(events);
        } else if minimised || self.drawn.elapsed() >= HIDDEN {
            let done = self.advance(events);
            if done.is_err() {
                self.stop(events, done);
            }
        }
    }

    fn exiting(&mut self, _: &ActiveEventLoop) {
        self.leave();
    }
}
