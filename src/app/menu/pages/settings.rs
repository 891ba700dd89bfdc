//! The page of settings.

use std::ops::RangeInclusive;

use egui::{ComboBox, Grid, RichText, ScrollArea, Slider, Ui, emath::Numeric};

use super::{GAP, Shown};
use crate::{
    app::{
        quality::{Preset, Quality},
        settings::{
            EXPOSURES_EV, FIELDS_OF_VIEW_DEG, FRAME_LIMITS, Preferences, SENSITIVITIES, UI_SCALES,
            UNFOCUSED_LIMITS, VOLUMES,
        },
        texts::settings as texts,
    },
    parameters::SCALES,
};

/// What a value begins with that was left to the world or to the machine.
const FIRST_FIELD_OF_VIEW_DEG: f32 = 75.0;
const FIRST_LIMIT: u32 = 60;

pub fn show(ui: &mut Ui, shown: &mut Shown<'_>) {
    ui.heading(texts::HEADING);
    ui.spacing_mut().slider_width = 130.0;
    let scale = shown.scale;
    let preferences = &mut *shown.preferences;
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        Grid::new("settings")
            .num_columns(2)
            .spacing([16.0, 4.0])
            .show(ui, |ui| {
                picture(ui, preferences, scale);
                controls(ui, preferences);
                window(ui, preferences);
                sound(ui, preferences);
            });
        ui.add_space(0.5 * GAP);
        ui.horizontal_wrapped(|ui| {
            if ui.button(texts::RESET).clicked() {
                *preferences = Preferences {
                    keys: preferences.keys.clone(),
                    window_size: preferences.window_size,
                    ..Preferences::default()
                };
            }
            ui.weak(preferences.keys.fill(texts::PANEL));
        });
    });
}

fn picture(ui: &mut Ui, preferences: &mut Preferences, scale: f32) {
    heading(ui, texts::PICTURE);
    slider(
        ui,
        texts::BRIGHTNESS,
        &mut preferences.exposure_ev,
        EXPOSURES_EV,
        1,
    );
    ui.label(texts::QUALITY);
    ui.horizontal(|ui| quality(ui, &mut preferences.quality));
    ui.end_row();
    ui.label(texts::SCALE);
    ui.horizontal(|ui| {
        let given = &mut preferences.picture_scale;
        optional(ui, given, texts::AUTOMATIC, scale, SCALES, 2);
    });
    ui.end_row();
    ui.label(texts::FIELD_OF_VIEW);
    ui.horizontal(|ui| {
        let given = &mut preferences.field_of_view_deg;
        let first = FIRST_FIELD_OF_VIEW_DEG;
        optional(ui, given, texts::WORLDS_OWN, first, FIELDS_OF_VIEW_DEG, 0);
    });
    ui.end_row();
    check(ui, texts::TEXTURES, &mut preferences.textures);
    check(ui, texts::VSYNC, &mut preferences.vsync);
    ui.label(texts::FRAME_LIMIT);
    ui.horizontal(|ui| {
        let given = &mut preferences.frame_limit;
        optional(ui, given, texts::NO_LIMIT, FIRST_LIMIT, FRAME_LIMITS, 0);
    });
    ui.end_row();
    ui.label(texts::UNFOCUSED_LIMIT);
    ui.add(Slider::new(&mut preferences.unfocused_limit, UNFOCUSED_LIMITS).logarithmic(true));
    ui.end_row();
}

/// A preset, or what suits the machine; and whether to do less than it where frames take too long.
fn quality(ui: &mut Ui, quality: &mut Quality) {
    let name = |preset: Option<Preset>| preset.map_or(texts::AUTOMATIC, Preset::name);
    ComboBox::from_id_salt("quality")
        .selected_text(name(quality.preset))
        .show_ui(ui, |ui| {
            for preset in [None].into_iter().chain(Preset::ALL.map(Some)) {
                ui.selectable_value(&mut quality.preset, preset, name(preset));
            }
        });
    if quality.preset.is_none() {
        quality.auto = true;
    }
    ui.add_enabled_ui(quality.preset.is_some(), |ui| {
        ui.checkbox(&mut quality.auto, texts::HOLDS_FRAME_TIME);
    });
}

fn controls(ui: &mut Ui, preferences: &mut Preferences) {
    heading(ui, texts::CONTROLS);
    ui.label(texts::SENSITIVITY);
    let sensitivity = &mut preferences.mouse_sensitivity;
    ui.add(
        Slider::new(sensitivity, SENSITIVITIES)
            .logarithmic(true)
            .fixed_decimals(2),
    );
    ui.end_row();
    check(ui, texts::INVERT, &mut preferences.invert_y);
}

fn window(ui: &mut Ui, preferences: &mut Preferences) {
    heading(ui, texts::WINDOW);
    check(ui, texts::FULL_SCREEN, &mut preferences.full_screen);
    slider(ui, texts::UI_SCALE, &mut preferences.ui_scale, UI_SCALES, 2);
}

fn sound(ui: &mut Ui, preferences: &mut Preferences) {
    heading(ui, texts::SOUND);
    slider(ui, texts::VOLUME, &mut preferences.volume, VOLUMES, 2);
    check(ui, texts::MUTED, &mut preferences.muted);
}

fn heading(ui: &mut Ui, text: &str) {
    ui.label(RichText::new(text).strong().size(15.0));
    ui.end_row();
}

fn check(ui: &mut Ui, label: &str, value: &mut bool) {
    let named = ui.label(label).id;
    ui.checkbox(value, "").labelled_by(named);
    ui.end_row();
}

fn slider(ui: &mut Ui, label: &str, value: &mut f32, range: RangeInclusive<f32>, decimals: usize) {
    let named = ui.label(label).id;
    ui.add(Slider::new(value, range).fixed_decimals(decimals))
        .labelled_by(named);
    ui.end_row();
}

/// A value that can be left alone: a box says by whom it is chosen then, and a slider, which begins with `first`,
/// chooses it.
fn optional<T: Numeric>(
    ui: &mut Ui,
    value: &mut Option<T>,
    otherwise: &str,
    first: T,
    range: RangeInclusive<T>,
    decimals: usize,
) {
    let mut is_left = value.is_none();
    if ui.checkbox(&mut is_left, otherwise).changed() {
        *value = (!is_left).then_some(first);
    }
    if let Some(value) = value {
        ui.add(Slider::new(value, range).fixed_decimals(decimals));
    }
}
