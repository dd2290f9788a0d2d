//! A script in place of mouse and keys, for tests and demonstrations: a line for each thing done,
//! carried out between ticks, so that the same script leads to the same sculpture.

use std::io::{self, BufRead, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::thread;

use crate::error::Error;

use super::hands::{Button, Event};
use super::keys::{self, Command};

/// A thing done.
#[derive(Clone, PartialEq, Debug)]
pub(super) enum Step {
    /// `move X Y`: the cursor goes to a point of the window, in parts of a hundred of its width and
    /// height. `press left|middle|right`, `release ...`, `wheel N`, `zoom N` likewise.
    Device(Event),
    /// `down NAME`, `up NAME`: a key; `shift+` before the name.
    Key(Command, bool),
    /// `key NAME`: a key that goes down and up.
    Tap(Command),
    /// `wait TICKS`.
    Wait(u32),
    /// `frames N`: waits until so many were drawn.
    Frames(u32),
    /// `start free|owl|cat|amphora|dolphin|creative`.
    Start(String),
    /// `open FILE`, or drops it on the window.
    Open(PathBuf),
    /// `settle`: waits until nothing is being read, printed or written.
    Settle,
    /// `size W H`: another size of the window, in pixels.
    Size([u32; 2]),
    /// `minimise`.
    Minimise(bool),
    /// `lose`: the device is lost with the next frame.
    Lose,
    /// `starve N`: so many requests for the device's memory fail from now on.
    Starve(u32),
    /// `say`: prints what there is to know, for a test to read.
    Say,
    /// `quit`.
    Quit,
}

/// Where steps come from.
#[derive(Debug)]
pub(super) struct Script {
    name: String,
    lines: Receiver<io::Result<String>>,
    line: usize,
    /// The step that is being waited for, and its line.
    waiting: Option<(Wait, String)>,
    /// The step that is being carried out.
    doing: Option<String>,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Wait {
    Ticks(u32),
    Frames(u32),
    Settled,
}

impl Script {
    /// A script from a file, or from standard input where that is `-`.
    ///
    /// # Errors
    /// A file that can't be opened.
    pub(super) fn open(path: &Path) -> Result<Self, Error> {
        let name = path.display().to_string();
        let from: Box<dyn BufRead + Send> = if name == "-" {
            Box::new(io::BufReader::new(io::stdin()))
        } else {
            let opened = paros_shell::durable::open(path);
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

    /// The next step before a tick; none while it waits. The end of the script is `quit`.
    ///
    /// # Errors
    /// A line that is no step, by its number.
    pub(super) fn next(&mut self) -> Result<Option<Step>, Error> {
        if self.waiting.is_some() {
            return Ok(None);
        }
        let text = loop {
            let line = match self.lines.try_recv() {
                Ok(line) => {
                    line.map_err(|error| Error::Input(format!("{}: {error}", self.name)))?
                }
                Err(TryRecvError::Empty) => return Ok(None),
                Err(TryRecvError::Disconnected) => return Ok(Some(Step::Quit)),
            };
            self.line += 1;
            let text = line.trim();
            if !text.is_empty() && !text.starts_with('#') {
                break text.to_owned();
            }
        };
        let text = &*text;
        let step = parse(text).ok_or_else(|| {
            Error::Input(format!("{}: line {}: no step: {text}", self.name, self.line))
        })?;
        let wait = match step {
            Step::Wait(ticks) => Some(Wait::Ticks(ticks)),
            Step::Frames(frames) => Some(Wait::Frames(frames)),
            Step::Settle => Some(Wait::Settled),
            _ => None,
        };
        self.waiting = wait.map(|wait| (wait, text.to_owned()));
        self.doing = wait.is_none().then(|| text.to_owned());
        Ok(Some(step))
    }

    /// The step that [`Script::next`] gave has been carried out.
    pub(super) fn did(&mut self) {
        if let Some(step) = self.doing.take() {
            told(&step);
        }
    }

    /// A tick is over.
    pub(super) fn ticked(&mut self) {
        self.count(|wait| match wait {
            Wait::Ticks(left) => Wait::Ticks(left.saturating_sub(1)),
            other => other,
        });
    }

    /// A frame was drawn; `settled` if nothing is under way.
    pub(super) fn drawn(&mut self, settled: bool) {
        self.count(|wait| match wait {
            Wait::Frames(left) => Wait::Frames(left.saturating_sub(1)),
            Wait::Settled if settled => Wait::Frames(0),
            other => other,
        });
    }

    fn count(&mut self, less: impl Fn(Wait) -> Wait) {
        if let Some((wait, text)) = self.waiting.take() {
            match less(wait) {
                Wait::Ticks(0) | Wait::Frames(0) => told(&text),
                wait => self.waiting = Some((wait, text)),
            }
        }
    }
}

/// Says that a step is done, for whoever writes the next one.
fn told(step: &str) {
    let mut out = io::stdout().lock();
    // Nobody may be listening there.
    let _ = writeln!(out, "done {step}").and_then(|()| out.flush());
}

fn parse(text: &str) -> Option<Step> {
    let (word, rest) = text.split_once(' ').unwrap_or((text, ""));
    let rest = rest.trim();
    let pair = || rest.split_once(' ').map(|(a, b)| (a.trim(), b.trim()));
    let number = || rest.parse::<f32>().ok().filter(|number| number.is_finite());
    let key = || {
        let shift = rest.strip_prefix("shift+");
        keys::named(shift.unwrap_or(rest), shift.is_some())
    };
    let button = || match rest {
        "left" => Some(Button::Left),
        "middle" => Some(Button::Middle),
        "right" => Some(Button::Right),
        _ => None,
    };
    Some(match word {
        "move" => {
            let (x, y) = pair()?;
            Step::Device(Event::Moved([x.parse().ok()?, y.parse().ok()?]))
        }
        "press" => Step::Device(Event::Pressed(button()?)),
        "release" => Step::Device(Event::Released(button()?)),
        "wheel" => Step::Device(Event::Wheel(number()?)),
        "zoom" => Step::Device(Event::Zoom(number()?)),
        "key" => Step::Tap(key()?),
        "down" => Step::Key(key()?, true),
        "up" => Step::Key(key()?, false),
        "wait" => Step::Wait(rest.parse().ok()?),
        "frames" => Step::Frames(rest.parse().ok()?),
        "start" => Step::Start(rest.to_owned()),
        "open" if !rest.is_empty() => Step::Open(rest.into()),
        "size" => {
            let (width, height) = pair()?;
            Step::Size([width.parse().ok()?, height.parse().ok()?])
        }
        "settle" => Step::Settle,
        "minimise" => Step::Minimise(true),
        "restore" => Step::Minimise(false),
        "lose" => Step::Lose,
        "starve" => Step::Starve(rest.parse().ok()?),
        "say" => Step::Say,
        "quit" => Step::Quit,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::{Step, parse};
    use crate::window::hands::{Button, Event, Key};
    use crate::window::keys::Command;

    #[test]
    fn lines_are_steps_or_refused() {
        assert_eq!(parse("move 50 12.5"), Some(Step::Device(Event::Moved([50.0, 12.5]))));
        assert_eq!(parse("press left"), Some(Step::Device(Event::Pressed(Button::Left))));
        assert_eq!(parse("key shift+2"), Some(Step::Tap(Command::Hands(Key::Bit(1)))));
        assert_eq!(parse("wait 30"), Some(Step::Wait(30)));
        assert_eq!(parse("open a mesh.obj"), Some(Step::Open("a mesh.obj".into())));
        for line in ["press", "press up", "move 1", "move a b", "wait -1", "key q", "wheel nan"] {
            assert_eq!(parse(line), None, "{line}");
        }
    }
}
