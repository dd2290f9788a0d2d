//! Start panel: choice of a session or a file.

use egui::{Align2, Area, Button, Context, Id, RichText, Ui, Vec2};
use paros_core::session::{SessionMode, SessionState};
use paros_shell::figures::Figure;

use super::strip::Confirmation;
use super::{StudioStatus, style};

/// The visitor's choice.
pub(super) enum StartChoice {
    None,
    Continue,
    Browse,
    OneBefore,
    Start(SessionMode),
}

const WIDTH: f32 = 400.0;

pub(super) fn show(context: &Context, status: &StudioStatus<'_>) -> StartChoice {
    let area = Area::new(Id::new("start")).anchor(Align2::CENTER_CENTER, Vec2::ZERO);
    let mut answer = StartChoice::None;
    area.show(context, |ui| {
        style::card_frame().inner_margin(28).show(ui, |ui| {
            ui.set_width(WIDTH);
            ui.label(RichText::new("Paros").size(34.0));
            ui.label(style::quiet_text("Carve a sculpture, and take a print of it home."));
            ui.add_space(10.0);
            answer = show_choices(ui, status);
        });
    });
    answer
}

fn show_choices(ui: &mut Ui, status: &StudioStatus<'_>) -> StartChoice {
    let mut answer = StartChoice::None;
    if status.session != SessionState::Waiting {
        let text = match status.session {
            SessionState::Finished => "Back to the finished sculpture",
            _ => "Go on with your sculpture",
        };
        if ui.add_sized([WIDTH, 44.0], style::choice_button(text, true)).clicked() {
            answer = StartChoice::Continue;
        }
        ui.add_space(6.0);
    }
    if status.one_before
        && add_wide_button(ui, "The one before", "the sculpture that you left for another")
    {
        answer = StartChoice::OneBefore;
    }
    if add_wide_button(ui, "Free form", "a lump of marble, and all the tools") {
        answer = StartChoice::Start(SessionMode::FreeForm);
    }
    if add_wide_button(ui, "Creative", "a friendly figure to shape as you like") {
        answer = StartChoice::Start(SessionMode::Creative);
    }
    ui.add_space(4.0);
    ui.label("Find what hides in the stone");
    ui.label(style::quiet_text("it can't be harmed").small());
    ui.horizontal(|ui| {
        let gaps = 8.0 * (Figure::HIDDEN.len() - 1) as f32;
        let width = (WIDTH - gaps) / Figure::HIDDEN.len() as f32;
        for (number, figure) in Figure::HIDDEN.into_iter().enumerate() {
            if ui.add_sized([width, 36.0], Button::new(capitalized_name(figure))).clicked() {
                answer = StartChoice::Start(SessionMode::Constrained { figure: number as u8 });
            }
        }
    });
    ui.add_space(6.0);
    ui.separator();
    match status.opening {
        Some(path) => {
            ui.label(style::quiet_text(format!("Reading {} ...", path.display())));
        }
        None => {
            let what = match status.drops {
                true => "or drop a file on this window",
                false => "a file to start from",
            };
            if add_wide_button(ui, "Open a mesh or a volume ...", what) {
                answer = StartChoice::Browse;
            }
        }
    }
    ui.label(style::quiet_text("F1 shows all keys").small());
    answer
}

/// Shows the question before a start that leaves a sculpture.
pub(super) fn show_question(context: &Context) -> Confirmation {
    let mut answer = Confirmation::None;
    let area = Area::new(Id::new("question")).anchor(Align2::CENTER_CENTER, Vec2::ZERO);
    area.show(context, |ui| {
        style::card_frame().inner_margin(24).show(ui, |ui| {
            ui.set_width(WIDTH);
            ui.label(RichText::new("Leave this sculpture unfinished?").size(19.0));
            let kept = "It is kept: the start panel has it as \"The one before\", until you leave another.";
            ui.label(style::quiet_text(kept));
            ui.add_space(4.0);
            ui.horizontal(|ui| {
                if ui.add(style::choice_button("Start anew  (Enter)", true)).clicked() {
                    answer = Confirmation::Yes;
                }
                if ui.add(Button::new("Stay with it  (Esc)")).clicked() {
                    answer = Confirmation::No;
                }
            });
        });
    });
    answer
}

/// Adds a wide button of two lines. Returns whether it was clicked.
fn add_wide_button(ui: &mut Ui, title: &str, what: &str) -> bool {
    let mut text = egui::text::LayoutJob::default();
    let font = |size| egui::FontId::proportional(size);
    let format = |size, color| egui::TextFormat::simple(font(size), color);
    text.append(title, 0.0, format(16.0, style::TEXT));
    text.append("\n", 0.0, format(4.0, style::TEXT));
    text.append(what, 0.0, format(12.5, style::QUIET));
    let button = Button::new(text).min_size(Vec2::new(WIDTH, 52.0));
    ui.add(button).clicked()
}

fn capitalized_name(figure: Figure) -> String {
    let name = figure.name();
    name[..1].to_uppercase() + &name[1..]
}
