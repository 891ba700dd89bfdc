//! The frame times of a benchmark, drawn over the picture and as text.

use egui::{Align, Align2, Grid, Id, Layout, RichText, Ui, Window, vec2};

use super::super::{panel::digits, time_graph};
use crate::measure::frame_times::FrameStatistics;

/// Size of the curve (egui's points).
const GRAPH: egui::Vec2 = vec2(520.0, 110.0);

/// What was drawn, and on which adapter.
#[derive(Clone, Debug, Default)]
pub struct Surroundings {
    pub world: String,
    pub layout: String,
    /// Width and height of the picture in pixels.
    pub size: [u32; 2],
    /// The same of what was rendered for it.
    pub rendered: [u32; 2],
    pub adapter: String,
    /// Whether the adapter is software: a CPU does the work of the GPU.
    pub software: bool,
    /// The present mode, as Vulkan calls it.
    pub presented: String,
    /// Whether presenting waited for the display.
    pub paced: bool,
}

/// Frame times by one clock.
struct Series {
    clock: &'static str,
    frames_ms: Vec<f64>,
    figures: FrameStatistics,
}

impl Series {
    fn new(clock: &'static str, frames_ms: Vec<f64>) -> Option<Self> {
        let figures = FrameStatistics::of(&frames_ms)?;
        Some(Self {
            clock,
            frames_ms,
            figures,
        })
    }
}

/// The figures of a run.
pub struct Summary {
    flight: String,
    surroundings: Surroundings,
    /// One or two; the curve shows the first.
    series: Vec<Series>,
}

impl Summary {
    /// `None` if no frame was measured.
    pub fn new(
        flight: String,
        wall_ms: Vec<f64>,
        gpu_ms: Vec<f64>,
        surroundings: Surroundings,
    ) -> Option<Self> {
        let clocks = [("GPU", gpu_ms), ("wall clock", wall_ms)];
        let series: Vec<Series> = clocks
            .into_iter()
            .filter_map(|(clock, frames_ms)| Series::new(clock, frames_ms))
            .collect();
        (!series.is_empty()).then_some(Self {
            flight,
            surroundings,
            series,
        })
    }

    /// What was drawn.
    fn subject(&self) -> String {
        let of = &self.surroundings;
        let words = |[width, height]: [u32; 2]| format!("{width} × {height}");
        let mut picture = words(of.size);
        if of.rendered != of.size {
            picture += &format!(" from {}", words(of.rendered));
        }
        format!("{} · {} · {picture}", of.world, of.layout)
    }

    fn run(&self) -> String {
        let count = self.series[0].figures.count;
        format!("{}, {count} frames", self.flight)
    }

    fn adapter(&self) -> String {
        let of = &self.surroundings;
        let software = if of.software {
            ": software, a CPU does the work of the GPU"
        } else {
            ""
        };
        format!("{}{software}", of.adapter)
    }

    fn pacing(&self) -> String {
        let of = &self.surroundings;
        if of.paced {
            format!(
                "Present mode {}, for want of one without vsync: wall times are paced by the display.",
                of.presented
            )
        } else {
            format!(
                "Present mode {}: nothing waits for the display.",
                of.presented
            )
        }
    }

    /// As lines of text, for the log.
    pub fn text(&self) -> String {
        let mut text = format!("{}\n{}\n{}\n", self.subject(), self.run(), self.adapter());
        for series in &self.series {
            text += series.clock;
            for (what, value) in rows(&series.figures) {
                text += &format!(" · {what} {value}");
            }
            text.push('\n');
        }
        text + &self.pacing()
    }

    /// Draws the summary over the middle of the window.
    pub fn show(&self, ui: &Ui) {
        Window::new("Benchmark")
            .id(Id::unique("benchmark"))
            .anchor(Align2::CENTER_CENTER, [0.0, 0.0])
            .collapsible(false)
            .resizable(false)
            .interactable(false)
            .show(ui.ctx(), |ui| self.contents(ui));
    }

    fn contents(&self, ui: &mut Ui) {
        ui.set_max_width(GRAPH.x);
        ui.label(RichText::new(self.subject()).strong());
        ui.label(self.run());
        ui.label(self.adapter());
        ui.separator();
        self.table(ui);
        ui.separator();
        let first = &self.series[0];
        let (frames_ms, figures) = (&first.frames_ms, &first.figures);
        time_graph::draw(ui, frames_ms, Some(figures), frames_ms.len(), GRAPH);
        ui.horizontal(|ui| {
            ui.label(format!("{} time of every frame:", first.clock));
            ui.colored_label(time_graph::MEDIAN, "median");
            ui.colored_label(time_graph::LOW, "1 % low");
        });
        ui.separator();
        ui.label(self.pacing());
        ui.label("Any key or a click closes this.");
    }

    fn table(&self, ui: &mut Ui) {
        Grid::new("benchmark figures")
            .num_columns(1 + self.series.len())
            .spacing([28.0, 3.0])
            .show(ui, |ui| {
                ui.label("");
                for series in &self.series {
                    right(ui, RichText::new(series.clock).strong());
                }
                ui.end_row();
                let columns: Vec<_> = self.series.iter().map(|s| rows(&s.figures)).collect();
                for (row, (what, _)) in columns[0].iter().enumerate() {
                    ui.label(*what);
                    for column in &columns {
                        right(ui, RichText::new(&column[row].1).monospace());
                    }
                    ui.end_row();
                }
            });
    }
}

fn right(ui: &mut Ui, text: RichText) {
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| ui.label(text));
}

/// The names of the figures, and their values.
fn rows(figures: &FrameStatistics) -> [(&'static str, String); 8] {
    let fps = |fps: f64| format!("{} FPS", digits(fps));
    let ms = |ms: f64| format!("{} ms", digits(ms));
    [
        (
            "median",
            format!("{} · {}", ms(figures.median), fps(figures.fps())),
        ),
        ("1 % low, by frames", fps(figures.low1_fps)),
        ("1 % low, by time", fps(figures.low1_integral_fps)),
        ("P95", ms(figures.p95)),
        ("P99", ms(figures.p99)),
        ("P99.9", ms(figures.p999)),
        ("worst", ms(figures.worst)),
        (
            "stutters, over 2.5 medians",
            format!(
                "{} · {:.1} % of time",
                figures.stutters,
                100.0 * figures.stutter_share
            ),
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_clock_has_its_figures_and_the_pacing_is_told() {
        let mut wall = vec![10.0; 99];
        wall.push(40.0);
        let surroundings = Surroundings {
            world: "cave".into(),
            size: [640, 360],
            rendered: [320, 180],
            presented: "Fifo".into(),
            paced: true,
            ..Surroundings::default()
        };
        let both = Summary::new("20 s".into(), wall.clone(), vec![2.0; 100], surroundings);
        let text = both.expect("frames").text();
        for part in [
            "cave",
            "640 × 360 from 320 × 180",
            "100 frames",
            "GPU · median 2.00 ms · 500 FPS",
            "wall clock · median 10.0 ms · 100 FPS",
            "worst 40.0 ms",
            "stutters, over 2.5 medians 1 · 3.9 % of time",
            "paced by the display",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
        let alone = Summary::new("4 s".into(), wall, Vec::new(), Surroundings::default());
        let text = alone.expect("frames").text();
        assert!(!text.contains("GPU"), "{text}");
        assert!(text.contains("nothing waits"), "{text}");
        let nothing = Summary::new(String::new(), vec![], vec![], Surroundings::default());
        assert!(nothing.is_none());
    }
}
