//! Panels over the picture: a start, the tools, help, frame times. They show what they are given
//! and say what was asked for; they decide nothing.

mod browser;
mod graph;
mod help;
mod outline;
mod start;
mod strip;
mod style;

use std::path::{Path, PathBuf};

use egui::{Align2, Area, Context, Id, RawInput, RichText, Vec2};
use paros_core::input::Mode;
use paros_core::tools::{Bit, Tool};
use paros_core::workbench::Item;
use paros_core::world::Session;
use paros_shaders::gpu::Times;
use paros_shell::studio::Note;

use browser::Browser;
use graph::Graph;
pub(super) use outline::Outline;

/// Seconds that a note stays.
const NOTE_SECONDS: f64 = 6.0;

/// Something that was asked for.
#[derive(Clone, PartialEq, Debug)]
pub(super) enum Asked {
    /// A session.
    Start(Mode),
    /// A session from the sculpture as it is.
    CarveOn,
    /// A file to start from.
    Open(PathBuf),
    /// A thing off the bench.
    Take(Item),
    /// Commands of the core.
    Command(u8),
    /// The end of the session.
    Finish,
    /// Another try at writing what no folder took.
    WriteAgain,
}

/// What the panels show.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shown<'a> {
    /// Where the session stands.
    pub(super) session: Session,
    /// How it started.
    pub(super) mode: Mode,
    /// The tool in hand.
    pub(super) held: Option<(Tool, Bit)>,
    /// Its depth in millimetres.
    pub(super) depth: f32,
    /// Whether edits are mirrored.
    pub(super) symmetry: bool,
    /// Strokes to undo and to redo.
    pub(super) undo: (usize, usize),
    /// Whether a print is being made.
    pub(super) printing: bool,
    /// Where the print is.
    pub(super) printed: Option<&'a Path>,
    /// Whether a print could not be written.
    pub(super) unwritten: bool,
    /// Why the session is not on the disk.
    pub(super) fault: Option<&'a str>,
    /// The file being read.
    pub(super) opening: Option<&'a Path>,
    /// Whether files can be dropped on the window.
    pub(super) drops: bool,
    /// Whether the fast path draws.
    pub(super) fast: bool,
    /// The device.
    pub(super) device: &'a str,
    /// Its times.
    pub(super) times: Times,
    /// The bit, to be drawn as lines.
    pub(super) outline: Option<&'a Outline>,
}

/// The panels' own state.
pub(super) struct Panels {
    /// What lays them out.
    pub(super) context: Context,
    /// What happened since the last frame.
    pub(super) input: RawInput,
    /// The start is shown.
    start: bool,
    help: bool,
    graph: bool,
    times: Graph,
    /// The end was asked for once.
    finishing: bool,
    browser: Option<Browser>,
    notes: Vec<(Note, f64)>,
    asked: Vec<Asked>,
}

impl Panels {
    /// Panels that begin with the start.
    #[must_use]
    #[allow(clippy::new_without_default)] // it reads fonts
    pub(super) fn new() -> Self {
        let context = Context::default();
        style::set(&context);
        let input = RawInput {
            max_texture_side: Some(paros_shaders::gpu::overlay::ATLAS as usize),
            ..RawInput::default()
        };
        Panels {
            context,
            input,
            start: true,
            help: false,
            graph: false,
            times: Graph::new(),
            finishing: false,
            browser: None,
            notes: Vec::new(),
            asked: Vec::new(),
        }
    }

    /// Whether the cursor is over a panel, or a panel covers the studio.
    #[must_use]
    pub(super) fn has_cursor(&self) -> bool {
        self.context.is_pointer_over_area() || self.context.is_using_pointer()
    }

    /// Whether the studio is in use, not a panel that covers it.
    #[must_use]
    pub(super) const fn is_open(&self) -> bool {
        !self.start && self.browser.is_none()
    }

    /// Tells the visitor something.
    pub(super) fn note(&mut self, note: Note) {
        let until = self.context.input(|input| input.time) + NOTE_SECONDS;
        self.notes.push((note, until));
        if self.notes.len() > 4 {
            self.notes.remove(0);
        }
    }

    /// A frame took so many seconds.
    pub(super) fn frame_took(&mut self, seconds: f32) {
        self.times.push(seconds);
    }

    /// A session has started.
    pub(super) fn started(&mut self) {
        (self.start, self.finishing, self.browser) = (false, false, None);
    }

    /// Shows the help, or hides it.
    pub(super) fn switch_help(&mut self) {
        self.help = !self.help;
    }

    /// Shows the frame times, or hides them.
    pub(super) fn switch_graph(&mut self) {
        self.graph = !self.graph;
    }

    /// Asks once more before the session ends, and the second time has it ended.
    pub(super) fn finish(&mut self, session: Session) {
        if session == Session::Sculpting && self.is_open() {
            if self.finishing {
                self.asked.push(Asked::Finish);
            }
            self.finishing = !self.finishing;
        }
    }

    /// Closes what was opened last; else shows the start, or goes back to the session.
    pub(super) fn back(&mut self, session: Session) {
        if self.browser.take().is_some() || core::mem::take(&mut self.finishing) {
            return;
        }
        if self.help {
            self.help = false;
        } else {
            self.start = !self.start || session == Session::Waiting;
        }
    }

    /// Lays a frame out. What was asked for comes back.
    pub(super) fn lay_out(&mut self, shown: &Shown<'_>) -> (egui::FullOutput, Vec<Asked>) {
        let input = self.input.take();
        self.input.max_texture_side = input.max_texture_side;
        let context = self.context.clone();
        let output = context.run(input, |context| self.all(context, shown));
        (output, core::mem::take(&mut self.asked))
    }

    fn all(&mut self, context: &Context, shown: &Shown<'_>) {
        if let Some(outline) =
            shown.outline.filter(|_| self.is_open() && shown.session == Session::Sculpting)
        {
            outline.draw(context);
        }
        match &mut self.browser {
            Some(browser) => match browser.show(context) {
                browser::Answer::None => {}
                browser::Answer::Closed => self.browser = None,
                browser::Answer::Chosen(path) => {
                    self.browser = None;
                    self.asked.push(Asked::Open(path));
                }
            },
            None if self.start => self.start(context, shown),
            None => self.studio(context, shown),
        }
        if self.help {
            help::show(context);
        }
        if self.graph {
            self.times.show(context, shown);
        }
        self.notes(context);
    }

    fn start(&mut self, context: &Context, shown: &Shown<'_>) {
        match start::show(context, shown) {
            start::Answer::None => {}
            start::Answer::Continue => self.start = false,
            start::Answer::Browse => self.browser = Some(Browser::new()),
            start::Answer::Start(mode) => self.asked.push(Asked::Start(mode)),
        }
    }

    fn studio(&mut self, context: &Context, shown: &Shown<'_>) {
        strip::status(context, shown);
        match shown.session {
            Session::Finished => {
                if let Some(asked) = strip::finished(context, shown, &mut self.start) {
                    self.asked.push(asked);
                }
            }
            _ if self.finishing => match strip::confirm(context) {
                strip::Answer::None => {}
                strip::Answer::No => self.finishing = false,
                strip::Answer::Yes => {
                    self.finishing = false;
                    self.asked.push(Asked::Finish);
                }
            },
            _ => {
                let mut finish = false;
                strip::tools(context, shown, &mut self.asked, &mut finish);
                self.finishing = finish;
            }
        }
    }

    fn notes(&mut self, context: &Context) {
        let now = context.input(|input| input.time);
        self.notes.retain(|(_, until)| *until > now);
        let top = Area::new(Id::new("notes")).anchor(Align2::CENTER_TOP, Vec2::new(0.0, 52.0));
        top.interactable(false).show(context, |ui| {
            for (note, _) in &self.notes {
                style::card().show(ui, |ui| {
                    ui.set_max_width(620.0);
                    match note {
                        Note::Good(text) => ui.label(text),
                        Note::Bad(text) => ui.label(RichText::new(text).color(style::WARNING)),
                    }
                });
            }
        });
    }
}

#[cfg(test)]
mod tests;
