//! What is shown of the world, and when.

use egui::{RichText, Slider, Ui};

use super::{Action, Facts, Settings, grid};
use crate::app::{clock::WorldClock, views, widgets};

/// Which part of the world is shown, and how.
pub fn scene(ui: &mut Ui, facts: &Facts<'_>, settings: &mut Settings, action: &mut Option<Action>) {
    let world = facts.viewport.world();
    ui.label(RichText::new(&world.name).strong())
        .on_hover_text(&world.title);
    grid(ui, "scene", |ui| {
        ui.label("jump to").on_hover_text("A camera of the world");
        let cameras: Vec<&str> = world.cameras.iter().map(|camera| &*camera.name).collect();
        let mut chosen = "…";
        if widgets::choose(ui, "camera", &mut chosen, &cameras) {
            *action = cameras
                .iter()
                .position(|camera| *camera == chosen)
                .map(Action::JumpTo);
        }
        ui.end_row();

        ui.label("layout").on_hover_text("Positions of the probes");
        let layouts: Vec<&str> = world.layouts.iter().map(|layout| &*layout.name).collect();
        let mut chosen = &*settings.choice.layout;
        let before = chosen;
        widgets::choose(ui, "layout", &mut chosen, &layouts);
        if chosen != before {
            settings.choice.layout = chosen.to_owned();
        }
        ui.end_row();

        views::rows(ui, facts.viewport, &mut settings.inspection);

        ui.label("vsync")
            .on_hover_text("Whether frames wait for the display; off shows what the GPU can do");
        ui.checkbox(&mut settings.vsync, "");
        ui.end_row();
    });
}

pub fn time(ui: &mut Ui, clock: &mut WorldClock) {
    grid(ui, "time", |ui| {
        ui.label("world time");
        ui.horizontal(|ui| {
            let label = if clock.paused { "resume" } else { "pause" };
            if ui.button(label).clicked() {
                clock.paused = !clock.paused;
            }
            ui.monospace(format!("{:.1} s", clock.time_s));
        });
        ui.end_row();
        ui.label("rate")
            .on_hover_text("Seconds of world time per second of real time");
        ui.horizontal(|ui| {
            ui.add(
                Slider::new(&mut clock.rate, 0.0..=10.0)
                    .logarithmic(true)
                    .smallest_positive(0.1),
            );
            if clock.rate != 1.0 && ui.small_button(RichText::new("↺").monospace()).clicked() {
                clock.rate = 1.0;
            }
        });
        ui.end_row();
    });
}
