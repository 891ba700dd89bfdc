//! The panel: figures of the running world, and a widget for everything that can be chosen.

use std::collections::BTreeMap;

use egui::{Align, Color32, Grid, Layout, RichText, ScrollArea, Slider, Ui};

use super::{
    clock::{FrameRate, WorldClock},
    controls,
    hands::brush::Brush,
    time_graph,
    viewport::{Choice, Viewport},
    views, widgets,
};
use crate::{
    gpu::PassTimes,
    parameters::{KEYS, Kind},
    passes::{probes::StateCounts, view::Inspection},
    world::Camera,
};

/// What is chosen in the panel.
#[derive(Clone)]
pub struct Settings {
    /// What takes work to change.
    pub choice: Choice,
    pub inspection: Inspection,
    /// Edge length of the picture relative to the window's.
    pub scale: f32,
    pub vsync: bool,
    pub clock: WorldClock,
    pub brush: Brush,
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
}

/// What a user clicked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Move to the world's camera of this index.
    JumpTo(usize),
    Screenshot,
    Reload,
}

/// Mean milliseconds of each pass, smoothed so that they can be read.
#[derive(Default)]
pub struct PassMeans {
    mean_ms: BTreeMap<String, f64>,
}

impl PassMeans {
    /// Weight of the previous mean when a frame is added.
    const KEPT: f64 = 0.9;

    pub fn push(&mut self, times: &PassTimes) {
        self.mean_ms
            .retain(|label, _| times.passes_ms.contains_key(label));
        for (label, ms) in &times.passes_ms {
            let mean = self.mean_ms.entry(label.clone()).or_insert(*ms);
            *mean = Self::KEPT * *mean + (1.0 - Self::KEPT) * ms;
        }
    }
}

/// Edge lengths of the picture, relative to the window's, that the panel offers.
pub const SCALES: std::ops::RangeInclusive<f32> = 0.1..=1.0;

const WIDTH: f32 = 320.0;
const WARNING: Color32 = Color32::from_rgb(255, 190, 80);

/// The counts of the states add up to the total.
fn told(counts: &StateCounts) -> String {
    let back_side = match counts.back_side {
        0 => String::new(),
        back_side => format!(" with {back_side} on back sides"),
    };
    format!(
        "{}{back_side}: {} alive, {} asleep, {} dead; {} updated",
        counts.total(),
        counts.alive,
        counts.sleeping,
        counts.dead,
        counts.updated
    )
}

/// Draws the panel at the left edge of the window.
pub fn show(ui: &mut Ui, facts: &Facts<'_>, settings: &mut Settings) -> Option<Action> {
    let fill = ui.style().visuals.panel_fill.gamma_multiply(0.93);
    let frame = egui::Frame::side_top_panel(ui.style()).fill(fill);
    let panel = egui::Panel::left("panel")
        .frame(frame)
        .default_size(WIDTH)
        .resizable(true);
    let shown = panel.show(ui, |ui| {
        ScrollArea::vertical()
            .auto_shrink(false)
            .show(ui, |ui| contents(ui, facts, settings))
            .inner
    });
    shown.inner
}

fn contents(ui: &mut Ui, facts: &Facts<'_>, settings: &mut Settings) -> Option<Action> {
    let mut action = None;
    ui.spacing_mut().slider_width = 110.0;
    figures(ui, facts, settings);
    ui.separator();
    scene(ui, facts, settings, &mut action);
    section(ui, "Time", true, |ui| time(ui, &mut settings.clock));
    section(ui, "Dig and build", true, |ui| {
        let world = facts.viewport.world();
        grid(ui, "brush", |ui| settings.brush.rows(ui, world));
    });
    section(ui, "GPU time of each pass", true, |ui| passes(ui, facts));
    parameters(ui, facts, settings);
    section(ui, "Keys", false, |ui| {
        grid(ui, "keys help", |ui| {
            for (key, does) in controls::HELP {
                ui.strong(*key);
                ui.label(*does);
                ui.end_row();
            }
        });
    });
    ui.separator();
    ui.horizontal(|ui| {
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

/// What runs, its frame rate, and the adapter.
fn figures(ui: &mut Ui, facts: &Facts<'_>, settings: &Settings) {
    let gpu = &facts.viewport.gpu;
    ui.horizontal(|ui| {
        let fps = facts.rate.fps().unwrap_or(0.0);
        ui.label(
            RichText::new(format!("{} FPS", digits(fps)))
                .heading()
                .strong(),
        );
        if fps > 0.0 {
            ui.weak(format!("{} ms", digits(1e3 / fps)));
        }
    });
    time_graph::show(ui, facts.rate);
    ui.label(RichText::new(&gpu.summary.name).small())
        .on_hover_text(format!(
            "{}, through {}, driver {}",
            gpu.summary.kind, gpu.summary.backend, gpu.summary.driver
        ));
    let [width, height] = facts.viewport.frame().size();
    if gpu.summary.is_software() {
        ui.colored_label(
            WARNING,
            format!(
                "Software adapter: a CPU does the work of the GPU. The picture is drawn at \
                 {:.0} % of the window's size.",
                100.0 * settings.scale
            ),
        );
    }
    let frame = facts.viewport.frame();
    let memory = frame.memory();
    let states = match facts.probes {
        Some(counts) => told(&counts),
        None => frame.field().volume().probes().to_string(),
    };
    grid(ui, "figures", |ui| {
        let mut line = |what: &str, value: String| {
            ui.weak(what);
            ui.label(value);
            ui.end_row();
        };
        line("picture", format!("{width} × {height}"));
        line(
            "probes",
            format!("{states}, {} rays each", frame.field().rays_per_probe()),
        );
        line(
            "memory",
            format!(
                "voxels {}, probes {}",
                mebibytes(memory.voxels),
                mebibytes(memory.probes)
            ),
        );
        let Camera {
            position: at,
            yaw_deg,
            pitch_deg,
            ..
        } = facts.camera;
        line(
            "camera",
            format!(
                "({:.1}, {:.1}, {:.1}) {yaw_deg:.0}° {pitch_deg:.0}°",
                at.x, at.y, at.z
            ),
        );
        line("flight", format!("{} voxels/s", digits(facts.fly_speed)));
    });
}

/// Which part of the world is shown, and how.
fn scene(ui: &mut Ui, facts: &Facts<'_>, settings: &mut Settings, action: &mut Option<Action>) {
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

        ui.label("resolution").on_hover_text(
            "Edge length of the picture relative to the window's; time grows with its square",
        );
        ui.add(
            Slider::new(&mut settings.scale, SCALES)
                .custom_formatter(|scale, _| format!("{:.0} %", 100.0 * scale))
                .custom_parser(|text| {
                    let percent: f64 = text.trim_end_matches('%').trim().parse().ok()?;
                    Some(percent / 100.0)
                }),
        );
        ui.end_row();

        ui.label("vsync")
            .on_hover_text("Whether frames wait for the display; off shows what the GPU can do");
        ui.checkbox(&mut settings.vsync, "");
        ui.end_row();
    });
}

fn time(ui: &mut Ui, clock: &mut WorldClock) {
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

/// A bar for each pass; the longest is as wide as the panel allows.
fn passes(ui: &mut Ui, facts: &Facts<'_>) {
    let means = &facts.passes.mean_ms;
    let longest = means.values().fold(0.0, |a: f64, b| a.max(*b));
    if longest <= 0.0 {
        ui.weak("This adapter does not time its passes.");
        return;
    }
    Grid::new("passes")
        .num_columns(3)
        .spacing([10.0, 3.0])
        .show(ui, |ui| {
            for (label, ms) in means {
                ui.monospace(label);
                ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                    ui.monospace(format!("{ms:.2} ms"));
                });
                let (rect, _) =
                    ui.allocate_exact_size(egui::vec2(110.0, 9.0), egui::Sense::hover());
                let mut bar = rect;
                bar.set_width(rect.width() * (ms / longest) as f32);
                let visuals = ui.visuals();
                ui.painter()
                    .rect_filled(rect, 2.0, visuals.extreme_bg_color);
                ui.painter()
                    .rect_filled(bar, 2.0, visuals.selection.bg_fill);
                ui.end_row();
            }
            ui.monospace("sum");
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                ui.monospace(format!("{:.2} ms", means.values().sum::<f64>()));
            });
            ui.end_row();
        });
}

/// A section for each group of parameters, in the order of their table, except that those that rebuild the
/// world come last.
fn parameters(ui: &mut Ui, facts: &Facts<'_>, settings: &mut Settings) {
    let presets = &facts.viewport.world().lamp_presets;
    let presets: Vec<&str> = presets.iter().map(|preset| &*preset.name).collect();
    let sections = [
        ("probes", "Probes", true),
        ("source", "Probes: the source's method", false),
        ("lights", "Lights", true),
        ("picture", "Picture", true),
        ("textures", "Textures", true),
        ("materials", "Materials", false),
        ("world", "World", false),
    ];
    for (prefix, title, open) in sections {
        section(ui, title, open, |ui| {
            grid(ui, prefix, |ui| {
                let keys = KEYS.iter().filter(|key| {
                    key.name
                        .split_once('.')
                        .is_some_and(|(name, _)| name == prefix)
                });
                for key in keys {
                    let names: &[&str] = if key.kind == Kind::Name {
                        &presets
                    } else {
                        &[]
                    };
                    widgets::row(ui, key, &mut settings.choice.parameters, names);
                }
            });
        });
    }
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

fn mebibytes(bytes: u64) -> String {
    format!("{} MiB", digits(bytes as f64 / f64::from(1 << 20)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_parameter_has_its_section() {
        // The sections that `parameters` lists.
        let known = [
            "probes",
            "source",
            "lights",
            "picture",
            "textures",
            "materials",
            "world",
        ];
        for key in KEYS {
            let (section, _) = key.name.split_once('.').expect("section.field");
            assert!(known.contains(&section), "{} has no section", key.name);
        }
    }

    #[test]
    fn passes_that_no_longer_run_are_forgotten() {
        let frame = |label: &str, ms: f64| PassTimes {
            passes_ms: [(label.to_owned(), ms)].into(),
            frame_ms: ms,
        };
        let mut means = PassMeans::default();
        means.push(&frame("old", 4.0));
        means.push(&frame("view/shade", 10.0));
        means.push(&frame("view/shade", 20.0));
        assert_eq!(means.mean_ms.len(), 1);
        assert!((means.mean_ms["view/shade"] - 11.0).abs() < 1e-9);
    }
}
