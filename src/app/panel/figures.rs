//! Figures of what runs: frame rate, adapter, probes, memory, and the time of each pass.

use std::collections::BTreeMap;

use egui::{Align, Color32, Grid, Layout, RichText, Ui};

use super::{Facts, digits};
use crate::{
    app::{named_lines, time_graph},
    gpu::PassTimes,
    passes::probes::StateCounts,
    world::Camera,
};

const WARNING: Color32 = Color32::from_rgb(255, 190, 80);

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

/// The counts of the states add up to the total.
pub fn told(counts: &StateCounts) -> String {
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

/// What runs, its frame rate, and the adapter.
pub fn figures(ui: &mut Ui, facts: &Facts<'_>) {
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
    let frame = facts.viewport.frame();
    if gpu.summary.is_software() {
        ui.colored_label(WARNING, "Software adapter: a CPU does the work of the GPU.");
    }
    let memory = frame.memory();
    let states = match facts.probes {
        Some(counts) => told(&counts),
        None => frame.field().volume().probes().to_string(),
    };
    let Camera {
        position: at,
        yaw_deg,
        pitch_deg,
        ..
    } = facts.camera;
    let lines = [
        ("picture", facts.picture_in_words()),
        (
            "probes",
            format!("{states}, {} rays each", facts.rays_per_update()),
        ),
        (
            "memory",
            format!(
                "voxels {}, probes {}",
                mebibytes(memory.voxels),
                mebibytes(memory.probes)
            ),
        ),
        (
            "camera",
            format!(
                "({:.1}, {:.1}, {:.1}) {yaw_deg:.0}° {pitch_deg:.0}°",
                at.x, at.y, at.z
            ),
        ),
        ("flight", format!("{} voxels/s", digits(facts.fly_speed))),
    ];
    ui.scope(|ui| named_lines::show(ui, &lines));
}

/// A bar for each pass; the longest is as wide as the panel allows.
pub fn passes(ui: &mut Ui, facts: &Facts<'_>) {
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

fn mebibytes(bytes: u64) -> String {
    format!("{} MiB", digits(bytes as f64 / f64::from(1 << 20)))
}

#[cfg(test)]
mod tests {
    use super::*;

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
