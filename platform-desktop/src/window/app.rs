//! The window's events, frame by frame.

mod actions;
mod idle;
mod input;
mod kiosk;
mod layout;
mod shutdown;
mod steps;
mod touch;
mod visits;

use std::io::{self, Write as _};
use std::sync::Arc;
use std::time::{Duration, Instant};

use paros_core::WorldEvent as Happened;
use paros_core::limits::INTERVALS;
use paros_core::volume::{Grid, Size};
use paros_headless::Error;
use paros_shaders::Image;
use paros_shaders::gpu::{self, RenderPath};
use paros_shell::statics::Resident;
use paros_shell::studio::{Notice, Studio};
use paros_shell::tick_runner::TickClock;
use paros_sound::{SoundDevice, Speaker};
use paros_upload::courier::Courier;
use winit::application::ApplicationHandler;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, ControlFlow};
use winit::keyboard::ModifiersState;
use winit::window::{Window, WindowId};

use super::display::DisplayConnection;
use super::first_size::first_size;
use super::hands::MouseHands;
use super::os_error::strip_source_location;
use super::paint::EguiBuffers;
use super::panels::{PanelAction, Panels};
use super::script::Script;
use super::slowness::SlownessWatch;
use super::view::{FrameParams, WindowRenderer};
use super::{WindowError, WindowOptions};
use idle::IdleWatch;
use kiosk::Kiosk;
use touch::Fingers;
use visits::WindowVisits;

/// Poll interval of the event loop while the window is hidden.
const UNSEEN: Duration = Duration::from_millis(14);

/// Time without a redraw request after which the window counts as hidden.
const HIDDEN: Duration = Duration::from_millis(150);

/// Starts sound output on the system's own device.
fn start_speaker(options: &WindowOptions) -> Option<Speaker> {
    Speaker::spawn(SoundDevice::of_system(), options.sound_percent, |line| {
        // Standard error may be closed.
        let _ = writeln!(io::stderr(), "paros: {line}");
    })
}

/// The application: a window, its renderer, the studio and the user interface.
pub(super) struct App<'a, const N: usize>
where
    Grid<N>: Size,
{
    // Declared before the window so that it drops first: it draws into the window.
    view: Option<WindowRenderer<N>>,
    window: Option<Arc<Window>>,
    display: Option<DisplayConnection>,
    pub(super) studio: Studio<'a, N>,
    /// The link to the booth; `None` if the device isn't enrolled.
    pub(super) courier: Option<Arc<Courier>>,
    hands: MouseHands<N>,
    panels: Panels,
    egui_buffers: EguiBuffers,
    script: Option<Script>,
    /// Sound output; `None` if sound is off or unavailable.
    pub(super) speaker: Option<Speaker>,
    path: RenderPath,
    modifiers: ModifiersState,
    fingers: Fingers,
    idle: IdleWatch,
    kiosk: Kiosk,
    /// The visits of an exhibition; `None` outside exhibitions.
    pub(super) visits: Option<WindowVisits>,
    scale: f32,
    pace: TickClock,
    slowness: SlownessWatch,
    begun: Instant,
    last: Instant,
    /// Time of the end of the last frame.
    drawn: Instant,
    /// `true` if the last frame had an image to draw into.
    seen: bool,
    frames: u64,
    losses: u32,
    /// `true` once the visitor was warned that closing loses unsaved work.
    warned: bool,
    last_notice: String,
    /// Options for opening the Vulkan device.
    device: gpu::Options,
    messages: Vec<String>,
    done: Result<(), WindowError>,
}

impl<'a, const N: usize> App<'a, N>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    /// Creates the application. Its window opens later.
    pub(super) fn new(
        (mut studio, courier): (Studio<'a, N>, Option<Arc<Courier>>),
        script: Option<Script>,
        start_pictures: &Image,
        options: &WindowOptions,
    ) -> Self {
        let is_for_visitors = options.kiosk.is_some() || options.visits.is_some();
        if let Some(choice) = options.size_choice.filter(|_| !is_for_visitors) {
            studio.push_notice(Notice::Good(choice.to_string()));
        }
        if !is_for_visitors {
            // Visitors can't correct faulty settings.
            let faults = options.settings_faults.iter().cloned();
            faults.for_each(|fault| studio.push_notice(Notice::Bad(fault)));
        }
        match &options.file {
            Some(file) if options.visits.is_some() => {
                let text = "not opened: where visits are held, their panels have the starts";
                studio.push_notice(Notice::Bad(format!("{}: {text}", file.display())));
            }
            // `open` has read the file into the resident maps.
            Some(file) => studio.open_file(file, |_| Ok(())),
            None => {}
        }
        let device = gpu::Options {
            validation: options.validation,
            // A script may inject driver failures.
            device_hook: script.is_some().then_some(paros_faults::wrap_device as _),
            ..gpu::Options::default()
        };
        let mut panels = Panels::new();
        panels.set_start_pictures(start_pictures);
        let visits = options.visits.as_ref().map(|visits| WindowVisits::new(visits, &studio));
        if visits.is_some() {
            panels.close_covering_panels();
        }
        App {
            view: None,
            window: None,
            display: None,
            studio,
            courier,
            hands: MouseHands::new(),
            panels,
            egui_buffers: EguiBuffers::new(),
            speaker: start_speaker(options),
            script,
            path: RenderPath::Fast,
            modifiers: ModifiersState::empty(),
            fingers: Fingers::default(),
            idle: IdleWatch::default(),
            kiosk: Kiosk::new(options.kiosk, visits.is_some()),
            visits,
            scale: 1.0,
            pace: TickClock::default(),
            slowness: SlownessWatch::default(),
            begun: Instant::now(),
            last: Instant::now(),
            drawn: Instant::now(),
            seen: true,
            frames: 0,
            losses: 0,
            warned: false,
            last_notice: String::new(),
            device,
            messages: Vec::new(),
            done: Ok(()),
        }
    }

    /// Saves the session after the last event. Returns a line with the last print's path.
    pub(super) fn close_and_report(mut self) -> Result<String, WindowError> {
        self.drop_window();
        self.keep_last_use_before_end();
        let saved = self.studio.save_all_and_wait();
        self.done?;
        saved.map_err(|error| WindowError::Failed(error.into()))?;
        if !self.messages.is_empty() {
            self.messages.sort();
            self.messages.dedup();
            let complaints = self.messages.join("\n");
            return Err(WindowError::Failed(Error::Failure(format!("validation: {complaints}"))));
        }
        let printed = self.studio.session_stl_path();
        Ok(printed.map_or(String::new(), |path| format!("{}\n", path.display())))
    }

    /// Opens the window and its renderer.
    fn open_window(&mut self, events: &ActiveEventLoop) -> Result<(), WindowError> {
        let unavailable =
            |error: &dyn core::fmt::Display| WindowError::Unavailable(error.to_string());
        let size = first_size(events, self.script.is_some());
        let attributes = Window::default_attributes().with_title("Paros").with_inner_size(size);
        let attributes = attributes.with_fullscreen(self.kiosk.full_screen());
        let window = events.create_window(attributes);
        let window = window.map_err(|error| unavailable(&strip_source_location(&error)))?;
        self.scale = window.scale_factor() as f32;
        self.hands.size = window.inner_size().into();
        self.display = DisplayConnection::watch_window(&window);
        let view =
            WindowRenderer::new(&window, self.studio.world(), self.studio.paths(), &self.device);
        self.view = Some(view.map_err(|error| unavailable(&error))?);
        self.window = Some(Arc::new(window));
        self.last = Instant::now();
        Ok(())
    }

    /// Drops the renderer and the window. The pipeline cache is saved first.
    fn drop_window(&mut self) {
        if let Some(view) = self.view.take() {
            let paths = self.studio.paths().clone();
            view.submit_pipeline_cache(&paths, self.studio.file_writer());
            self.messages.extend(view.validation_messages());
        }
        let window = self.window.take();
        if self.display.as_ref().is_some_and(DisplayConnection::is_known_lost) {
            // The window can't be destroyed without a connection.
            core::mem::forget(window);
        }
    }

    /// Runs the ticks that are due, and handles finished background work and notices.
    fn run_due_ticks(&mut self, events: &ActiveEventLoop) -> Result<(), WindowError> {
        let now = Instant::now();
        let elapsed = now - core::mem::replace(&mut self.last, now);
        self.panels.add_frame_time(elapsed.as_secs_f32());
        self.hand_over_if_gone();
        let due = self.pace.take_due_ticks(elapsed);
        // A script runs as fast as possible and drops no ticks.
        let ticks = if let Some(script) = &self.script {
            script.ticks_of_frame()
        } else {
            self.slowness.note_frame(elapsed, due);
            self.idle.pass(due.dropped);
            due.due
        };
        for _ in 0..ticks {
            self.run_script_steps(events)?;
            self.run_tick();
        }
        if self.studio.poll_background_work() {
            // Only once the file has been read: a file that can't be opened is no start.
            self.panels.ask_to_start(PanelAction::StartRead);
        }
        let notices: Vec<Notice> = self.studio.take_notices().collect();
        for notice in notices {
            let (Notice::Good(text) | Notice::Bad(text)) = &notice;
            self.last_notice.clone_from(text);
            self.panels.show_notice(notice);
        }
        Ok(())
    }

    fn run_tick(&mut self) {
        let mut input = self.hands.next_input(self.studio.world());
        self.fill_visit_input(&mut input);
        self.studio.run_tick(&input);
        self.follow_visit_tick();
        self.follow_booth();
        self.idle.pass(1);
        let world = self.studio.world();
        if let Some(view) = &mut self.view {
            view.note_tick(world);
        }
        if let Some(speaker) = &mut self.speaker {
            speaker.play_tick(world, &input);
        }
        if world.events().iter().any(|event| matches!(event, Happened::Started(_))) {
            self.panels.close_covering_panels();
        }
        if let Some(script) = &mut self.script {
            script.count_tick();
        }
    }

    /// Draws a frame: lays the panels out, then draws the scene with them.
    fn draw_frame(&mut self) -> Result<(), gpu::Error> {
        let size = self.hands.size;
        self.lay_out_panels_and_act(size);
        self.place_visit_panels();
        let (Some(view), Some(window)) = (&mut self.view, &self.window) else { return Ok(()) };
        if let Some(visits) = &mut self.visits {
            visits.host.hand_over_previews(|cell, picture| view.set_panel_picture(cell, picture));
        }
        // The visit's panels are hidden while the help is shown, as both use the same place.
        let visits = self.visits.as_ref().filter(|_| !self.panels.is_help_shown());
        let params = FrameParams {
            eye: self.hands.orbit.eye(size),
            between: self.pace.tick_fraction(),
            path: self.path,
            next_bite: self.hands.next_bite(),
            panels: visits.map_or(&[], WindowVisits::panels),
        };
        self.seen = view.try_draw_frame(
            window,
            size,
            self.studio.world(),
            &params,
            &mut self.egui_buffers,
        )?;
        self.frames += u64::from(self.seen);
        let settled = !self.studio.is_exporting()
            && self.studio.path_being_read().is_none()
            && !self.studio.file_writer().is_busy();
        if let Some(script) = &mut self.script
            && self.seen
        {
            script.count_frame(settled);
        }
        Ok(())
    }

    /// Ends the event loop. Only the first reason is kept.
    fn exit_loop(&mut self, events: &ActiveEventLoop, done: Result<(), WindowError>) {
        if self.done.is_ok() {
            self.done = done;
        }
        events.exit();
    }

    fn run_frame(&mut self, events: &ActiveEventLoop) {
        let mut done = self.run_due_ticks(events);
        if done.is_ok()
            && !events.exiting()
            && let Err(error) = self.draw_frame()
        {
            done = self.recover_device(&error);
        }
        self.drawn = Instant::now();
        if done.is_err() {
            self.exit_loop(events, done);
        }
    }
}

impl<const N: usize> ApplicationHandler for App<'_, N>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.window.is_none() {
            let opened = self.open_window(events);
            if opened.is_err() {
                self.exit_loop(events, opened);
            }
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        match event {
            WindowEvent::CloseRequested => self.close_or_warn(events),
            WindowEvent::RedrawRequested => self.run_frame(events),
            event => self.handle_event(event),
        }
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        if events.exiting() {
            return;
        }
        if self.display.as_ref().is_some_and(DisplayConnection::is_known_lost) {
            self.on_display_lost();
            events.exit();
            return;
        }
        let Some(window) = &self.window else { return };
        let minimised = window.is_minimized().unwrap_or(false);
        if self.seen && !minimised {
            window.request_redraw();
        }
        // A hidden window gets no redraw requests: compositors request frames only from visible windows.
        // Ticks run on a timer instead.
        events.set_control_flow(ControlFlow::WaitUntil(Instant::now() + UNSEEN));
        if self.last.elapsed() < UNSEEN {
            return;
        }
        if !self.seen && !minimised {
            self.run_frame(events);
        } else if minimised || self.drawn.elapsed() >= HIDDEN {
            let done = self.run_due_ticks(events);
            if done.is_err() {
                self.exit_loop(events, done);
            }
        }
    }

    fn exiting(&mut self, _: &ActiveEventLoop) {
        self.drop_window();
    }
}
