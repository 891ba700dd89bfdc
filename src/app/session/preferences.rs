//! Applies the settings that stay from run to run, and keeps them when they change.

use std::time::Duration;

use winit::window::Fullscreen;

use super::Session;
use crate::app::{
    input::Input,
    pace::Attention,
    quality::Preset,
    settings::{Preferences, UI_SCALES},
    texts::toasts,
};

/// The menu and the hotbar need so much room (points).
const LEAST_ROOM: [f32; 2] = [640.0, 360.0];

/// How large letters and buttons are in a window of `size` points: as the user wants, or smaller if they would not fit.
fn fitting_scale(ui_scale: f32, size: [f32; 2]) -> f32 {
    let fitting = (size[0] / LEAST_ROOM[0]).min(size[1] / LEAST_ROOM[1]);
    ui_scale.min(fitting.max(*UI_SCALES.start()))
}

/// Edge length of the rendered picture, as a share of the window's: the user's choice, or the preset's.
fn scale(preferences: &Preferences, preset: Preset) -> f32 {
    preferences.picture_scale.unwrap_or(preset.scale())
}

impl Session {
    /// Applies what has no other way into a new window. The command line may have chosen the window's size.
    pub(super) fn begin_with_preferences(&mut self, may_fill: bool) {
        if may_fill && self.preferences.full_screen {
            self.fill_screen();
        }
        self.play.sound.set_volume(self.preferences.volume);
        self.play.sound.set_muted(self.preferences.muted);
        self.begin_with_field_of_view();
    }

    /// A run begins with the field of view of the world's camera.
    pub(super) fn begin_with_field_of_view(&mut self) {
        if let Some(own_deg) = self.preferences.field_of_view_deg {
            self.give(Input::FieldOfView(Some(own_deg)));
        }
    }

    /// Changes settings, and applies what differs.
    pub(super) fn prefer(&mut self, change: impl FnOnce(&mut Preferences)) {
        let before = self.preferences.clone();
        change(&mut self.preferences);
        self.apply_since(&before);
    }

    /// Applies what differs from the settings `before`.
    pub(super) fn apply_since(&mut self, before: &Preferences) {
        let now = &self.preferences;
        let settings = &mut self.settings;
        if now.quality != before.quality {
            let is_software = self.viewport.gpu.summary.is_software();
            settings.auto = now.quality.auto;
            settings.choose_preset(now.quality.preset_on(is_software));
            settings.choice.parameters.picture.scale = scale(now, settings.preset);
        }
        if now.picture_scale != before.picture_scale {
            settings.choice.parameters.picture.scale = scale(now, settings.preset);
        }
        if now.vsync != before.vsync {
            settings.vsync = now.vsync;
        }
        let parameters = &mut settings.choice.parameters;
        if now.exposure_ev != before.exposure_ev {
            parameters.picture.exposure_ev = now.exposure_ev;
        }
        if now.textures != before.textures {
            parameters.textures.enabled = now.textures;
        }
        self.play.sound.set_volume(now.volume);
        self.play.sound.set_muted(now.muted);
        if now.full_screen != before.full_screen {
            self.fill_screen();
        }
        if self.preferences.field_of_view_deg != before.field_of_view_deg {
            self.give(Input::FieldOfView(self.preferences.field_of_view_deg));
        }
    }

    pub(super) fn toggle_full_screen(&mut self) {
        self.prefer(|preferences| preferences.full_screen = !preferences.full_screen);
    }

    fn fill_screen(&self) {
        let full = self.preferences.full_screen;
        let mode = full.then_some(Fullscreen::Borderless(None));
        self.window.set_fullscreen(mode);
    }

    /// The least time between the beginnings of two frames.
    pub(super) fn interval(&self) -> Option<Duration> {
        let attention = Attention {
            focused: self.focused,
            hidden: self.hidden,
            measured: self.counted || self.benchmarks.running.is_some(),
        };
        let drawing = self.drawn.saturating_duration_since(self.last_frame);
        attention.interval(&self.preferences, drawing)
    }

    /// Keeps the settings if they changed, but not while a slider moves: its place must not move under the mouse either.
    pub(super) fn keep_settings(&mut self) {
        let context = self.egui.egui_ctx();
        if context.input(|input| input.pointer.any_down()) {
            return;
        }
        let size = self.screen.size();
        if !size.contains(&0) {
            let pixels = context.native_pixels_per_point().unwrap_or(1.0);
            let points = size.map(|edge| edge as f32 / pixels);
            context.set_zoom_factor(fitting_scale(self.preferences.ui_scale, points));
        }
        if let Err(error) = self.store.keep(&self.preferences) {
            let told = toasts::unkept_settings(&error.to_string());
            tracing::warn!("{told}");
            self.messages.toast_error(told);
        }
    }

    /// Keeps the settings, and the size of the window if it was not chosen on the command line.
    pub fn keep_settings_at_end(&mut self) {
        let size = self.screen.size();
        let is_free = self.window.fullscreen().is_none() && !self.window.is_maximized();
        if self.keeps_size && is_free && !size.contains(&0) {
            self.preferences.window_size = size;
        }
        self.keep_settings();
    }
}

#[cfg(test)]
mod tests {
    use super::fitting_scale;

    #[test]
    fn letters_are_as_large_as_wanted_where_they_fit() {
        for (wanted, size, scale) in [
            (1.0, [1280.0, 720.0], 1.0),
            (2.0, [1280.0, 720.0], 2.0),
            (3.0, [1280.0, 720.0], 2.0),
            (0.5, [640.0, 360.0], 0.5),
            (1.0, [480.0, 720.0], 0.75),
            (1.0, [640.0, 216.0], 0.6),
            // As small as a user may choose.
            (1.0, [100.0, 50.0], 0.5),
        ] {
            assert_eq!(fitting_scale(wanted, size), scale, "{wanted} in {size:?}");
        }
    }
}
