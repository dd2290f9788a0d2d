//! Help panel: mouse and keys, the visitors' table first.

use egui::{Align2, Area, Context, Grid, Id, Order, RichText, Ui, Vec2};
use paros_shaders::panel::Message;

use super::{StudioStatus, style};
use crate::window::keys::{DEVELOPER_HELP, HELP, HelpKeys};

/// Width of the keys' column in both tables, in points.
const KEYS_WIDTH: f32 = 140.0;

/// Width of the panel's content, in points.
const WIDTH: f32 = 460.0;

/// Shows the visitors' keys in their language, and the developers' keys where they are allowed.
pub(super) fn show(context: &Context, status: &StudioStatus<'_>) {
    let language = status.language;
    let in_visit = status.visit.is_some();
    let area = Area::new(Id::new("help"))
        .order(Order::Foreground)
        .anchor(Align2::RIGHT_CENTER, Vec2::new(-style::MARGIN, 0.0));
    area.show(context, |ui| {
        style::show_within_window(ui, style::card_frame().inner_margin(20), WIDTH, |ui| {
            ui.label(RichText::new(Message::HelpTitle.text(language)).size(19.0));
            ui.add_space(4.0);
            let rows = HELP.map(|(keys, what)| {
                let keys = match keys {
                    HelpKeys::Named(name) => name,
                    HelpKeys::Told(message) => message.text(language),
                };
                // In a visit, Esc can't show a start panel.
                let is_start = in_visit && what == Message::HelpBack;
                let what = if is_start { Message::HelpClose } else { what };
                (keys, what.text(language))
            });
            show_keys(ui, "keys", &rows);
            if !status.kiosk && !in_visit {
                ui.add_space(4.0);
                ui.label(style::quiet_text("For developers"));
                show_keys(ui, "developers' keys", &DEVELOPER_HELP);
            }
        });
    });
}

fn show_keys(ui: &mut Ui, id: &str, table: &[(&str, &str)]) {
    let grid = Grid::new(id).num_columns(2).spacing(Vec2::new(18.0, 8.0)).min_row_height(20.0);
    grid.min_col_width(KEYS_WIDTH).show(ui, |ui| {
        for (keys, what) in table {
            ui.label(RichText::new(*keys).color(style::ACCENT).size(14.0));
            ui.label(RichText::new(*what).size(14.0));
            ui.end_row();
        }
    });
}
