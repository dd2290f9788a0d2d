//! The start: which session, or which file.

use egui::{Align2, Area, Button, Context, Id, RichText, Ui, Vec2};
use paros_core::input::Mode;
use paros_core::world::Session;
use paros_shell::figures::Figure;

use super::{Shown, style};

/// What was chosen.
pub(super) enum Answer {
    None,
    Continue,
    Browse,
    Start(Mode),
}

const WIDTH: f32 = 400.0;

pub(super) fn show(context: &Context, shown: &Shown<'_>) -> Answer {
    let area = Area::new(Id::new("start")).anchor(Align2::CENTER_CENTER, Vec2::ZERO);
    let mut answer = Answer::None;
    area.show(context, |ui| {
        style::card().inner_margin(28).show(ui, |ui| {
            ui.set_width(WIDTH);
            ui.label(RichText::new("Paros").size(34.0));
            ui.label(style::quiet("Carve a sculpture, and take a print of it home."));
            ui.add_space(10.0);
            answer = choices(ui, shown);
        });
    });
    answer
}

fn choices(ui: &mut Ui, shown: &Shown<'_>) -> Answer {
    let mut answer = Answer::None;
    if shown.session != Session::Waiting {
        let text = match shown.session {
            Session::Finished => "Back to the finished sculpture",
            _ => "Go on with your sculpture",
        };
        if ui.add_sized([WIDTH, 44.0], style::choice(text, true)).clicked() {
            answer = Answer::Continue;
        }
        ui.add_space(6.0);
    }
    if wide(ui, "Free form", "a lump of marble, and all the tools") {
        answer = Answer::Start(Mode::FreeForm);
    }
    if wide(ui, "Creative", "a friendly figure to shape as you like") {
        answer = Answer::Start(Mode::Creative);
    }
    ui.add_space(4.0);
    ui.label("Find what hides in the stone");
    ui.label(style::quiet("it can't be harmed").small());
    ui.horizontal(|ui| {
        let gaps = 8.0 * (Figure::HIDDEN.len() - 1) as f32;
        let width = (WIDTH - gaps) / Figure::HIDDEN.len() as f32;
        for (number, figure) in Figure::HIDDEN.into_iter().enumerate() {
            if ui.add_sized([width, 36.0], Button::new(named(figure))).clicked() {
                answer = Answer::Start(Mode::Constrained { figure: number as u8 });
            }
        }
    });
    ui.add_space(6.0);
    ui.separator();
    match shown.opening {
        Some(path) => {
            ui.label(style::quiet(format!("Reading {} ...", path.display())));
        }
        None => {
            let what = match shown.drops {
                true => "or drop a file on this window",
                false => "a file to start from",
            };
            if wide(ui, "Open a mesh or a volume ...", what) {
                answer = Answer::Browse;
            }
        }
    }
    ui.label(style::quiet("F1 shows all keys").small());
    answer
}

/// A wide button of two lines.
fn wide(ui: &mut Ui, title: &str, what: &str) -> bool {
    let mut text = egui::text::LayoutJob::default();
    let font = |size| egui::FontId::proportional(size);
    let format = |size, color| egui::TextFormat::simple(font(size), color);
    text.append(title, 0.0, format(16.0, style::TEXT));
    text.append("\n", 0.0, format(4.0, style::TEXT));
    text.append(what, 0.0, format(12.5, style::QUIET));
    let button = Button::new(text).min_size(Vec2::new(WIDTH, 52.0));
    ui.add(button).clicked()
}

fn named(figure: Figure) -> String {
    let name = figure.name();
    name[..1].to_uppercase() + &name[1..]
}
