//! Tool bar: tools, bits, depth, commands; status line; end of a session.

use egui::{Align2, Area, Button, Context, Id, Label, RichText, Stroke, Ui, Vec2};
use paros_core::edit::UndoCounts;
use paros_core::internals::{BitShape, SizeRange, ToolBitSpec};
use paros_core::session::{
    BenchItem, FOUND_PERCENT, SessionMode, SessionState, Tool, ToolBit, commands,
};
use paros_shaders::panel::{FillingValue, Language, Message};
use paros_visit::name_of_start;

use super::hints::Hint;
use super::{PanelAction, StudioStatus, style, words};
use crate::window::hands::{DEPTHS_MM, tool_bits_of};

/// Width of the tool bar in points, if the window is wide enough. Any tool's bits fit in one row, in any
/// language.
const BAR_WIDTH: f32 = 1000.0;

/// Distance from the window's lower edge to the panels at the bottom, in points.
const BOTTOM_GAP: f32 = 16.0;

/// The answer to the confirmation.
pub(super) enum Confirmation {
    None,
    Yes,
    No,
}

/// A button of the tool bar that opens a panel.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum BarButton {
    /// Asks to finish the session; needs a confirmation.
    Finish,
    /// Shows or hides the help.
    Help,
}

/// The result of a frame's tool bar.
pub(super) struct ToolBar {
    pub(super) clicked: Option<BarButton>,
    /// Distance from the bar's upper edge to the window's lower edge, in points.
    pub(super) height: f32,
}

/// The result of a frame's panel at the end of a session.
pub(super) struct FinishedPanel {
    pub(super) choice: Option<FinishedChoice>,
    /// Distance as in [`ToolBar::height`].
    pub(super) height: f32,
}

/// The visitor's choice at the end of a session.
pub(super) enum FinishedChoice {
    /// Show the start panel.
    SomethingNew,
    Action(PanelAction),
}

/// Shows the status line at the top, with warnings if the machine is too slow or the session isn't saved.
pub(super) fn show_status(context: &Context, status: &StudioStatus<'_>) {
    let Some(mut text) = describe_mode(status) else { return };
    for (_, told) in
        [(status.symmetry, Message::BarMirrored), (status.is_steadied, Message::BarSteadyHand)]
            .into_iter()
            .filter(|(is_so, _)| *is_so)
    {
        text += "  ·  ";
        text += told.text(status.language);
    }
    if let Some(path) = status.opening {
        text += &format!("  ·  reading {}", path.display());
    }
    if !status.fast {
        text += "  ·  the paper's path";
    }
    // A visit has its own panels and instructions there.
    let hint_width = if status.visit.is_some() { 0.0 } else { show_keys_hint(context) };
    let frame = style::line_frame();
    let beside_hint = hint_width + style::MARGIN;
    let width = style::largest_content_size(context, &frame).x - beside_hint;
    let left = Area::new(Id::new("status")).anchor(Align2::LEFT_TOP, Vec2::new(12.0, 10.0));
    left.interactable(false).show(context, |ui| {
        let line = |ui: &mut Ui, text: RichText| {
            frame.show(ui, |ui| {
                ui.set_max_width(width);
                ui.add(Label::new(text).wrap());
            });
        };
        // The guided cut has its own panel in this place.
        if !status.has_guide {
            line(ui, style::quiet_text(text));
        }
        if let Some(slowness) = status.slow {
            let text = slowness.describe_with_help(status.fast, status.grid_side);
            line(ui, RichText::new(text).color(style::WARNING));
        }
        if let Some(fault) = status.fault {
            line(ui, RichText::new(format!("Not saved: {fault}")).color(style::WARNING));
        }
    });
}

/// Shows the hint about keys at the upper right. Returns its width in points.
fn show_keys_hint(context: &Context) -> f32 {
    let right = Area::new(Id::new("hint")).anchor(Align2::RIGHT_TOP, Vec2::new(-12.0, 10.0));
    let right = right.interactable(false).show(context, |ui| {
        let hint = Label::new(style::quiet_text("F1 help  ·  Esc start")).extend();
        style::line_frame().show(ui, |ui| ui.add(hint));
    });
    right.response.rect.width()
}

/// Bared percentage from which a hidden figure is described as nearly out.
const NEARLY_PERCENT: u32 = 80;

/// Describes the mode: the kind of session, and for a hidden figure the bared percentage and whether it is
/// found.
fn describe_mode(status: &StudioStatus<'_>) -> Option<String> {
    let plain = |message: Message| Some(message.text(status.language).into());
    let message = match (status.mode, status.bared_percent) {
        (SessionMode::None, _) => return None,
        (SessionMode::FreeForm, _) => return plain(Message::BarFreeForm),
        (SessionMode::Creative, _) => return plain(Message::BarCreative),
        (SessionMode::Own, _) => return plain(Message::BarOwnStart),
        (SessionMode::Constrained { .. }, FOUND_PERCENT..) => Message::BarFigureFound,
        (SessionMode::Constrained { .. }, NEARLY_PERCENT..) => Message::BarFigureNearly,
        (SessionMode::Constrained { .. }, _) => Message::BarFigureHidden,
    };
    let figure = FillingValue::Text(name_of_start(status.mode).text(status.language));
    let percent = FillingValue::Number(status.bared_percent);
    Some(words::say(status.language, message, &[("figure", figure), ("percent", percent)]))
}

/// Shows the tool bar, with a hint above the tools.
pub(super) fn show_tools(
    context: &Context,
    status: &StudioStatus<'_>,
    (hint, is_help_shown): (Hint, bool),
    actions: &mut Vec<PanelAction>,
) -> ToolBar {
    let (mut clicked, language) = (None, status.language);
    let is_measured = is_area_measured(context, "tools");
    let bottom =
        Area::new(Id::new("tools")).anchor(Align2::CENTER_BOTTOM, Vec2::new(0.0, -BOTTOM_GAP));
    let shown = bottom.show(context, |ui| {
        let frame = style::card_frame().inner_margin(egui::Margin::symmetric(12, 10));
        style::show_rows(ui, frame, |ui| {
            // The width is constant and the tools are at the bottom, so that they don't move when the texts
            // above change.
            ui.set_width(ui.max_rect().width().min(BAR_WIDTH));
            if let Some(text) = hint.text {
                let text = RichText::new(text.text(language)).color(style::ACCENT).size(14.0);
                ui.add(Label::new(text).wrap());
            }
            if let Some((tool, bit)) = status.held {
                ui.horizontal_wrapped(|ui| show_bits(ui, status, (tool, bit), hint.bit, actions));
            }
            ui.horizontal_wrapped(|ui| {
                for (number, tool) in Tool::ALL.into_iter().enumerate() {
                    let held = status.held.is_some_and(|(held, _)| held == tool);
                    let name = words::tool_name(tool).text(language);
                    let text = format!("{}  {name}", number + 1);
                    if ui.add(style::choice_button(&text, held)).clicked() {
                        actions.push(PanelAction::Take(BenchItem::Tool(tool)));
                    }
                }
                ui.add_space(10.0);
                show_edits(ui, status, actions);
                ui.add_space(10.0);
                // In a visit a panel of the visit ends the session. The button for the help takes this place.
                let (button, text) = match status.visit {
                    None => (BarButton::Finish, "Finish"),
                    Some(_) => (BarButton::Help, Message::BarHelp.text(language)),
                };
                let is_shown = button == BarButton::Help && is_help_shown;
                if ui.add(style::choice_button(text, is_shown)).clicked() {
                    clicked = Some(button);
                }
            });
        });
    });
    let height = if is_measured { shown.response.rect.height() + BOTTOM_GAP } else { 0.0 };
    ToolBar { clicked, height }
}

/// Returns `true` if an area has been measured. It has no size in its first frame.
fn is_area_measured(context: &Context, name: &'static str) -> bool {
    context.memory(|memory| memory.area_rect(name)).is_some()
}

fn show_edits(ui: &mut Ui, status: &StudioStatus<'_>, actions: &mut Vec<PanelAction>) {
    let UndoCounts { undoable, redoable } = status.undo;
    let text = |message: Message| message.text(status.language);
    for (message, possible, command) in [
        (Message::Undo, undoable > 0, commands::UNDO),
        (Message::BarRedo, redoable > 0, commands::REDO),
    ] {
        if ui.add_enabled(possible, Button::new(text(message))).clicked() {
            actions.push(PanelAction::Command(command));
        }
    }
    if ui.add(style::choice_button(text(Message::BarMirror), status.symmetry)).clicked() {
        actions.push(PanelAction::Command(commands::SYMMETRY));
    }
}

fn show_bits(
    ui: &mut Ui,
    status: &StudioStatus<'_>,
    (tool, mounted): (Tool, ToolBit),
    hinted: Option<ToolBit>,
    actions: &mut Vec<PanelAction>,
) {
    for bit in tool_bits_of(tool) {
        let mut text = RichText::new(words::bit_name(bit).text(status.language)).size(13.0);
        if bit != mounted {
            text = text.color(style::QUIET);
        }
        let mut button = Button::new(text).selected(bit == mounted);
        if hinted == Some(bit) {
            button = button.stroke(Stroke::new(1.5, style::ACCENT));
        }
        if ui.add(button).clicked() && bit != mounted {
            actions.push(PanelAction::Take(BenchItem::Bit(bit)));
        }
    }
    show_size(ui, status, mounted, actions);
    let depth = depth_text(status.depth_mm, status.print_scale, status.language);
    let is_least = status.depth_mm < *DEPTHS_MM.end();
    let wheel = if is_least { Message::BarWheelDeeper } else { Message::BarWheelShallower };
    let text = RichText::new(format!("{depth}  {}", wheel.text(status.language))).size(13.0);
    // A bit that hovers cuts nothing: warn by the colour.
    let color = if status.depth_mm < 0.0 { style::WARNING } else { style::QUIET };
    ui.label(text.color(color));
}

/// Shows the mounted bit's width between buttons that make it smaller and larger. A bit of a single size has
/// no buttons.
fn show_size(ui: &mut Ui, status: &StudioStatus<'_>, bit: ToolBit, actions: &mut Vec<PanelAction>) {
    let spec = bit.spec_at(status.size);
    let SizeRange { smallest, largest } = spec.sizes;
    let steps = status.size.steps();
    ui.add_space(6.0);
    if smallest < largest {
        let mut button = |ui: &mut Ui, text: &str, possible: bool, by: i8| {
            if ui.add_enabled(possible, Button::new(text)).clicked() {
                actions.push(PanelAction::Resize(by));
            }
        };
        button(ui, Message::BarSmaller.text(status.language), steps > smallest, -1);
        button(ui, Message::BarLarger.text(status.language), steps < largest, 1);
    }
    ui.label(style::quiet_text(width_text(&spec, status.language)).size(13.0));
    ui.add_space(6.0);
}

/// Describes a bit's width in words.
fn width_text(spec: &ToolBitSpec, language: Language) -> String {
    let mm = |half_um: i32| f64::from(2 * half_um) * 1e-3;
    match spec.shape {
        BitShape::Ball { radius_um } | BitShape::Disc { radius_um } => {
            let mm = format!("{:.0}", mm(radius_um));
            words::say(language, Message::BarWidth, &[("mm", FillingValue::Text(&mm))])
        }
        BitShape::Box { half_extents_um: [x, y, z] } => {
            format!("{:.0} x {:.0} x {:.0} mm", mm(x), mm(y), mm(z))
        }
    }
}

/// Describes a tool's depth: in the room, in the print, and if the wheel has reached its limit.
fn depth_text(depth_mm: f32, print_scale: Option<f32>, language: Language) -> String {
    let say = |message, depth: String| {
        words::say(language, message, &[("depth", FillingValue::Text(&depth))])
    };
    let mut text = match depth_mm {
        deep if deep >= 0.0 => say(Message::BarDepth, format!("{deep:.0}")),
        above => say(Message::BarHover, format!("{:.0}", -above)),
    };
    if let Some(scale) = print_scale.filter(|_| depth_mm >= 0.0) {
        text += &say(Message::BarPrint, format!("{:.1}", depth_mm * scale));
    }
    if depth_mm >= *DEPTHS_MM.end() {
        text += Message::BarMost.text(language);
    } else if depth_mm <= *DEPTHS_MM.start() {
        text += Message::BarLeast.text(language);
    }
    text
}

/// Asks for confirmation of the session's end.
pub(super) fn show_confirmation(context: &Context) -> Confirmation {
    let mut answer = Confirmation::None;
    let bottom =
        Area::new(Id::new("confirm")).anchor(Align2::CENTER_BOTTOM, Vec2::new(0.0, -BOTTOM_GAP));
    bottom.show(context, |ui| {
        style::show_rows(ui, style::card_frame(), |ui| {
            ui.horizontal_wrapped(|ui| {
                ui.label("Finish, and make a print of it?");
                ui.add_space(8.0);
                if ui.add(style::choice_button("Finish  (Enter)", true)).clicked() {
                    answer = Confirmation::Yes;
                }
                if ui.add(Button::new("Not yet  (Esc)")).clicked() {
                    answer = Confirmation::No;
                }
            });
        });
    });
    answer
}

/// Shows the panel at the end of a session, with the print's path.
pub(super) fn show_finished(context: &Context, status: &StudioStatus<'_>) -> FinishedPanel {
    debug_assert_eq!(status.session, SessionState::Finished);
    let mut choice = None;
    let is_measured = is_area_measured(context, "finished");
    let bottom =
        Area::new(Id::new("finished")).anchor(Align2::CENTER_BOTTOM, Vec2::new(0.0, -BOTTOM_GAP));
    let shown = bottom.show(context, |ui| {
        style::show_within_window(ui, style::card_frame(), 520.0, |ui| {
            ui.label(RichText::new("Finished").size(19.0));
            match (status.printing, status.printed) {
                (true, _) => ui.label(style::quiet_text("making the print and a picture ...")),
                (false, Some(path)) if status.kiosk => {
                    // A kiosk's visitor can't open files, but can ask the staff for the sculpture by its
                    // name.
                    let name = path.file_stem().unwrap_or_default().display();
                    ui.label(format!("Kept as {name}"));
                    ui.label(style::quiet_text("with its print and a picture"))
                }
                (false, Some(path)) => {
                    ui.label(format!("Print: {}", path.display()));
                    ui.label(style::quiet_text(
                        "with its picture (.png) and volume (.rmap) beside it",
                    ))
                }
                (false, None) if status.unwritten => {
                    let text = "the print could not be written, but is not lost yet";
                    ui.label(RichText::new(text).color(style::WARNING))
                }
                (false, None) => {
                    let text = "no print of it was made since the window opened";
                    ui.label(style::quiet_text(text))
                }
            };
            ui.label(style::quiet_text(
                "Drag over it to see it from all sides, wheel: nearer, farther.",
            ));
            ui.horizontal_wrapped(|ui| {
                if ui.add(style::choice_button("Something new  (Esc)", true)).clicked() {
                    choice = Some(FinishedChoice::SomethingNew);
                }
                if ui.add(Button::new("Carve on")).clicked() {
                    choice = Some(FinishedChoice::Action(PanelAction::CarveOn));
                }
                if status.unwritten && ui.add(Button::new("Write it again")).clicked() {
                    choice = Some(FinishedChoice::Action(PanelAction::WriteAgain));
                }
            });
        });
    });
    let height = if is_measured { shown.response.rect.height() + BOTTOM_GAP } else { 0.0 };
    FinishedPanel { choice, height }
}

#[cfg(test)]
mod tests {
    use paros_shaders::panel::Language;

    use super::depth_text;

    #[test]
    fn a_depth_is_told_in_the_room_and_in_the_print_and_at_its_ends() {
        let text = |mm| depth_text(mm, Some(0.25), Language::English);
        assert_eq!(text(9.0), "9 mm deep, 2.2 mm in the print");
        assert_eq!(text(40.0), "40 mm deep, 10.0 mm in the print, the most");
        assert_eq!(text(-5.0), "hover: 5 mm above the stone");
        assert_eq!(text(-20.0), "hover: 20 mm above the stone, the least");
        let unprinted = depth_text(9.0, None, Language::English);
        assert_eq!(unprinted, "9 mm deep", "there is nothing to print");
    }
}
