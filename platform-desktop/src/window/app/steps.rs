//! What a script does in place of a visitor.

use std::io::{self, Write};

use paros_core::input::Mode;
use paros_core::size::{Grid, Size};
use paros_shaders::gpu;
use paros_shell::figures::Figure;
use paros_shell::statics::Resident;
use winit::dpi::PhysicalSize;
use winit::event_loop::ActiveEventLoop;

use super::App;
use crate::error::Error;
use crate::window::hands::{Event, RIGHT};
use crate::window::script::Step;
use crate::window::{Closed, opening};

impl<const N: usize> App<'_, N>
where
    Grid<N>: Size + Resident<N>,
{
    /// Does what is to be done before the next tick.
    pub(super) fn steps(&mut self, events: &ActiveEventLoop) -> Result<(), Closed> {
        while let Some(script) = &mut self.script
            && !events.exiting()
        {
            let Some(step) = script.next().map_err(Closed::Failed)? else { break };
            self.step(step, events)?;
            if let Some(script) = &mut self.script {
                script.did();
            }
        }
        Ok(())
    }

    fn step(&mut self, step: Step, events: &ActiveEventLoop) -> Result<(), Closed> {
        match step {
            Step::Device(Event::Moved([x, y])) => {
                let [width, height] = self.hands.size.map(|pixels| pixels as f32 / 100.0);
                self.moved([x * width, y * height]);
            }
            Step::Device(event) => self.hand(event),
            Step::Key(command, down) => self.key(command, down),
            Step::Tap(command) => {
                self.key(command, true);
                self.key(command, false);
            }
            Step::Wait(_) | Step::Frames(_) | Step::Settle => {}
            Step::Start(name) => {
                let mode = mode(&name).ok_or_else(|| {
                    Closed::Failed(Error::Input(format!("no way to start: {name}")))
                })?;
                self.hands.start(mode);
            }
            Step::Open(path) => self.studio.open(&path, opening::load::<N>),
            Step::Size([width, height]) => {
                if let Some(window) = &self.window {
                    // A size that is granted at once brings no event.
                    let size = PhysicalSize::new(width, height);
                    if window.request_inner_size(size) == Some(size) {
                        self.device(winit::event::WindowEvent::Resized(size));
                    }
                }
            }
            Step::Minimise(minimised) => {
                if let Some(window) = &self.window {
                    window.set_minimized(minimised);
                }
            }
            Step::Lose => {
                let result = ash::vk::Result::ERROR_DEVICE_LOST;
                self.lost(&gpu::Error::Call { doing: "go on, as a script asked", result })?;
            }
            Step::Say => self.say(),
            Step::Quit => self.stop(events, Ok(())),
        }
        Ok(())
    }

    /// Prints what there is to know, for a test to read.
    fn say(&self) {
        let world = self.studio.world();
        let held = world.held(RIGHT).map_or("nothing", |(_, bit)| bit.data().name);
        let (undo, redo) = world.undo_counts();
        let printed =
            self.studio.printed().map_or(String::new(), |path| path.display().to_string());
        let [width, height] = self.hands.size;
        let mut out = io::stdout().lock();
        // Nobody may be listening there.
        let _ = writeln!(
            out,
            "session {:?}; mode {:?}; voxels {}; holds {held}; undo {undo}; redo {redo}; \
             frames {}; size {width}x{height}; printed {printed}; note {}",
            world.session(),
            world.mode(),
            world.volume().count(),
            self.frames,
            self.last_note,
        );
    }
}

fn mode(name: &str) -> Option<Mode> {
    match name {
        "free" => Some(Mode::FreeForm),
        "creative" => Some(Mode::Creative),
        name => {
            let figure = Figure::HIDDEN.iter().position(|figure| figure.name() == name)?;
            Some(Mode::Constrained { figure: figure as u8 })
        }
    }
}
