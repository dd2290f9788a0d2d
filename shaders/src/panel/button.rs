//! Buttons: rectangles of a panel with a label, a picture and a state. The caller decides what pressing one
//! does.

use glam::Vec2;
use paros_core::badge::Pictogram;

use super::font::Icon;
use super::layout::palette;
use super::message::{Language, Message, TextPlace};
use super::model::{BoxStyle, LINE_HEIGHT, Panel, PanelColor, TextAlign, TextStyle};
use super::pose::PanelRect;

/// A picture on a button.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum PanelPicture {
    /// An icon of the interface.
    Icon(Icon),
    /// A pictogram of a badge.
    Pictogram(Pictogram),
    /// The shell's picture in a cell, large on a card; an icon until the cell has a picture.
    Cell {
        /// The cell's number.
        cell: u8,
        /// The icon shown until then.
        until: Icon,
    },
}

/// A button's look.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum ButtonState {
    /// Not pointed at.
    #[default]
    Idle,
    /// Pointed at by a hand, ray or cursor.
    Hot,
    /// Being pressed.
    Pressed,
    /// Selected: shown with a tick and an olive outline.
    Chosen,
    /// Disabled: it can't be pressed.
    Off,
}

/// A button.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct PanelButton<'a> {
    /// The identifier, given by the caller.
    pub id: u16,
    /// Position and size.
    pub rect: PanelRect,
    /// The text.
    pub label: Option<ButtonLabel<'a>>,
    /// The picture: left of the text, or over it where the button is high.
    pub picture: Option<PanelPicture>,
    /// The look.
    pub state: ButtonState,
    /// `true` for the primary button, which leads to the next step.
    pub is_primary: bool,
}

/// A button's text.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ButtonLabel<'a> {
    /// A message in the panel's language.
    Message(Message),
    /// A message in a given language.
    MessageIn(Message, Language),
    /// A text taken literally, such as a digit.
    Text(&'a str),
}

/// Height in millimetres from which a button is a card, with its picture over its text.
const CARD_HEIGHT: f32 = 180.0;

/// A card's margin around its cell's picture, and the radius of the picture's corners, in millimetres.
const CELL_MARGIN: f32 = 14.0;
const CELL_RADIUS: f32 = 14.0;

/// Side of a selected button's tick, and its distance from the upper and right edges, in millimetres.
const TICK_SIDE: f32 = 26.0;
const TICK_INSET: f32 = 7.0;

/// Returns the identifier of the button at a point of a panel: the last one there that isn't disabled.
#[must_use]
pub fn find_button(buttons: &[PanelButton<'_>], at_mm: Vec2) -> Option<u16> {
    let at =
        |button: &&PanelButton<'_>| button.state != ButtonState::Off && button.rect.contains(at_mm);
    buttons.iter().rev().find(at).map(|button| button.id)
}

impl<'a> PanelButton<'a> {
    /// Creates an idle button with a message.
    #[must_use]
    pub const fn new(id: u16, rect: PanelRect, message: Message) -> Self {
        PanelButton {
            id,
            rect,
            label: Some(ButtonLabel::Message(message)),
            picture: None,
            state: ButtonState::Idle,
            is_primary: false,
        }
    }

    /// Returns the button with an icon.
    #[must_use]
    pub const fn with_icon(self, icon: Icon) -> Self {
        PanelButton { picture: Some(PanelPicture::Icon(icon)), ..self }
    }

    /// Returns the button with a cell's picture over its icon, if it has an icon.
    #[must_use]
    pub const fn with_cell(self, cell: u8) -> Self {
        match self.picture {
            Some(PanelPicture::Icon(until)) => {
                PanelButton { picture: Some(PanelPicture::Cell { cell, until }), ..self }
            }
            _ => self,
        }
    }

    /// Returns the button with another label.
    #[must_use]
    pub const fn with_label(self, label: ButtonLabel<'a>) -> Self {
        PanelButton { label: Some(label), ..self }
    }

    /// Returns the button in a state.
    #[must_use]
    pub const fn in_state(self, state: ButtonState) -> Self {
        PanelButton { state, ..self }
    }

    /// Returns the button as the primary one.
    #[must_use]
    pub const fn primary(self) -> Self {
        PanelButton { is_primary: true, ..self }
    }

    /// Returns the colours of the button's ground, outline and contents.
    const fn colors(&self) -> [PanelColor; 3] {
        match (self.state, self.is_primary) {
            (ButtonState::Off, _) => [palette::GROUND, palette::LINE, palette::FAINT],
            (ButtonState::Chosen, _) => [palette::PLASTER, palette::OLIVE, palette::INK],
            (ButtonState::Pressed, _) => [palette::CLAY_DARK, palette::CLAY_DARK, palette::PLASTER],
            (ButtonState::Hot, true) => [palette::CLAY_LIGHT, palette::INK, palette::PLASTER],
            (ButtonState::Idle, true) => [palette::CLAY, palette::CLAY, palette::PLASTER],
            (ButtonState::Hot, false) => [palette::SAND_LIGHT, palette::CLAY, palette::INK],
            (ButtonState::Idle, false) => [palette::SAND, palette::LINE, palette::INK],
        }
    }

    /// Returns the text, its style, and the width of its place in millimetres.
    fn text(&self, language: Language, color: PanelColor) -> Option<(&'a str, TextStyle, f32)> {
        let (text, place) = match self.label? {
            ButtonLabel::Message(message) => (message.text(language), message.place()),
            ButtonLabel::MessageIn(message, own) => (message.text(own), message.place()),
            ButtonLabel::Text(text) => (text, TextPlace::Button),
        };
        let place = place.style();
        Some((text, place.colored(color, TextAlign::Middle), place.width_mm))
    }
}

impl Panel {
    /// Adds a button.
    pub fn add_button(&mut self, language: Language, button: &PanelButton<'_>) {
        let PanelButton { rect, .. } = *button;
        let [fill, outline, ink] = button.colors();
        let is_card = rect.height >= CARD_HEIGHT;
        let radius_mm = if is_card { 22.0 } else { 18.0 };
        let outline_mm = match button.state {
            ButtonState::Hot | ButtonState::Chosen => 5.0,
            _ => 2.0,
        };
        self.add_box(
            rect,
            &BoxStyle { radius_mm, fill, outline, outline_mm, ..BoxStyle::default() },
        );
        if is_card {
            self.add_card_contents(language, button, ink);
        } else {
            self.add_row_contents(language, button, ink);
        }
        if button.state == ButtonState::Chosen {
            self.add_tick(rect);
        }
    }

    /// Adds the tick of a selected button, in its upper right corner.
    fn add_tick(&mut self, button: PanelRect) {
        let left = button.x + button.width - TICK_INSET - TICK_SIDE;
        let place = PanelRect::new(left, button.y + TICK_INSET, TICK_SIDE, TICK_SIDE);
        self.add_icon(Icon::Tick, place, palette::OLIVE);
    }

    /// Adds the contents of a card: the picture over the text.
    fn add_card_contents(&mut self, language: Language, button: &PanelButton<'_>, ink: PanelColor) {
        let rect = button.rect;
        let text = button.text(language, ink);
        let capital = text.map_or(0.0, |(_, style, _)| style.capital_mm);
        let room = if text.is_some() { capital * (1.0 + LINE_HEIGHT) + 46.0 } else { 0.0 };
        let side = (rect.height - room - 40.0).min(rect.width - 60.0);
        let picture = PanelRect::new(rect.middle().x - 0.5 * side, rect.y + 30.0, side, side);
        self.add_panel_picture(button.picture, picture, ink);
        if let Some(PanelPicture::Cell { cell, .. }) = button.picture {
            let side = (rect.height - room - CELL_MARGIN).min(rect.width - 2.0 * CELL_MARGIN);
            let left = rect.middle().x - 0.5 * side;
            let place = PanelRect::new(left, rect.y + CELL_MARGIN, side, side);
            self.add_image(cell, place, CELL_RADIUS);
        }
        if let Some((text, style, width)) = text {
            let width = width.min(rect.width - 24.0);
            let middle = rect.y + rect.height - 0.5 * room + 4.0;
            self.add_paragraph_around(text, Vec2::new(rect.middle().x, middle), width, &style);
        }
    }

    /// Adds the contents of a low button: the picture left of the text, both in the middle.
    fn add_row_contents(&mut self, language: Language, button: &PanelButton<'_>, ink: PanelColor) {
        let PanelRect { x, width, height, .. } = button.rect;
        let middle = button.rect.middle();
        let side = if button.picture.is_some() { (height - 36.0).min(68.0) } else { 0.0 };
        let Some((text, style, room)) = button.text(language, ink) else {
            let rect = PanelRect::new(middle.x, middle.y, 0.0, 0.0).grown(0.5 * side);
            return self.add_panel_picture(button.picture, rect, ink);
        };
        let gap = if side > 0.0 { 20.0 } else { 0.0 };
        let room = room.min(width - side - gap - 32.0);
        let measure = |line: &str| style.capital_mm * super::font::line_width(line, style.weight);
        let widest = super::wrap::WrappedLines::new(text, room, measure).map(measure);
        let widest = widest.fold(0.0, f32::max);
        let left = x + 0.5 * (width - side - gap - widest);
        let picture = PanelRect::new(left, middle.y - 0.5 * side, side, side);
        self.add_panel_picture(button.picture, picture, ink);
        let at = Vec2::new(left + side + gap + 0.5 * widest, middle.y);
        self.add_paragraph_around(text, at, room, &style);
    }

    fn add_panel_picture(
        &mut self,
        picture: Option<PanelPicture>,
        rect: PanelRect,
        color: PanelColor,
    ) {
        match picture {
            Some(PanelPicture::Icon(icon) | PanelPicture::Cell { until: icon, .. }) => {
                self.add_icon(icon, rect, color);
            }
            Some(PanelPicture::Pictogram(pictogram)) => self.add_pictogram(pictogram, rect, color),
            None => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_finds_the_last_button_that_has_it() {
        let at = |id, x, state| {
            PanelButton::new(id, PanelRect::new(x, 10.0, 100.0, 50.0), Message::Begin)
                .in_state(state)
        };
        let buttons = [
            at(7, 0.0, ButtonState::Idle),
            at(8, 80.0, ButtonState::Chosen),
            at(9, 300.0, ButtonState::Off),
        ];
        for (x, y, found) in [
            (50.0, 30.0, Some(7)),
            (90.0, 30.0, Some(8)),
            (180.0, 60.0, Some(8)),
            (181.0, 60.0, None),
            (50.0, 9.0, None),
            (320.0, 30.0, None),
            (f32::NAN, 30.0, None),
        ] {
            assert_eq!(find_button(&buttons, Vec2::new(x, y)), found, "{x}, {y}");
        }
    }
}
