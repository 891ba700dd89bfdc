//! The page of a new cave: its sliders, over the cave that they make.

use egui::{Frame, Grid, Slider, TextEdit, Ui};

use super::{
    super::{Action, Menu},
    DIM, GAP, large,
};
use crate::{
    app::texts::new_cave as texts,
    world::new_cave::{MOST_LAMPS, NewCave},
};

impl Menu {
    pub(super) fn new_cave(&mut self, ui: &mut Ui, action: &mut Option<Action>) {
        let frame = Frame::window(ui.style()).fill(DIM);
        frame.show(ui, |ui| {
            ui.set_width(330.0);
            ui.heading(texts::HEADING);
            ui.add_space(GAP);
            let before = self.cave.clone();
            ui.spacing_mut().slider_width = 150.0;
            Grid::new("new_cave")
                .num_columns(2)
                .spacing([12.0, 8.0])
                .show(ui, |ui| {
                    ui.label(texts::NAME);
                    ui.add(
                        TextEdit::singleline(&mut self.name)
                            .hint_text(texts::NAME_HINT)
                            .desired_width(190.0),
                    );
                    ui.end_row();
                    ui.label(texts::SEED);
                    ui.horizontal(|ui| {
                        ui.add(egui::DragValue::new(&mut self.cave.seed));
                        if ui.button(texts::ANOTHER).clicked() {
                            // Any other seed is as good; a multiplier of full period never comes back soon.
                            self.cave.seed = self
                                .cave
                                .seed
                                .wrapping_mul(1_664_525)
                                .wrapping_add(1_013_904_223);
                        }
                    });
                    ui.end_row();
                    let NewCave {
                        rooms,
                        roughness,
                        mushrooms,
                        lamps,
                        lava,
                        ..
                    } = &mut self.cave;
                    for (label, share) in [
                        (texts::ROOMS, rooms),
                        (texts::ROUGHNESS, roughness),
                        (texts::MUSHROOMS, mushrooms),
                        (texts::LAVA, lava),
                    ] {
                        ui.label(label);
                        ui.add(Slider::new(share, 0.0..=1.0).show_value(false));
                        ui.end_row();
                    }
                    ui.label(texts::LAMPS);
                    ui.add(Slider::new(lamps, 0..=MOST_LAMPS));
                    ui.end_row();
                });
            self.is_stale |= self.cave != before;
            ui.add_space(GAP);
            if large(ui, texts::ENTER, true).clicked() {
                *action = Some(Action::Create(self.cave.clone(), self.name.clone()));
            }
        });
    }
}
