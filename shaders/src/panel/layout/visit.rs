//! Screens of a visit: welcome, choice, first cut and clock.

use glam::Vec2;

use super::{add_medallion, add_title, begin_panel, palette};
use crate::panel::button::{ButtonLabel, PanelButton};
use crate::panel::font::{FontWeight, Icon};
use crate::panel::message::{FillingValue, Language, Message};
use crate::panel::model::{Panel, PanelColor, TextAlign, TextStyle};
use crate::panel::pose::PanelRect;

/// The questions of the welcome, from the top.
const WELCOME_QUESTIONS: [Message; 3] =
    [Message::WelcomeLanguage, Message::WelcomeHand, Message::WelcomePosture];

/// Distance from one question of the welcome to the next, in millimetres.
const WELCOME_ROW: f32 = 122.0;

/// Height of the welcome without its questions, in millimetres.
const WELCOME_HEIGHT: f32 = 354.0;

/// Returns the buttons of the welcome: English, Greek; left, right; sitting, standing; begin. Numbered from
/// `first_id` on. For a visitor with only a mouse `questions` is 1, and only the first two and the last are
/// of use.
#[must_use]
pub const fn welcome_buttons(first_id: u16, questions: u16) -> [PanelButton<'static>; 7] {
    const fn at(column: u16, row: u16) -> PanelRect {
        let [left, top] = [390.0 + 325.0 * column as f32, 176.0 + WELCOME_ROW * row as f32];
        PanelRect::new(left, top, 305.0, 100.0)
    }
    const fn name(language: Language) -> ButtonLabel<'static> {
        ButtonLabel::MessageIn(Message::LanguageName, language)
    }
    let id = first_id;
    let begin = PanelRect::new(360.0, 208.0 + WELCOME_ROW * questions as f32, 360.0, 106.0);
    [
        PanelButton::new(id, at(0, 0), Message::LanguageName).with_label(name(Language::English)),
        PanelButton::new(id + 1, at(1, 0), Message::LanguageName).with_label(name(Language::Greek)),
        PanelButton::new(id + 2, at(0, 1), Message::LeftHand).with_icon(Icon::LeftHand),
        PanelButton::new(id + 3, at(1, 1), Message::RightHand).with_icon(Icon::RightHand),
        PanelButton::new(id + 4, at(0, 2), Message::Seated).with_icon(Icon::Seat),
        PanelButton::new(id + 5, at(1, 2), Message::Standing).with_icon(Icon::Standing),
        PanelButton::new(id + 6, begin, Message::Begin).primary(),
    ]
}

/// Draws the welcome: language, hand, seated or standing; only the first `questions` of them.
pub fn draw_welcome(
    panel: &mut Panel,
    language: Language,
    questions: u16,
    buttons: &[PanelButton<'_>],
) {
    begin_panel(panel, [1080.0, WELCOME_HEIGHT + WELCOME_ROW * f32::from(questions)]);
    add_title(panel, language, Message::WelcomeTitle, 104.0);
    for (row, question) in WELCOME_QUESTIONS.into_iter().take(questions.into()).enumerate() {
        let middle = 226.0 + WELCOME_ROW * row as f32;
        add_question(panel, language, question, Vec2::new(56.0, middle));
    }
    add_buttons(panel, language, buttons);
}

/// Adds a question in one line or two, vertically centred at its point.
fn add_question(panel: &mut Panel, language: Language, question: Message, at: Vec2) {
    let style = question.place().style().colored(palette::INK, TextAlign::Left);
    let width = question.place().style().width_mm;
    panel.add_paragraph_around(question.text(language), at, width, &style);
}

pub(super) fn add_buttons(panel: &mut Panel, language: Language, buttons: &[PanelButton<'_>]) {
    for button in buttons {
        panel.add_button(language, button);
    }
}

/// Returns the cards of a choice: an icon and a text each, numbered from `first_id` on, in one row or two.
#[must_use]
pub fn choice_buttons(first_id: u16, cards: &[(Message, Icon)]) -> Vec<PanelButton<'static>> {
    let (columns, _) = choice_grid(cards.len());
    let [width, _] = choice_size(cards.len());
    let card = |(k, &(message, icon)): (usize, &(Message, Icon))| {
        let (column, row) = (k % columns, k / columns);
        // A last row that isn't full stands in the middle.
        let in_row = (cards.len() - row * columns).min(columns);
        let left = 0.5 * (width - in_row as f32 * CARD[0] - (in_row - 1) as f32 * CARD_GAP);
        let rect = PanelRect::new(
            left + column as f32 * (CARD[0] + CARD_GAP),
            CARDS_TOP + row as f32 * (CARD[1] + CARD_GAP),
            CARD[0],
            CARD[1],
        );
        PanelButton::new(first_id + k as u16, rect, message).with_icon(icon)
    };
    cards.iter().enumerate().map(card).collect()
}

const CARD: [f32; 2] = [296.0, 320.0];
const CARD_GAP: f32 = 22.0;
const CARDS_TOP: f32 = 216.0;

/// Returns the columns and rows of this many cards.
const fn choice_grid(cards: usize) -> (usize, usize) {
    let columns = if cards <= 4 { cards } else { cards.div_ceil(2) };
    let columns = if columns == 0 { 1 } else { columns };
    (columns, if cards > columns { 2 } else { 1 })
}

fn choice_size(cards: usize) -> [f32; 2] {
    let (columns, rows) = choice_grid(cards);
    let width = columns as f32 * (CARD[0] + CARD_GAP) - CARD_GAP + 88.0;
    [width.max(1000.0), CARDS_TOP + rows as f32 * (CARD[1] + CARD_GAP) + 22.0]
}

/// Draws a choice between cards: a title, and what to do.
pub fn draw_choice(
    panel: &mut Panel,
    language: Language,
    title: Message,
    cards: &[PanelButton<'_>],
) {
    begin_panel(panel, choice_size(cards.len()));
    add_title(panel, language, title, 98.0);
    let middle = Vec2::new(0.5 * panel.size_mm()[0], 182.0);
    let soft = (palette::SOFT_INK, TextAlign::Middle);
    panel.add_message(Message::ChoiceBody, (language, &[]), middle, soft);
    add_buttons(panel, language, cards);
}

/// A step of the first cut.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Guide {
    /// The instruction.
    pub instruction: Message,
    /// A picture of the instruction.
    pub icon: Icon,
    /// The step's number, from 1.
    pub step: u32,
    /// The number of steps.
    pub steps: u32,
    /// Progress of the step, 0 to 1.
    pub progress: f32,
}

const GUIDE_SIZE: [f32; 2] = [1000.0, 450.0];

/// Returns the button that skips a guide.
#[must_use]
pub const fn guide_buttons(id: u16) -> [PanelButton<'static>; 1] {
    [PanelButton::new(id, PanelRect::new(664.0, 326.0, 290.0, 88.0), Message::Skip)]
}

/// Draws a step of the first cut: its picture, instruction and progress.
pub fn draw_guide(
    panel: &mut Panel,
    language: Language,
    guide: &Guide,
    buttons: &[PanelButton<'_>],
) {
    begin_panel(panel, GUIDE_SIZE);
    let heading = (palette::CLAY, TextAlign::Left);
    panel.add_message(Message::GuideTitle, (language, &[]), Vec2::new(46.0, 84.0), heading);
    let count = (palette::SOFT_INK, TextAlign::Right);
    let [step, steps] = [guide.step, guide.steps].map(FillingValue::Number);
    let fillings = [("step", step), ("steps", steps)];
    panel.add_message(Message::GuideStep, (language, &fillings), Vec2::new(954.0, 84.0), count);
    add_medallion(panel, guide.icon, Vec2::new(131.0, 208.0), 85.0, palette::CLAY);
    let style = guide.instruction.place().style().colored(palette::INK, TextAlign::Left);
    let width = guide.instruction.place().style().width_mm;
    let text = guide.instruction.text(language);
    panel.add_paragraph_around(text, Vec2::new(262.0, 208.0), width, &style);
    add_steps(panel, guide);
    add_buttons(panel, language, buttons);
}

/// Adds a dash for each step: full for the steps done.
fn add_steps(panel: &mut Panel, guide: &Guide) {
    let steps = guide.steps.clamp(1, 12);
    let (left, room, gap) = (46.0, 560.0, 12.0);
    let width = (room - gap * (steps - 1) as f32) / steps as f32;
    for k in 0..steps {
        let part = match k + 1 {
            number if number < guide.step => 1.0,
            number if number == guide.step => guide.progress,
            _ => 0.0,
        };
        let rect = PanelRect::new(left + (width + gap) * k as f32, 362.0, width, 16.0);
        panel.add_progress_bar(rect, part, [palette::LINE, palette::OLIVE]);
    }
}

/// The contents of a visit's clock, but for the buttons under it.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct Clock {
    /// Seconds left, and seconds in all; `None` for a visit without an end.
    pub seconds: Option<[u32; 2]>,
    /// A warning about the time left.
    pub warning: Option<Message>,
}

const CLOCK_WIDTH: f32 = 560.0;

impl Clock {
    /// Returns the tops of the warning and of what is under it, in millimetres from the panel's top.
    const fn feet(&self) -> [f32; 2] {
        let face = if self.seconds.is_some() { 190.0 } else { 24.0 };
        [face, face + if self.warning.is_some() { 136.0 } else { 0.0 }]
    }

    /// Returns buttons under the clock, one below the other, numbered from `first_id` on.
    pub fn buttons<const COUNT: usize>(
        &self,
        first_id: u16,
        labels: [(Message, Icon); COUNT],
    ) -> [PanelButton<'static>; COUNT] {
        let [_, top] = self.feet();
        core::array::from_fn(|k| {
            let (message, icon) = labels[k];
            let rect = PanelRect::new(30.0, top + 116.0 * k as f32, CLOCK_WIDTH - 60.0, 96.0);
            PanelButton::new(first_id + k as u16, rect, message).with_icon(icon)
        })
    }
}

/// Draws the clock of a visit: a ring, minutes and seconds; a warning under it, and buttons under that.
pub fn draw_clock(
    panel: &mut Panel,
    language: Language,
    clock: &Clock,
    buttons: &[PanelButton<'_>],
) {
    let [face, foot] = clock.feet();
    begin_panel(panel, [CLOCK_WIDTH, foot + 116.0 * buttons.len() as f32]);
    let color = clock.seconds.map_or(palette::INK, |[left, _]| time_color(left));
    if let Some(seconds) = clock.seconds {
        add_clock_face(panel, language, seconds, color);
    }
    if let Some(warning) = clock.warning {
        let style = warning.place().style().colored(color, TextAlign::Middle);
        let width = warning.place().style().width_mm;
        let at = Vec2::new(0.5 * CLOCK_WIDTH, face + 60.0);
        panel.add_paragraph_around(warning.text(language), at, width, &style);
    }
    add_buttons(panel, language, buttons);
}

fn add_clock_face(
    panel: &mut Panel,
    language: Language,
    [seconds_left, seconds]: [u32; 2],
    color: PanelColor,
) {
    let middle = Vec2::new(100.0, 96.0);
    let part = seconds_left as f32 / seconds.max(1) as f32;
    panel.add_ring(middle, [66.0, 15.0], 1.0, palette::LINE);
    panel.add_ring(middle, [66.0, 15.0], part, color);
    let icon = PanelRect::new(middle.x, middle.y, 0.0, 0.0).grown(31.0);
    panel.add_icon(Icon::Hourglass, icon, color);
    let label = (palette::SOFT_INK, TextAlign::Left);
    panel.add_message(Message::ClockLeft, (language, &[]), Vec2::new(196.0, 70.0), label);
    let digits =
        TextStyle { weight: FontWeight::Bold, capital_mm: 54.0, color, align: TextAlign::Left };
    let (minutes, rest) = (seconds_left / 60, seconds_left % 60);
    panel.add_written_line(format_args!("{minutes}:{rest:02}"), Vec2::new(194.0, 150.0), &digits);
}

/// Returns the colour of the time left: amber for the last two minutes, red for the last thirty seconds.
const fn time_color(seconds_left: u32) -> PanelColor {
    match seconds_left {
        0..=30 => palette::RED,
        31..=120 => palette::AMBER,
        _ => palette::OLIVE,
    }
}
