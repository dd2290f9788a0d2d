//! Start panel: choice of a session or a file.

use egui::{
    Align2, Area, Button, Color32, Context, Id, Pos2, Rect, RichText, TextureHandle, Ui, Vec2,
};
use paros_core::session::{SessionMode, SessionState};
use paros_shell::figures::{Figure, HiddenStart, StoneThickness};

use super::strip::Confirmation;
use super::{StudioStatus, style};
use crate::window::start_pictures::pictured_figures;

/// The visitor's choice.
pub(super) enum StartChoice {
    None,
    Continue,
    Browse,
    OneBefore,
    Start(SessionMode),
}

const WIDTH: f32 = 400.0;

/// Size of a wide button's picture in points, in the proportions of the picture's pixels.
const CARD_SIZE: Vec2 = Vec2::new(75.0, 60.0);

/// Height of the window in points below which the panel has two columns.
const LOW: f32 = 760.0;

pub(super) fn show(
    context: &Context,
    status: &StudioStatus<'_>,
    pictures: Option<&TextureHandle>,
    thickness: &mut StoneThickness,
) -> StartChoice {
    let area = Area::new(Id::new("start")).anchor(Align2::CENTER_CENTER, Vec2::ZERO);
    let is_low = context.content_rect().height() < LOW;
    let (margin, width) = if is_low { (16, 2.0 * WIDTH) } else { (28, WIDTH) };
    let mut answer = StartChoice::None;
    area.show(context, |ui| {
        style::show_within_window(ui, style::card_frame().inner_margin(margin), width, |ui| {
            if is_low {
                ui.columns(2, |columns| {
                    show_title(&mut columns[0]);
                    show_whole_stones(&mut columns[0], status, pictures, &mut answer);
                    show_hidden_and_files(
                        &mut columns[1],
                        status,
                        pictures,
                        thickness,
                        &mut answer,
                    );
                });
            } else {
                show_title(ui);
                ui.add_space(10.0);
                show_whole_stones(ui, status, pictures, &mut answer);
                ui.add_space(4.0);
                show_hidden_and_files(ui, status, pictures, thickness, &mut answer);
            }
        });
    });
    answer
}

fn show_title(ui: &mut Ui) {
    ui.label(RichText::new("Paros").size(34.0));
    let text = style::quiet_text("Carve a sculpture, and take a print of it home.");
    ui.label(if ui.available_width() < WIDTH { text.small() } else { text });
}

/// Shows the existing sculptures, and the starts without a hidden figure.
fn show_whole_stones(
    ui: &mut Ui,
    status: &StudioStatus<'_>,
    pictures: Option<&TextureHandle>,
    answer: &mut StartChoice,
) {
    // A kiosk's next visitor can't return to the last visitor's sculpture.
    let is_of_another = status.kiosk && status.session == SessionState::Finished;
    if status.session != SessionState::Waiting && !is_of_another {
        let text = match status.session {
            SessionState::Finished => "Back to the finished sculpture",
            _ => "Go on with your sculpture",
        };
        let size = [ui.available_width(), 44.0];
        if ui.add_sized(size, style::choice_button(text, true)).clicked() {
            *answer = StartChoice::Continue;
        }
        ui.add_space(6.0);
    }
    if status.one_before
        && add_wide_button(ui, None, "The one before", "the sculpture that you left for another")
    {
        *answer = StartChoice::OneBefore;
    }
    let lump = pictures.map(|pictures| (pictures, Figure::Lump));
    if add_wide_button(ui, lump, "Free form", "a lump of marble, all tools") {
        *answer = StartChoice::Start(SessionMode::FreeForm);
    }
    let toy = pictures.map(|pictures| (pictures, Figure::Toy));
    if add_wide_button(ui, toy, "Creative", "a figure to shape as you like") {
        *answer = StartChoice::Start(SessionMode::Creative);
    }
}

fn show_hidden_and_files(
    ui: &mut Ui,
    status: &StudioStatus<'_>,
    pictures: Option<&TextureHandle>,
    thickness: &mut StoneThickness,
    answer: &mut StartChoice,
) {
    if let Some(hidden) = show_hidden_figures(ui, pictures, thickness) {
        *answer = StartChoice::Start(hidden.mode());
    }
    ui.add_space(6.0);
    ui.separator();
    match status.opening {
        Some(path) => {
            ui.label(style::quiet_text(format!("Reading {} ...", path.display())));
        }
        None if status.kiosk => {}
        None => {
            let what = match status.drops {
                true => "or drop a file on this window",
                false => "a file to start from",
            };
            if add_wide_button(ui, None, "Open a mesh or a volume ...", what) {
                *answer = StartChoice::Browse;
            }
        }
    }
    ui.label(style::quiet_text("F1 shows all keys").small());
}

/// Shows the hidden figures and the choice of stone thickness over them. Returns the visitor's choice.
fn show_hidden_figures(
    ui: &mut Ui,
    pictures: Option<&TextureHandle>,
    thickness: &mut StoneThickness,
) -> Option<HiddenStart> {
    ui.label("Find what hides in the stone");
    ui.label(style::quiet_text("it can't be harmed; over it lies").small());
    ui.horizontal(|ui| {
        for (value, text) in [
            (StoneThickness::Near, "a thin coat"),
            (StoneThickness::Half, "half the stone"),
            (StoneThickness::Whole, "all of it"),
        ] {
            ui.selectable_value(thickness, value, RichText::new(text).small());
        }
    });
    let mut answer = None;
    ui.horizontal(|ui| {
        ui.spacing_mut().button_padding.x = 2.0;
        let gaps = ui.spacing().item_spacing.x * (Figure::HIDDEN.len() - 1) as f32;
        let width = (ui.available_width() - gaps) / Figure::HIDDEN.len() as f32;
        for figure in Figure::HIDDEN {
            let picture = pictures.map(|pictures| (pictures, figure));
            if add_figure_button(ui, picture, &capitalized_name(figure), width) {
                answer = Some(HiddenStart { figure, thickness: *thickness });
            }
        }
    });
    answer
}

/// Asks for confirmation of a start that discards a sculpture.
pub(super) fn show_question(context: &Context) -> Confirmation {
    let mut answer = Confirmation::None;
    let area = Area::new(Id::new("question")).anchor(Align2::CENTER_CENTER, Vec2::ZERO);
    area.show(context, |ui| {
        style::show_within_window(ui, style::card_frame().inner_margin(24), WIDTH, |ui| {
            ui.label(RichText::new("Leave this sculpture unfinished?").size(19.0));
            let kept = "It is kept: the start panel has it as \"The one before\", until you leave another.";
            ui.label(style::quiet_text(kept));
            ui.add_space(4.0);
            ui.horizontal(|ui| {
                if ui.add(style::choice_button("Leave it  (Enter)", true)).clicked() {
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

/// The pictures of the starts, and the figure to pick from them.
type Picture<'a> = Option<(&'a TextureHandle, Figure)>;

/// Adds a wide button with two lines of text and a picture on the left. Returns `true` if it was clicked.
fn add_wide_button(ui: &mut Ui, picture: Picture<'_>, title: &str, what: &str) -> bool {
    let indent = if picture.is_some() { CARD_SIZE.x + 4.0 } else { 0.0 };
    let mut text = egui::text::LayoutJob::default();
    let font = |size| egui::FontId::proportional(size);
    let format = |size, color| egui::TextFormat::simple(font(size), color);
    text.append(title, indent, format(16.0, style::TEXT));
    text.append("\n", 0.0, format(4.0, style::TEXT));
    text.append(what, indent, format(12.5, style::QUIET));
    let height = if picture.is_some() { CARD_SIZE.y + 8.0 } else { 52.0 };
    let button = ui.add(Button::new(text).min_size(Vec2::new(ui.available_width(), height)));
    let place = Rect::from_min_size(button.rect.min + Vec2::splat(4.0), CARD_SIZE);
    draw_picture(ui, picture, place);
    button.clicked()
}

/// Adds a button with a figure's picture and its name below. Returns `true` if it was clicked.
fn add_figure_button(ui: &mut Ui, picture: Picture<'_>, name: &str, width: f32) -> bool {
    if picture.is_none() {
        return ui.add_sized([width, 36.0], Button::new(name)).clicked();
    }
    let size = Vec2::new(width - 8.0, (width - 8.0) * CARD_SIZE.y / CARD_SIZE.x);
    let button = ui.add_sized([width, size.y + 28.0], Button::new(""));
    draw_picture(ui, picture, Rect::from_min_size(button.rect.min + Vec2::splat(4.0), size));
    let under = button.rect.center_bottom() - Vec2::new(0.0, 4.0);
    let font = egui::FontId::proportional(if width < 80.0 { 13.0 } else { 15.0 });
    ui.painter().text(under, Align2::CENTER_BOTTOM, name, font, style::TEXT);
    button.clicked()
}

fn draw_picture(ui: &Ui, picture: Picture<'_>, place: Rect) {
    let Some((pictures, figure)) = picture else { return };
    let count = pictured_figures().count() as f32;
    let number = pictured_figures().position(|pictured| pictured == figure).unwrap_or(0) as f32;
    // Inset of half a texel, so that filtering doesn't reach the neighbouring picture.
    let inset = Vec2::splat(0.5) / pictures.size_vec2();
    let (min, max) = (Pos2::new(number / count, 0.0), Pos2::new((number + 1.0) / count, 1.0));
    let part = Rect::from_min_max(min + inset, max - inset);
    ui.painter().image(pictures.id(), place, part, Color32::WHITE);
}

fn capitalized_name(figure: Figure) -> String {
    let name = figure.name();
    name[..1].to_uppercase() + &name[1..]
}
