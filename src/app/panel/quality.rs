//! The choice of a quality, and what the control of the frame time makes of it.

use egui::{DragValue, Slider, Ui};

use super::{Facts, Settings, grid};
use crate::{
    app::{
        quality::{Auto, Preset},
        widgets,
    },
    parameters::SCALES,
};

pub fn quality(ui: &mut Ui, facts: &Facts<'_>, settings: &mut Settings) {
    grid(ui, "quality", |ui| {
        ui.label("preset").on_hover_text(
            "Rays, faces and resolution at once. Parameters that are set afterwards are kept.",
        );
        ui.horizontal(|ui| {
            let before = settings.preset;
            let mut chosen = before.name();
            let names = Preset::ALL.map(Preset::name);
            if widgets::choose(ui, "preset", &mut chosen, &names)
                && let Some(preset) = Preset::ALL.iter().find(|known| known.name() == chosen)
            {
                settings.choose_preset(*preset);
            }
            if !before.is(&settings.choice.parameters) {
                ui.weak("changed").on_hover_text(
                    "Some of what the preset sets has another value. Choose the preset again to undo that.",
                );
            }
        });
        ui.end_row();

        ui.label("resolution").on_hover_text(
            "Edge length of the rendered picture, as a share of the window's: picture.scale. Time grows with its square.",
        );
        ui.add(
            Slider::new(&mut settings.choice.parameters.picture.scale, SCALES)
                .custom_formatter(|scale, _| format!("{:.0} %", 100.0 * scale))
                .custom_parser(|text| {
                    let percent: f64 = text.trim_end_matches('%').trim().parse().ok()?;
                    Some(percent / 100.0)
                }),
        );
        ui.end_row();

        ui.label("auto").on_hover_text(
            "Holds a frame time: does less than the preset asks for where frames take longer",
        );
        ui.horizontal(|ui| {
            ui.checkbox(&mut settings.auto, "");
            ui.add_enabled(
                settings.auto,
                DragValue::new(&mut settings.target_ms)
                    .range(Auto::TARGETS_MS)
                    .speed(0.5)
                    .suffix(" ms"),
            );
        });
        ui.end_row();

        ui.label("now");
        ui.weak(facts.effort_in_words());
        ui.end_row();
    });
}
