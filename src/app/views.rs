//! Rows of the panel for the view, the probes drawn in it, and the atlas.

use clap::ValueEnum;
use egui::{ComboBox, DragValue, Ui};

use super::viewport::Viewport;
use crate::{
    passes::view::{AtlasLayer, AtlasMap, Inspection, ProbeColour},
    world::View,
};

/// Rows of a grid of two columns.
pub fn rows(ui: &mut Ui, viewport: &Viewport, inspection: &mut Inspection) {
    ui.label("view").on_hover_text("What the picture shows");
    combo(ui, "view", name(&inspection.view), |ui| {
        let keeps_occlusion = viewport.frame().field().occlusion().layout().is_kept();
        for view in View::value_variants() {
            let is_kept = *view != View::Occlusion || keeps_occlusion;
            ui.add_enabled_ui(is_kept, |ui| {
                variant(ui, &mut inspection.view, view, *view);
            })
            .response
            .on_disabled_hover_text("Needs occlusion.lamps or occlusion.ambient");
        }
    });
    ui.end_row();
    if viewport.choice().traced {
        ui.label("probes");
        ui.weak("the reference has none");
        ui.end_row();
        return;
    }

    ui.label("probes")
        .on_hover_text("Spheres at the probes, and what colours them (F7)");
    let shown = inspection.probes.as_ref().map_or_else(none, name);
    combo(ui, "probes drawn", shown, |ui| {
        ui.selectable_value(&mut inspection.probes, None, none());
        for colour in ProbeColour::value_variants() {
            variant(ui, &mut inspection.probes, colour, Some(*colour));
        }
    });
    ui.end_row();

    ui.label("atlas")
        .on_hover_text("A layer of the textures that hold the maps of the probes");
    ui.horizontal(|ui| atlas(ui, viewport, &mut inspection.atlas));
    ui.end_row();
}

fn atlas(ui: &mut Ui, viewport: &Viewport, atlas: &mut Option<AtlasLayer>) {
    let field = viewport.frame().field();
    let shown = atlas.map_or_else(none, |atlas| atlas.map.name().to_owned());
    combo(ui, "atlas", shown, |ui| {
        ui.selectable_value(atlas, None, none());
        for map in AtlasMap::ALL {
            let layer = atlas.map_or(0, |atlas| atlas.layer);
            let kept = map != AtlasMap::Distance || field.keeps_distances();
            ui.add_enabled_ui(kept, |ui| {
                ui.selectable_value(atlas, Some(AtlasLayer { map, layer }), map.name());
            });
        }
    });
    let layers = field.atlas().layers;
    if let Some(atlas) = atlas {
        ui.add(DragValue::new(&mut atlas.layer).range(0..=layers - 1))
            .on_hover_text(format!("Layer, of {layers}"));
    }
}

fn none() -> String {
    "none".to_owned()
}

fn combo(ui: &mut Ui, id: &str, shown: String, add: impl FnOnce(&mut Ui)) {
    ComboBox::from_id_salt(id)
        .selected_text(shown)
        .width(ui.spacing().slider_width)
        .show_ui(ui, add);
}

/// An entry of a list of values for `chosen`: the name of `variant`, with its help on hover.
fn variant<T: PartialEq>(ui: &mut Ui, chosen: &mut T, variant: &impl ValueEnum, value: T) {
    let response = ui.selectable_value(chosen, value, name(variant));
    let known = variant.to_possible_value();
    if let Some(help) = known.as_ref().and_then(|known| known.get_help()) {
        response.on_hover_text(help.to_string());
    }
}

/// As the command line spells it, with spaces between words.
pub fn name(variant: &impl ValueEnum) -> String {
    let value = variant.to_possible_value().expect("no variant is hidden");
    value.get_name().replace('-', " ")
}
