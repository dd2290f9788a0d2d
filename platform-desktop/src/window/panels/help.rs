//! Help panel: mouse and keys.

use egui::{Align2, Area, Context, Grid, Id, Order, RichText, Vec2};

use super::style;
use crate::window::keys::HELP;

pub(super) fn show(context: &Context) {
    let area = Area::new(Id::new("help"))
        .order(Order::Foreground)
        .anchor(Align2::RIGHT_CENTER, Vec2::new(-24.0, -20.0));
    area.show(context, |ui| {
        style::card_frame().inner_margin(20).show(ui, |ui| {
            ui.label(RichText::new("Mouse and keys").size(19.0));
            ui.add_space(6.0);
            Grid::new("keys").num_columns(2).spacing(Vec2::new(18.0, 7.0)).show(ui, |ui| {
                for (keys, what) in HELP {
                    ui.label(RichText::new(keys).color(style::ACCENT).size(14.0));
                    ui.label(RichText::new(what).size(14.0));
                    ui.end_row();
                }
            });
        });
    });
}
