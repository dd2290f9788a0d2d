//! Scripted input in place of a visitor's.

use std::io::{self, Write};

use paros_core::edit::UndoCounts;
use paros_core::limits::INTERVALS;
use paros_core::volume::{Grid, Size};
use paros_faults::{self as faults, CallGroup, FailureCause, PlannedFault};
use paros_headless::Error;
use paros_shell::modes::parse_mode;
use paros_shell::statics::Resident;
use winit::dpi::PhysicalSize;
use winit::event::MouseButton;
use winit::event_loop::ActiveEventLoop;

use super::App;
use crate::window::hands::{HandButton, InputEvent, RIGHT};
use crate::window::script::ScriptStep;
use crate::window::{WindowError, opening};

impl<const N: usize> App<'_, N>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    /// Runs the script's steps that come before the next tick.
    pub(super) fn run_script_steps(&mut self, events: &ActiveEventLoop) -> Result<(), WindowError> {
        while let Some(script) = &mut self.script
            && !events.exiting()
        {
            let Some(step) = script.next_step().map_err(WindowError::Failed)? else { break };
            self.run_script_step(step, events)?;
            if let Some(script) = &mut self.script {
                script.print_done_of_immediate_step();
            }
        }
        Ok(())
    }

    fn run_script_step(
        &mut self,
        step: ScriptStep,
        events: &ActiveEventLoop,
    ) -> Result<(), WindowError> {
        if matches!(step, ScriptStep::Device(_) | ScriptStep::Key(..) | ScriptStep::Tap(_)) {
            self.idle.note_use();
        }
        match step {
            ScriptStep::Device(InputEvent::Pressed(HandButton::Left)) if self.visits.is_some() => {
                self.handle_button(MouseButton::Left, true);
            }
            ScriptStep::Device(InputEvent::Released(HandButton::Left)) if self.visits.is_some() => {
                self.handle_button(MouseButton::Left, false);
            }
            ScriptStep::Device(InputEvent::Moved([x, y])) => {
                let [width, height] = self.hands.size.map(|pixels| pixels as f32 / 100.0);
                self.move_cursor([x * width, y * height]);
            }
            ScriptStep::Device(event) => self.send_to_hands(event),
            ScriptStep::Key(command, down) => self.handle_key(command, down),
            ScriptStep::Tap(command) => {
                self.handle_key(command, true);
                self.handle_key(command, false);
            }
            ScriptStep::Wait(_) | ScriptStep::Frames(_) | ScriptStep::Settle => {}
            ScriptStep::Start(name) => {
                let mode = parse_mode(&name).map_err(|_| {
                    WindowError::Failed(Error::Input(format!("no way to start: {name}")))
                })?;
                self.start_anew(mode);
            }
            ScriptStep::Open(path) => {
                self.studio.open_file(&path, opening::read_into_resident_maps::<N>);
            }
            ScriptStep::Size(size) => self.resize_window(size),
            ScriptStep::Minimise(minimised) => {
                if let Some(window) = &self.window {
                    window.set_minimized(minimised);
                }
            }
            ScriptStep::Lose => {
                let calls = CallGroup::Submit;
                faults::set_planned_fault(Some(PlannedFault {
                    calls,
                    skipped_calls: 0,
                    failing_calls: 1,
                    cause: FailureCause::Lost,
                }));
            }
            ScriptStep::Starve(times) => {
                let calls = CallGroup::Memory;
                faults::set_planned_fault(Some(PlannedFault {
                    calls,
                    skipped_calls: 0,
                    failing_calls: times,
                    cause: FailureCause::DeviceMemory,
                }));
            }
            ScriptStep::Say => self.print_state(),
            ScriptStep::Quit => self.exit_loop(events, Ok(())),
        }
        Ok(())
    }

    /// Requests another size of the window, in pixels.
    fn resize_window(&mut self, [width, height]: [u32; 2]) {
        let size = PhysicalSize::new(width, height);
        if width == 0 || height == 0 {
            // Not every system can resize a window to no area: handle the size directly.
            self.handle_event(winit::event::WindowEvent::Resized(size));
        } else if let Some(window) = &self.window {
            // A size that is granted immediately sends no event.
            if window.request_inner_size(size) == Some(size) {
                self.handle_event(winit::event::WindowEvent::Resized(size));
            }
        }
    }

    /// Prints the studio's state as one line, for a test to read.
    fn print_state(&self) {
        let world = self.studio.world();
        let held = world.held_tool(RIGHT).map_or("nothing", |(_, bit)| bit.spec().name);
        let UndoCounts { undoable: undo, redoable: redo } = world.undo_counts();
        let printed =
            self.studio.session_stl_path().map_or(String::new(), |path| path.display().to_string());
        let [width, height] = self.hands.size;
        let mut out = io::stdout().lock();
        // Standard output may be closed.
        let _ = writeln!(
            out,
            "session {:?}; visit {:?} {:?}; mode {:?}; voxels {}; bared {}; holds {held}; undo {undo}; redo {redo}; \
             frames {}; size {width}x{height}; scale {}; printed {printed}; \
             fault {}; note {}",
            world.session_state(),
            world.visit().phase(),
            world.visit().guide_step(),
            world.mode(),
            world.volume().count_voxels(),
            world.bared_ends().percent(),
            self.frames,
            self.scale,
            self.studio.save_error().unwrap_or_default(),
            self.last_notice,
        );
    }
}
