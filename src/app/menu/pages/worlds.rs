//! The page of worlds: a card for each.

use egui::{Align, CornerRadius, Grid, Layout, RichText, ScrollArea, Sense, Ui, Vec2};

use super::{
    super::{Action, Entry, Menu},
    GAP,
};
use crate::app::texts::worlds as texts;

/// A card of a world: its picture, and its text below.
const CARD: Vec2 = Vec2::new(216.0, 214.0);
const PICTURE: Vec2 = Vec2::new(216.0, 121.5);
/// Lines of a world's title on its card.
const LINES: usize = 3;

impl Menu {
    pub(super) fn worlds(&mut self, ui: &mut Ui, action: &mut Option<Action>) {
        ui.heading(texts::HEADING);
        ui.add_space(GAP);
        let columns = ((ui.available_width() + GAP) / (CARD.x + GAP))
            .floor()
            .max(1.0) as usize;
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            Grid::new("worlds")
                .spacing(Vec2::splat(GAP))
                .show(ui, |ui| {
                    for (index, entry) in self.entries.iter().enumerate() {
                        let texture = self.pictures.texture(ui.ctx(), &entry.name);
                        if card(ui, entry, texture) {
                            *action = Some(Action::EnterWorld(entry.clone()));
                        }
                        if (index + 1) % columns == 0 {
                            ui.end_row();
                        }
                    }
                });
        });
    }
}

/// A world with its picture; returns whether it was clicked.
fn card(ui: &mut Ui, entry: &Entry, texture: Option<&egui::TextureHandle>) -> bool {
    let (area, response) = ui.allocate_exact_size(CARD, Sense::click());
    let fill = if response.hovered() {
        ui.visuals().widgets.hovered.bg_fill
    } else {
        ui.visuals().widgets.inactive.bg_fill
    };
    ui.painter().rect_filled(area, CornerRadius::same(6), fill);
    let picture = egui::Rect::from_min_size(area.min, PICTURE);
    match texture {
        Some(texture) => {
            egui::Image::new((texture.id(), PICTURE)).paint_at(ui, picture);
        }
        None => {
            ui.painter().text(
                picture.center(),
                egui::Align2::CENTER_CENTER,
                texts::NO_PICTURE,
                egui::FontId::proportional(24.0),
                ui.visuals().weak_text_color(),
            );
        }
    }
    let below = egui::Rect::from_min_max(picture.left_bottom(), area.max).shrink(8.0);
    let mut text = ui.new_child(
        egui::UiBuilder::new()
            .max_rect(below)
            .layout(Layout::top_down(Align::LEFT)),
    );
    text.add(
        egui::Label::new(RichText::new(&entry.name).strong().size(15.0))
            .truncate()
            .selectable(false),
    );
    let job = egui::text::LayoutJob {
        wrap: egui::text::TextWrapping {
            max_width: below.width(),
            max_rows: LINES,
            ..Default::default()
        },
        ..egui::text::LayoutJob::simple(
            entry.title.clone(),
            egui::FontId::proportional(12.0),
            ui.visuals().text_color(),
            below.width(),
        )
    };
    text.add(egui::Label::new(job).selectable(false));
    response
        .on_hover_cursor(egui::CursorIcon::PointingHand)
        .clicked()
}
