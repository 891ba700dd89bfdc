//! The panel: figures of the running world, and a widget for everything that can be chosen.

mod figures;
mod parameters;
mod quality;
mod scene;

use egui::{Grid, RichText, ScrollArea, Ui};

pub use figures::{PassMeans, told};

use super::{
    clock::{FrameRate, WorldClock},
    hands::{Hotbar, Item, brush::Brush},
    inventory,
    quality::{Auto, Effort, Preset},
    viewport::{Choice, Viewport},
};
use crate::{
    passes::{probes::StateCounts, view::Inspection},
    world::Camera,
};

/// What is chosen in the panel.
#[derive(Clone)]
pub struct Settings {
    /// What takes work to change.
    pub choice: Choice,
    pub inspection: Inspection,
    /// The preset that was chosen last.
    pub preset: Preset,
    /// Whether a frame time is held, by less work than the preset asks for.
    pub auto: bool,
    /// That frame time (milliseconds).
    pub target_ms: f64,
    pub vsync: bool,
    pub clock: WorldClock,
    pub brush: Brush,
}

impl Settings {
    /// The settings of a run that nobody watches at a speed of its own: all of the choice, at full effort.
    pub fn of_replay(choice: Choice, inspection: Inspection) -> Self {
        Self {
            choice,
            inspection,
            preset: Preset::High,
            auto: false,
            target_ms: Auto::default_target_ms(false),
            vsync: false,
            clock: WorldClock::default(),
            brush: Brush::default(),
        }
    }

    /// Sets the parameters of a preset; all others stay.
    pub fn choose_preset(&mut self, preset: Preset) {
        self.preset = preset;
        preset.apply(&mut self.choice.parameters);
    }
}

/// What the panel displays.
pub struct Facts<'a> {
    pub viewport: &'a Viewport,
    pub rate: &'a FrameRate,
    pub passes: &'a PassMeans,
    pub camera: &'a Camera,
    /// Voxels per second.
    pub fly_speed: f64,
    /// Probes by state, once they have been counted.
    pub probes: Option<StateCounts>,
    pub hotbar: &'a Hotbar,
    /// Why nothing is heard, if so.
    pub silence: Option<String>,
}

impl Facts<'_> {
    /// Rays of a probe's update in the last frame.
    fn rays_per_update(&self) -> u32 {
        let chosen = &self.viewport.choice().parameters.probes;
        self.viewport.effort().probes(chosen).rays_per_update()
    }

    /// Size of the picture, and of what was rendered for it.
    pub fn picture_in_words(&self) -> String {
        let frame = self.viewport.frame();
        let words = |[width, height]: [u32; 2]| format!("{width} × {height}");
        let shown = words(frame.size());
        match frame.rendered_size() {
            rendered if rendered == frame.size() => shown,
            rendered => format!("{shown} from {}", words(rendered)),
        }
    }

    /// How much of what was chosen is done.
    pub fn effort_in_words(&self) -> String {
        match self.viewport.effort() {
            Effort::FULL => "all that is chosen".to_owned(),
            Effort { scale, rays } => format!(
                "{:.0} % of the resolution, {:.0} % of the rays",
                100.0 * scale,
                100.0 * rays
            ),
        }
    }
}

/// What a user clicked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    /// Move to the world's camera of this index.
    JumpTo(usize),
    /// Take this into the hand.
    Hold(Item),
    Screenshot,
    Reload,
}

const WIDTH: f32 = 340.0;

/// Draws the panel at the left edge of the window. `search`: what the user searches among the parameters.
pub fn show(
    ui: &mut Ui,
    facts: &Facts<'_>,
    settings: &mut Settings,
    search: &mut String,
) -> Option<Action> {
    let fill = ui.style().visuals.panel_fill.gamma_multiply(0.93);
    let frame = egui::Frame::side_top_panel(ui.style()).fill(fill);
    let panel = egui::Panel::left("panel")
        .frame(frame)
        .default_size(WIDTH)
        .resizable(true);
    let shown = panel.show(ui, |ui| {
        parameters::search_field(ui, search);
        ScrollArea::vertical()
            .auto_shrink(false)
            .show(ui, |ui| contents(ui, facts, settings, search))
            .inner
    });
    shown.inner
}

fn contents(
    ui: &mut Ui,
    facts: &Facts<'_>,
    settings: &mut Settings,
    search: &str,
) -> Option<Action> {
    let mut action = None;
    ui.spacing_mut().slider_width = 110.0;
    let world = facts.viewport.world();
    // Who searches for a parameter wants to see nothing else.
    if search.trim().is_empty() {
        figures::figures(ui, facts);
        ui.separator();
        scene::scene(ui, facts, settings, &mut action);
        section(ui, "Quality", true, |ui| {
            quality::quality(ui, facts, settings);
        });
        section(ui, "Time", true, |ui| scene::time(ui, &mut settings.clock));
        section(ui, "Dig and build", true, |ui| {
            grid(ui, "brush", |ui| {
                let item = inventory::row(ui, world, facts.hotbar);
                action = action.or(item.map(Action::Hold));
                settings.brush.rows(ui);
            });
        });
        section(ui, "GPU time of each pass", true, |ui| {
            figures::passes(ui, facts);
        });
        ui.separator();
    }
    parameters::show(ui, search, world, &mut settings.choice.parameters);
    ui.separator();
    ui.horizontal_wrapped(|ui| {
        parameters::copy_button(ui, &settings.choice.parameters);
        if ui.button("Screenshot").clicked() {
            action = Some(Action::Screenshot);
        }
        if ui.button("Read world again").clicked() {
            action = Some(Action::Reload);
        }
    });
    action
}

fn section(ui: &mut Ui, title: &str, open: bool, add: impl FnOnce(&mut Ui)) {
    egui::CollapsingHeader::new(RichText::new(title).strong())
        .default_open(open)
        .show(ui, add);
}

fn grid(ui: &mut Ui, id: &str, add: impl FnOnce(&mut Ui)) {
    Grid::new(id)
        .num_columns(2)
        .spacing([10.0, 4.0])
        .show(ui, add);
}

/// About three significant digits.
pub fn digits(number: f64) -> String {
    let decimals = match number {
        number if number >= 100.0 => 0,
        number if number >= 10.0 => 1,
        _ => 2,
    };
    format!("{number:.decimals$}")
}
