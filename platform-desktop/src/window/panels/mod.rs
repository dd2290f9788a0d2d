//! User interface in `egui`: start panel, tools, help, frame times. Takes the studio's status and returns the
//! visitor's actions; changes no other state.

mod action;
mod browser;
mod cursor;
mod glow;
mod graph;
mod handover;
mod help;
pub(super) mod hints;
mod outline;
mod start;
mod status;
mod strip;
mod style;
mod words;

use egui::{
    Align2, Area, ColorImage, Context, Id, Pos2, RawInput, Rect, RichText, TextureHandle,
    TextureOptions, Vec2,
};
use paros_core::session::{SessionMode, SessionState};
use paros_shaders::Image;
use paros_shaders::panel::Language;
use paros_shell::figures::StoneThickness;
use paros_shell::studio::Notice;
use paros_visit::is_at_work;

pub(super) use action::PanelAction;
use browser::Browser;
pub(super) use glow::ItemGlow;
use graph::FrameTimeGraph;
use hints::{Hint, Hints};
pub(super) use outline::{BitOutline, MirrorGuide, is_pasting_beyond_box};
pub(super) use status::StudioStatus;
use strip::{BarButton, FinishedChoice};

/// Smallest size of the window that the panels are laid out for, in points.
const LEAST_SIZE: Vec2 = Vec2::new(640.0, 420.0);

/// Seconds for which a notice is shown.
const NOTICE_SECONDS: f64 = 6.0;

/// State of the user interface.
pub(super) struct Panels {
    /// The `egui` context.
    pub(super) context: Context,
    /// Input since the last frame.
    pub(super) input: RawInput,
    /// Pixels of the window per point of the panels.
    pixels_per_point: f32,
    /// Position of the cursor, which the last frame may not have seen yet.
    cursor: Option<Pos2>,
    /// The largest fraction of the window's height that the tool bar or the finished panel has covered at
    /// this window size. The picture doesn't move while the panels change.
    covered_part: f32,
    /// Pictures of the starts, side by side.
    start_pictures: Option<TextureHandle>,
    /// `true` while the start panel is open.
    start: bool,
    /// Thickness of stone over the next hidden figure.
    thickness: StoneThickness,
    help: bool,
    graph: bool,
    hints: Hints,
    times: FrameTimeGraph,
    /// `true` once finishing was requested, until it is confirmed.
    finishing: bool,
    /// The start that was chosen. It needs a confirmation while there is an unfinished sculpture.
    asked_start: Option<PanelAction>,
    browser: Option<Browser>,
    notices: Vec<(Notice, f64)>,
    actions: Vec<PanelAction>,
}

impl Panels {
    /// Creates the panels, with the start panel open.
    #[must_use]
    #[allow(clippy::new_without_default)] // it reads fonts
    pub(super) fn new() -> Self {
        let context = Context::default();
        style::set_style(&context);
        // With slow frames, press and release may be far apart: any duration is a click.
        context.options_mut(|options| options.input_options.max_click_duration = f64::INFINITY);
        let input = RawInput {
            max_texture_side: Some(paros_shaders::gpu::overlay::ATLAS_SIDE as usize),
            ..RawInput::default()
        };
        Panels {
            context,
            input,
            pixels_per_point: 1.0,
            cursor: None,
            covered_part: 0.0,
            start_pictures: None,
            start: true,
            thickness: StoneThickness::Near,
            help: false,
            graph: false,
            hints: Hints::default(),
            times: FrameTimeGraph::new(),
            finishing: false,
            asked_start: None,
            browser: None,
            notices: Vec::new(),
            actions: Vec::new(),
        }
    }

    /// Sets the pictures of the starts, side by side in the order of `start_pictures::pictured_figures`.
    pub(super) fn set_start_pictures(&mut self, pictures: &Image) {
        let image = ColorImage::from_rgb([pictures.width, pictures.height], &pictures.pixels);
        let options = TextureOptions::LINEAR;
        self.start_pictures = Some(self.context.load_texture("start pictures", image, options));
    }

    /// Sets the window's size in pixels, and its pixels per point. A window of fewer points than
    /// [`LEAST_SIZE`] shows the panels smaller.
    pub(super) fn set_window(&mut self, size_pixels: [u32; 2], scale: f32) {
        let size = Vec2::from(size_pixels.map(|pixels| pixels.max(1) as f32));
        let whole = size / LEAST_SIZE;
        let scale = scale.min(whole.min_elem());
        let rect = Rect::from_min_size(Pos2::ZERO, size / scale);
        if self.context.content_rect() != rect {
            self.covered_part = 0.0;
        }
        self.input.screen_rect = Some(rect);
        let root = self.input.viewports.entry(egui::ViewportId::ROOT).or_default();
        root.native_pixels_per_point = Some(scale);
        self.pixels_per_point = scale;
    }

    /// Returns the fraction of the window's height that the tool bar or the finished panel covers at the
    /// bottom.
    #[must_use]
    pub(super) const fn covered_part(&self) -> f32 {
        self.covered_part
    }

    /// Returns `true` if no start panel, file browser or question covers the studio.
    #[must_use]
    pub(super) const fn is_sculpture_uncovered(&self) -> bool {
        !self.start && self.browser.is_none() && self.asked_start.is_none()
    }

    /// Shows a notice for [`NOTICE_SECONDS`]. A notice that is already shown is not repeated.
    pub(super) fn show_notice(&mut self, notice: Notice) {
        let until = self.context.input(|input| input.time) + NOTICE_SECONDS;
        self.notices.retain(|(shown, _)| *shown != notice);
        self.notices.push((notice, until));
        if self.notices.len() > 4 {
            self.notices.remove(0);
        }
    }

    /// Shows a visitor the notice that the session's hidden figure was found.
    pub(super) fn show_found(&mut self, language: Language, mode: SessionMode) {
        self.show_notice(Notice::Good(words::say_found(language, mode)));
    }

    /// Shows only the start panel, for the next visitor.
    pub(super) fn show_start_alone(&mut self) {
        self.forget_visitor();
        self.start = true;
    }

    /// Closes the panels that a visitor opened, and resets the hints for the next visitor.
    pub(super) fn forget_visitor(&mut self) {
        self.close_covering_panels();
        (self.help, self.graph, self.hints) = (false, false, Hints::default());
    }

    /// Adds a frame's duration to the graph.
    pub(super) fn add_frame_time(&mut self, seconds: f32) {
        self.times.push(seconds);
    }

    /// Closes the panels that cover the studio, as a session has started.
    pub(super) fn close_covering_panels(&mut self) {
        (self.start, self.finishing, self.browser) = (false, false, None);
        self.asked_start = None;
    }

    /// Requests a start. It needs a confirmation if it would discard an unfinished sculpture.
    pub(super) fn ask_to_start(&mut self, action: PanelAction) {
        self.asked_start = Some(action);
    }

    /// Shows the help, or hides it.
    pub(super) fn toggle_help(&mut self) {
        self.help = !self.help;
    }

    /// Shows the frame times, or hides them.
    pub(super) fn toggle_graph(&mut self) {
        self.graph = !self.graph;
    }

    /// Confirms the requested start. Without one, requests the end of a sculpting session: the first request
    /// asks for confirmation; the second is [`PanelAction::Finish`].
    pub(super) fn confirm_start_or_ask_to_finish(&mut self, session: SessionState) {
        if let Some(action) = self.asked_start.take() {
            self.actions.push(action);
        } else if session == SessionState::Sculpting && self.is_sculpture_uncovered() {
            if self.finishing {
                self.actions.push(PanelAction::Finish);
            }
            self.finishing = !self.finishing;
        }
    }

    /// Returns `true` if the help is shown.
    pub(super) const fn is_help_shown(&self) -> bool {
        self.help
    }

    /// Closes the help. Returns `true` if it was open.
    pub(super) fn close_help(&mut self) -> bool {
        core::mem::take(&mut self.help)
    }

    /// Closes the topmost panel: question, browser, confirmation or help. If none is open, toggles the start
    /// panel.
    pub(super) fn close_topmost_or_toggle_start(&mut self, session: SessionState) {
        if self.asked_start.take().is_some()
            || self.browser.take().is_some()
            || core::mem::take(&mut self.finishing)
        {
            return;
        }
        if self.help {
            self.help = false;
        } else {
            self.start = !self.start || session == SessionState::Waiting;
        }
    }

    /// Lays out a frame, in one pass for each position of a button event. `egui` applies all events of a pass
    /// at the cursor's last position, which may be elsewhere by then if frames are slow. Returns `egui`'s
    /// output and the visitor's actions.
    pub(super) fn lay_out(
        &mut self,
        status: &StudioStatus<'_>,
    ) -> (egui::FullOutput, Vec<PanelAction>) {
        let input = self.input.take();
        self.input.max_texture_side = input.max_texture_side;
        let context = self.context.clone();
        let mut output = egui::FullOutput::default();
        for events in cursor::split_by_places(&input.events) {
            let pass = RawInput { events: events.to_vec(), ..input.clone() };
            output.append(context.run(pass, |context| self.show_all(context, status)));
        }
        (output, core::mem::take(&mut self.actions))
    }

    fn show_all(&mut self, context: &Context, status: &StudioStatus<'_>) {
        if self.is_sculpture_uncovered() && status.session == SessionState::Sculpting {
            if let Some(mirror) = status.mirror {
                mirror.draw(context);
            }
            match (status.glow, status.outline) {
                (Some(glow), _) => glow.draw(context, status.language),
                (None, Some(outline)) => outline.draw(context),
                (None, None) => {}
            }
        }
        match &mut self.browser {
            _ if self.asked_start.is_some() && status.unfinished => self.show_question(context),
            Some(browser) => match browser.show(context) {
                browser::BrowserAnswer::None => {}
                browser::BrowserAnswer::Closed => self.browser = None,
                browser::BrowserAnswer::Chosen(path) => {
                    self.browser = None;
                    self.actions.push(PanelAction::Open(path));
                }
            },
            None if self.start && status.visit.is_none() => self.show_start(context, status),
            None if status.is_asking || status.visit.is_some_and(|phase| !is_at_work(phase)) => {}
            None => self.show_over_sculpture(context, status),
        }
        if !status.unfinished {
            self.actions.extend(self.asked_start.take());
        }
        // The countdown ends once the start panel has replaced a finished sculpture.
        let is_handed_over = self.start && status.session == SessionState::Finished;
        if let Some(seconds) = status.seconds_to_handover.filter(|_| !is_handed_over) {
            handover::show(context, status, seconds);
        }
        if self.help {
            help::show(context, status);
        }
        if self.graph {
            self.times.show(context, status);
        }
        self.show_notices(context);
    }

    fn show_start(&mut self, context: &Context, status: &StudioStatus<'_>) {
        let pictures = self.start_pictures.as_ref();
        match start::show(context, status, pictures, &mut self.thickness) {
            start::StartChoice::None => {}
            start::StartChoice::Continue => self.start = false,
            start::StartChoice::Browse => self.browser = Some(Browser::new()),
            start::StartChoice::OneBefore => self.actions.push(PanelAction::OneBefore),
            start::StartChoice::Start(mode) => {
                self.ask_to_start(PanelAction::Start(mode));
            }
        }
    }

    fn show_question(&mut self, context: &Context) {
        match start::show_question(context) {
            strip::Confirmation::None => {}
            strip::Confirmation::No => self.asked_start = None,
            strip::Confirmation::Yes => self.actions.extend(self.asked_start.take()),
        }
    }

    fn show_over_sculpture(&mut self, context: &Context, status: &StudioStatus<'_>) {
        strip::show_status(context, status);
        match status.session {
            SessionState::Finished => {
                let panel = strip::show_finished(context, status);
                match panel.choice {
                    None => {}
                    Some(FinishedChoice::SomethingNew) => self.start = true,
                    Some(FinishedChoice::Action(action)) => self.actions.push(action),
                }
                self.note_covered(context, panel.height);
            }
            _ if self.finishing => match strip::show_confirmation(context) {
                strip::Confirmation::None => {}
                strip::Confirmation::No => self.finishing = false,
                strip::Confirmation::Yes => {
                    self.finishing = false;
                    self.actions.push(PanelAction::Finish);
                }
            },
            _ => {
                self.hints.note_strokes(status.undo);
                let now = context.input(|input| input.time);
                let work = self.hints.note_work(status, now);
                // The guided cut has its own panel with hints.
                let text = self.hints.text(work).filter(|_| !status.has_guide);
                let hint = Hint { text, bit: self.hints.bit(work) };
                let bar = strip::show_tools(context, status, (hint, self.help), &mut self.actions);
                self.finishing = bar.clicked == Some(BarButton::Finish);
                self.help ^= bar.clicked == Some(BarButton::Help);
                self.note_covered(context, bar.height);
            }
        }
    }

    /// Notes the height in points that a panel covers at the window's bottom.
    fn note_covered(&mut self, context: &Context, height: f32) {
        self.covered_part = self.covered_part.max(height / context.content_rect().height());
    }

    fn show_notices(&mut self, context: &Context) {
        let now = context.input(|input| input.time);
        self.notices.retain(|(_, until)| *until > now);
        let top = Area::new(Id::new("notes")).anchor(Align2::CENTER_TOP, Vec2::new(0.0, 52.0));
        let width = style::largest_content_size(context, &style::card_frame()).x.min(620.0);
        let shown = top.interactable(false).show(context, |ui| {
            for (notice, _) in &self.notices {
                style::card_frame().show(ui, |ui| {
                    ui.set_max_width(width);
                    match notice {
                        Notice::Good(text) => ui.label(text),
                        Notice::Bad(text) => ui.label(RichText::new(text).color(style::WARNING)),
                    }
                });
            }
        });
        // Drop the oldest notices if the window has no room for all.
        if shown.response.rect.bottom() > context.content_rect().bottom() && self.notices.len() > 1
        {
            self.notices.remove(0);
        }
    }
}

#[cfg(test)]
mod bar_tests;
#[cfg(test)]
mod fit_tests;
#[cfg(test)]
mod kiosk_tests;
#[cfg(test)]
mod start_tests;
#[cfg(test)]
pub(super) mod tests;
