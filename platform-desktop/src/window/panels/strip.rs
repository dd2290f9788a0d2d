//! What is at hand while sculpting: tools, bits, depth, commands; and the end of a session.

use egui::{Align2, Area, Button, Context, Id, Label, RichText, Ui, Vec2};
use paros_core::input::{Mode, commands};
use paros_core::tools::{Bit, Tool};
use paros_core::workbench::Item;
use paros_core::world::Session;
use paros_shell::figures::Figure;

use super::{Asked, Shown, style};
use crate::window::hands::bits_of;

/// What was answered.
pub(super) enum Answer {
    None,
    Yes,
    No,
}

/// The line at the top.
pub(super) fn status(context: &Context, shown: &Shown<'_>) {
    let mut text = match shown.mode {
        Mode::None => return,
        Mode::FreeForm => "Free form".into(),
        Mode::Constrained { figure } => {
            let figure = Figure::HIDDEN.get(usize::from(figure));
            format!("The {} in the stone", figure.map_or("figure", |figure| figure.name()))
        }
        Mode::Creative => "Creative".into(),
        Mode::Own => String::from("Your own start"),
    };
    if shown.symmetry {
        text += "  ·  mirrored";
    }
    if let Some(path) = shown.opening {
        text += &format!("  ·  reading {}", path.display());
    }
    if !shown.fast {
        text += "  ·  the paper's path";
    }
    let left = Area::new(Id::new("status")).anchor(Align2::LEFT_TOP, Vec2::new(18.0, 14.0));
    left.interactable(false).show(context, |ui| ui.add(Label::new(style::quiet(text)).extend()));
    if let Some(fault) = shown.fault {
        let below = Area::new(Id::new("fault")).anchor(Align2::LEFT_TOP, Vec2::new(18.0, 36.0));
        let text = RichText::new(format!("Not saved: {fault}")).color(style::WARNING);
        below.interactable(false).show(context, |ui| ui.label(text));
    }
    let right = Area::new(Id::new("hint")).anchor(Align2::RIGHT_TOP, Vec2::new(-18.0, 14.0));
    right.interactable(false).show(context, |ui| ui.label(style::quiet("F1 help  ·  Esc start")));
}

/// The tools.
pub(super) fn tools(
    context: &Context,
    shown: &Shown<'_>,
    asked: &mut Vec<Asked>,
    finish: &mut bool,
) {
    let bottom = Area::new(Id::new("tools")).anchor(Align2::CENTER_BOTTOM, Vec2::new(0.0, -16.0));
    bottom.show(context, |ui| {
        style::card().inner_margin(egui::Margin::symmetric(12, 10)).show(ui, |ui| {
            ui.horizontal(|ui| {
                for (number, tool) in Tool::ALL.into_iter().enumerate() {
                    let held = shown.held.is_some_and(|(held, _)| held == tool);
                    let text = format!("{}  {}", number + 1, tool_name(tool));
                    if ui.add(style::choice(&text, held)).clicked() {
                        asked.push(Asked::Take(Item::Tool(tool)));
                    }
                }
                ui.add_space(10.0);
                edits(ui, shown, asked);
                ui.add_space(10.0);
                *finish = ui.add(Button::new("Finish")).clicked();
            });
            if let Some((tool, bit)) = shown.held {
                ui.horizontal(|ui| bits(ui, shown, (tool, bit), asked));
            }
        });
    });
}

fn edits(ui: &mut Ui, shown: &Shown<'_>, asked: &mut Vec<Asked>) {
    let (undo, redo) = shown.undo;
    for (text, possible, command) in
        [("Undo", undo > 0, commands::UNDO), ("Redo", redo > 0, commands::REDO)]
    {
        if ui.add_enabled(possible, Button::new(text)).clicked() {
            asked.push(Asked::Command(command));
        }
    }
    if ui.add(style::choice("Mirror", shown.symmetry)).clicked() {
        asked.push(Asked::Command(commands::SYMMETRY));
    }
}

fn bits(ui: &mut Ui, shown: &Shown<'_>, (tool, mounted): (Tool, Bit), asked: &mut Vec<Asked>) {
    for bit in bits_of(tool) {
        let mut text = RichText::new(bit.data().name).size(13.0);
        if bit != mounted {
            text = text.color(style::QUIET);
        }
        let button = Button::new(text).selected(bit == mounted);
        if ui.add(button).clicked() && bit != mounted {
            asked.push(Asked::Take(Item::Bit(bit)));
        }
    }
    let depth = match shown.depth {
        deep if deep >= 0.0 => format!("{deep:.0} mm deep"),
        off => format!("{:.0} mm off", -off),
    };
    ui.add_space(6.0);
    ui.label(style::quiet(format!("{depth}  (wheel)")).size(13.0));
}

/// Whether the session is to end.
pub(super) fn confirm(context: &Context) -> Answer {
    let mut answer = Answer::None;
    let bottom = Area::new(Id::new("confirm")).anchor(Align2::CENTER_BOTTOM, Vec2::new(0.0, -16.0));
    bottom.show(context, |ui| {
        style::card().show(ui, |ui| {
            ui.horizontal(|ui| {
                ui.label("Finish, and make a print of it?");
                ui.add_space(8.0);
                if ui.add(style::choice("Finish  (Enter)", true)).clicked() {
                    answer = Answer::Yes;
                }
                if ui.add(Button::new("Not yet  (Esc)")).clicked() {
                    answer = Answer::No;
                }
            });
        });
    });
    answer
}

/// The end of a session: where the print is.
pub(super) fn finished(context: &Context, shown: &Shown<'_>, start: &mut bool) -> Option<Asked> {
    debug_assert_eq!(shown.session, Session::Finished);
    let mut asked = None;
    let bottom =
        Area::new(Id::new("finished")).anchor(Align2::CENTER_BOTTOM, Vec2::new(0.0, -16.0));
    bottom.show(context, |ui| {
        style::card().show(ui, |ui| {
            ui.set_min_width(440.0);
            ui.label(RichText::new("Finished").size(19.0));
            match (shown.printing, shown.printed) {
                (true, _) => ui.label(style::quiet("making the print and a picture ...")),
                (false, Some(path)) => {
                    ui.label(format!("Print: {}", path.display()));
                    ui.label(style::quiet("with its picture (.png) and volume (.rmap) beside it"))
                }
                (false, None) if shown.unwritten => {
                    let text = "the print could not be written, but is not lost yet";
                    ui.label(RichText::new(text).color(style::WARNING))
                }
                (false, None) => ui.label(style::quiet("there is no print of it")),
            };
            ui.horizontal(|ui| {
                if ui.add(style::choice("Something new", true)).clicked() {
                    *start = true;
                }
                if ui.add(Button::new("Carve on")).clicked() {
                    asked = Some(Asked::CarveOn);
                }
                if shown.unwritten && ui.add(Button::new("Write it again")).clicked() {
                    asked = Some(Asked::WriteAgain);
                }
            });
        });
    });
    asked
}

const fn tool_name(tool: Tool) -> &'static str {
    match tool {
        Tool::Rotary => "Rotary",
        Tool::Impact => "Chisel",
        Tool::FillGun => "Paste",
        Tool::Rasp => "Rasp",
    }
}
