//! Scripted input in place of mouse and keys, for tests and demonstrations: one step on each line, run
//! between ticks, so that the same script always leads to the same sculpture.

use std::io::{self, BufRead, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::thread;

use paros_core::session::TICK_RATE;
use paros_headless::Error;
use paros_shell::tick_runner::TickClock;

use super::hands::{HandButton, InputEvent};
use super::keys::{self, KeyCommand};

/// A line of a script.
#[derive(Clone, PartialEq, Debug)]
pub(super) enum ScriptStep {
    /// `move X Y`: moves the cursor to a point of the window, in percent of its width and height. Also `press
    /// left|middle|right`, `release ...`, `wheel N` and `zoom N`.
    Device(InputEvent),
    /// `down NAME`, `up NAME`: presses or releases a key; the name may begin with `shift+`.
    Key(KeyCommand, bool),
    /// `key NAME`: presses and releases a key.
    Tap(KeyCommand),
    /// `wait TICKS`: waits for a number of ticks.
    Wait(u32),
    /// `frames N`: waits until N frames were drawn.
    Frames(u32),
    /// `start free|owl|cat|amphora|dolphin|creative`: starts a session.
    Start(String),
    /// `open FILE`: opens a file, as if it was dropped on the window.
    Open(PathBuf),
    /// `settle`: waits until nothing is being read, printed or written.
    Settle,
    /// `size W H`: resizes the window, in pixels.
    Size([u32; 2]),
    /// `minimise`, `restore`: minimises or restores the window.
    Minimise(bool),
    /// `lose`: the device is lost in the next frame.
    Lose,
    /// `starve N`: the next N requests for device memory fail.
    Starve(u32),
    /// `say`: prints the state, for a test to read.
    Say,
    /// `quit`: closes the window.
    Quit,
}

/// A script, read on its own thread, and its pending step.
#[derive(Debug)]
pub(super) struct Script {
    name: String,
    lines: Receiver<io::Result<String>>,
    line: usize,
    /// The condition that the script waits for, and the line of its step.
    waiting: Option<(WaitFor, String)>,
    /// The step that is being run.
    doing: Option<String>,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum WaitFor {
    Ticks(u32),
    Frames(u32),
    Settled,
}

impl Script {
    /// Opens a script from a file, or from standard input if the path is `-`.
    ///
    /// # Errors
    /// A file that can't be opened.
    pub(super) fn open(path: &Path) -> Result<Self, Error> {
        let name = path.display().to_string();
        let from: Box<dyn BufRead + Send> = if name == "-" {
            Box::new(io::BufReader::new(io::stdin()))
        } else {
            let opened = paros_shell::durable::open_regular_file(path);
            let file = opened.map_err(|error| Error::Input(format!("{name}: {error}")))?;
            Box::new(io::BufReader::new(file))
        };
        let (tell, lines) = channel();
        thread::spawn(move || {
            for line in from.lines() {
                if tell.send(line).is_err() {
                    break;
                }
            }
        });
        Ok(Script { name, lines, line: 0, waiting: None, doing: None })
    }

    /// Returns the next step before a tick; `None` while the script waits. The end of the script acts as
    /// `quit`.
    ///
    /// # Errors
    /// A line that is no step, with its number.
    pub(super) fn next_step(&mut self) -> Result<Option<ScriptStep>, Error> {
        if self.waiting.is_some() {
            return Ok(None);
        }
        let text = loop {
            let line = match self.lines.try_recv() {
                Ok(line) => {
                    line.map_err(|error| Error::Input(format!("{}: {error}", self.name)))?
                }
                Err(TryRecvError::Empty) => return Ok(None),
                Err(TryRecvError::Disconnected) => return Ok(Some(ScriptStep::Quit)),
            };
            self.line += 1;
            let text = line.trim();
            if !text.is_empty() && !text.starts_with('#') {
                break text.to_owned();
            }
        };
        let text = &*text;
        let step = parse_step(text).ok_or_else(|| {
            Error::Input(format!("{}: line {}: no step: {text}", self.name, self.line))
        })?;
        let wait = match step {
            ScriptStep::Wait(ticks) => Some(WaitFor::Ticks(ticks)),
            ScriptStep::Frames(frames) => Some(WaitFor::Frames(frames)),
            ScriptStep::Settle => Some(WaitFor::Settled),
            _ => None,
        };
        self.waiting = wait.map(|wait| (wait, text.to_owned()));
        self.doing = wait.is_none().then(|| text.to_owned());
        Ok(Some(step))
    }

    /// Returns the number of ticks in the next frame. While the script waits for ticks, two frames are drawn
    /// for each second of the sculpture's time.
    pub(super) fn ticks_of_frame(&self) -> u32 {
        let at_least = TickClock::MAX_TICKS_PER_FRAME;
        match self.waiting {
            Some((WaitFor::Ticks(left), _)) => left.clamp(at_least, TICK_RATE / 2),
            _ => at_least,
        }
    }

    /// Prints that the last step of [`Script::next_step`] is done, unless it waits.
    pub(super) fn print_done_of_immediate_step(&mut self) {
        if let Some(step) = self.doing.take() {
            print_done(&step);
        }
    }

    /// Counts a tick for `wait`.
    pub(super) fn count_tick(&mut self) {
        self.update_wait(|wait| match wait {
            WaitFor::Ticks(left) => WaitFor::Ticks(left.saturating_sub(1)),
            other => other,
        });
    }

    /// Counts a frame for `frames`. `is_settled` ends `settle`: no file is being read, printed or written.
    pub(super) fn count_frame(&mut self, is_settled: bool) {
        self.update_wait(|wait| match wait {
            WaitFor::Frames(left) => WaitFor::Frames(left.saturating_sub(1)),
            WaitFor::Settled if is_settled => WaitFor::Frames(0),
            other => other,
        });
    }

    fn update_wait(&mut self, next: impl Fn(WaitFor) -> WaitFor) {
        if let Some((wait, text)) = self.waiting.take() {
            match next(wait) {
                WaitFor::Ticks(0) | WaitFor::Frames(0) => print_done(&text),
                wait => self.waiting = Some((wait, text)),
            }
        }
    }
}

/// Prints that a step is done, for the author of the script.
fn print_done(step: &str) {
    let mut out = io::stdout().lock();
    // Standard output may be closed.
    let _ = writeln!(out, "done {step}").and_then(|()| out.flush());
}

fn parse_step(text: &str) -> Option<ScriptStep> {
    let (word, rest) = text.split_once(' ').unwrap_or((text, ""));
    let rest = rest.trim();
    let pair = || rest.split_once(' ').map(|(a, b)| (a.trim(), b.trim()));
    let number = || rest.parse::<f32>().ok().filter(|number| number.is_finite());
    let key = || {
        let shift = rest.strip_prefix("shift+");
        keys::command_named(shift.unwrap_or(rest), shift.is_some())
    };
    let button = || match rest {
        "left" => Some(HandButton::Left),
        "middle" => Some(HandButton::Middle),
        "right" => Some(HandButton::Right),
        _ => None,
    };
    Some(match word {
        "move" => {
            let (x, y) = pair()?;
            ScriptStep::Device(InputEvent::Moved([x.parse().ok()?, y.parse().ok()?]))
        }
        "press" => ScriptStep::Device(InputEvent::Pressed(button()?)),
        "release" => ScriptStep::Device(InputEvent::Released(button()?)),
        "wheel" => ScriptStep::Device(InputEvent::Wheel(number()?)),
        "zoom" => ScriptStep::Device(InputEvent::Zoom(number()?)),
        "key" => ScriptStep::Tap(key()?),
        "down" => ScriptStep::Key(key()?, true),
        "up" => ScriptStep::Key(key()?, false),
        "wait" => ScriptStep::Wait(rest.parse().ok()?),
        "frames" => ScriptStep::Frames(rest.parse().ok()?),
        "start" => ScriptStep::Start(rest.to_owned()),
        "open" if !rest.is_empty() => ScriptStep::Open(rest.into()),
        "size" => {
            let (width, height) = pair()?;
            ScriptStep::Size([width.parse().ok()?, height.parse().ok()?])
        }
        "settle" => ScriptStep::Settle,
        "minimise" => ScriptStep::Minimise(true),
        "restore" => ScriptStep::Minimise(false),
        "lose" => ScriptStep::Lose,
        "starve" => ScriptStep::Starve(rest.parse().ok()?),
        "say" => ScriptStep::Say,
        "quit" => ScriptStep::Quit,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::{ScriptStep, parse_step};
    use crate::window::hands::{HandAction, HandButton, InputEvent};
    use crate::window::keys::KeyCommand;

    #[test]
    fn lines_are_steps_or_refused() {
        assert_eq!(
            parse_step("move 50 12.5"),
            Some(ScriptStep::Device(InputEvent::Moved([50.0, 12.5])))
        );
        assert_eq!(
            parse_step("press left"),
            Some(ScriptStep::Device(InputEvent::Pressed(HandButton::Left)))
        );
        assert_eq!(
            parse_step("key shift+2"),
            Some(ScriptStep::Tap(KeyCommand::Hands(HandAction::Bit(1))))
        );
        assert_eq!(parse_step("wait 30"), Some(ScriptStep::Wait(30)));
        assert_eq!(parse_step("open a mesh.obj"), Some(ScriptStep::Open("a mesh.obj".into())));
        for line in ["press", "press up", "move 1", "move a b", "wait -1", "key q", "wheel nan"] {
            assert_eq!(parse_step(line), None, "{line}");
        }
    }
}
