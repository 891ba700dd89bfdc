//! How to play: the keys, on one screen.

use egui::{Grid, Label, RichText, Ui};

use super::GAP;
use crate::app::{
    controls::{self, Bindings},
    texts::how_to_play as texts,
};

/// Width of the keys beside what they do, as a share of the column.
const KEYS: f32 = 0.36;
const BETWEEN: f32 = 10.0;

pub fn show(ui: &mut Ui, bindings: &Bindings) {
    ui.heading(texts::HEADING);
    ui.label(texts::ABOUT);
    ui.add_space(0.5 * GAP);
    let rows = controls::help(bindings);
    let (left, right) = rows.split_at(rows.len().div_ceil(2));
    ui.columns(2, |columns| {
        for (ui, rows) in columns.iter_mut().zip([left, right]) {
            column(ui, rows);
        }
    });
}

fn column(ui: &mut Ui, rows: &[(String, &str)]) {
    let width = ui.available_width() - BETWEEN;
    Grid::new("keys")
        .num_columns(2)
        .spacing([BETWEEN, 3.0])
        .show(ui, |ui| {
            for (keys, does) in rows {
                for (text, share) in [
                    (RichText::new(keys).strong().small(), KEYS),
                    (RichText::new(*does).small(), 1.0 - KEYS),
                ] {
                    ui.scope(|ui| {
                        ui.set_width(share * width);
                        ui.add(Label::new(text).wrap().selectable(false));
                    });
                }
                ui.end_row();
            }
        });
}
