//! The panel and the messages over the picture.

use winit::event_loop::ActiveEventLoop;

use super::Session;
use crate::{
    app::{
        hands::{aim, outline},
        input::Input,
        menu::Shown,
        panel::{self, Action, Facts},
        readout,
    },
    passes::view::overlay::PanelShapes,
};

impl Session {
    /// Runs the panel, the summary of a benchmark and the messages, and carries out what was clicked.
    pub(super) fn run_panel(&mut self, event_loop: &ActiveEventLoop) -> PanelShapes {
        let input = self.egui.take_egui_input(&self.window);
        let context = self.egui.egui_ctx().clone();
        let has_cross = self.menu.is_none()
            && !self.items.is_open()
            && self.benchmarks.running.is_none()
            && (self.captured || self.readout_open);
        let aimed = if has_cross { self.aim() } else { None };
        let in_hands = self.in_hands(aimed.as_ref().and_then(|(target, _)| target.as_ref()));
        let facts = Facts {
            viewport: &self.viewport,
            rate: &self.rate,
            passes: &self.passes,
            camera: &self.camera,
            fly_speed: self.play.player.fly_speed(),
            probes: self.probes,
            hotbar: &self.play.hands.hotbar,
            silence: self.play.sound.silence(),
        };
        let before = self.menu.is_some().then(|| self.preferences.clone());
        let mut action = None;
        let mut chosen = None;
        let mut items = Vec::new();
        let output = context.run_ui(input, |ui| {
            if let Some(menu) = &mut self.menu {
                let mut shown = Shown {
                    preferences: &mut self.preferences,
                    scale: self.settings.choice.parameters.picture.scale,
                    played: self.saving.written(),
                };
                chosen = menu.show(ui, &mut shown).or(chosen.take());
            } else if let Some(summary) = &self.benchmarks.summary {
                summary.show(ui);
            } else if self.panel_open && self.benchmarks.running.is_none() {
                action = panel::show(ui, &facts, &mut self.settings, &mut self.search).or(action);
            }
            if self.menu.is_none() && self.benchmarks.running.is_none() {
                items = self.items.show(
                    ui,
                    facts.viewport.world(),
                    facts.hotbar,
                    &self.preferences.keys,
                );
            }
            if has_cross {
                if let Some((_, edges)) = &aimed {
                    outline::draw(ui, edges);
                }
                aim::crosshair(ui, aimed.is_some());
                if let Some(text) = &in_hands {
                    aim::caption(ui, text);
                }
            }
            if self.readout_open && self.menu.is_none() {
                let target = aimed.as_ref().and_then(|(target, _)| target.as_ref());
                readout::show(ui, &facts, &self.settings.clock, target);
            }
            self.messages.show(ui, &self.preferences.keys);
        });
        if let Some(before) = before {
            self.apply_since(&before);
        }
        for input in items {
            self.give(input);
        }
        match action {
            Some(Action::JumpTo(index)) => self.give(Input::Camera(index)),
            Some(Action::Hold(item)) => {
                let slot = self.play.hands.hotbar.selected();
                self.give(Input::Item { slot, item });
            }
            Some(Action::Screenshot) => self.screenshot_wanted = true,
            Some(Action::Reload) => self.reload(true, true),
            None => {}
        }
        if let Some(chosen) = chosen {
            self.carry_out(event_loop, chosen);
        }
        if !self.captured {
            self.egui.handle_platform_output_with_event_loop(
                &self.window,
                event_loop,
                output.platform_output,
            );
        }
        PanelShapes {
            primitives: context.tessellate(output.shapes, output.pixels_per_point),
            textures: output.textures_delta,
            pixels_per_point: output.pixels_per_point,
        }
    }
}
