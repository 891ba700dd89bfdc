//! The numbers of all rows, and the frames of each.

use std::collections::BTreeMap;

use super::{
    super::model::{Figure, Row},
    html,
};
use crate::measure::plot::{self, escaped, figure};

/// Tables of a suite: one of its frames, one of its other figures.
pub fn tables(suite: &str, rows: &[&Row]) -> String {
    let name = |row: &Row| {
        let within = format!("{suite}/");
        row.id.strip_prefix(&within).unwrap_or(&row.id).to_owned()
    };
    let timed: Vec<Vec<String>> = rows
        .iter()
        .filter_map(|row| Some([vec![name(row)], frame_cells(row)?].concat()))
        .collect();
    let figures: Vec<Vec<String>> = rows
        .iter()
        .flat_map(|row| figure_lines(&name(row), &row.figures))
        .collect();
    let mut text = String::new();
    if !timed.is_empty() {
        text += &html::table(&HEADER, &timed);
    }
    if !figures.is_empty() {
        text += &html::table(&["row", "figure", "value", "±"], &figures);
    }
    text
}

const HEADER: [&str; 19] = [
    "row",
    "FPS",
    "±",
    "median ms",
    "P95",
    "P99",
    "P99.9",
    "worst",
    "1 % low FPS",
    "by time",
    "stutter",
    "runs",
    "clock",
    "CPU ms",
    "wall ms",
    "Mrays/s",
    "probes alive",
    "memory MB",
    "FLIP",
];

/// All cells after the name; `None` for a row that is not about frames.
fn frame_cells(row: &Row) -> Option<Vec<String>> {
    let (timing, ms) = (row.timing.as_ref()?, row.frame_ms?);
    let noisy = if timing.noisy { " ~" } else { "" };
    let relative = 100.0 * timing.interval.relative();
    let width = if relative.is_finite() {
        format!("{relative:.2} %{noisy}")
    } else {
        format!("unknown{noisy}")
    };
    let rays: f64 = row.mrays_per_s.values().sum();
    let some = |value: Option<String>| value.unwrap_or_default();
    let memory = row.memory_bytes.get("total");
    Some(vec![
        figure(ms.fps()),
        width,
        format!("{:.4}", ms.median),
        figure(ms.p95),
        figure(ms.p99),
        figure(ms.p999),
        figure(ms.worst),
        figure(ms.low1_fps),
        figure(ms.low1_integral_fps),
        format!("{:.2} %", 100.0 * ms.stutter_share),
        timing.runs_ms.len().to_string(),
        row.clock.clone(),
        figure(timing.cpu_ms.median),
        figure(timing.wall_ms.median),
        if rays > 0.0 {
            figure(rays)
        } else {
            String::new()
        },
        some(
            row.probes
                .map(|probes| format!("{} of {}", probes.alive, probes.total)),
        ),
        some(memory.map(|bytes| figure(*bytes as f64 / 1e6))),
        some(row.quality.map(|quality| format!("{:.4}", quality.flip))),
    ])
}

fn figure_lines(name: &str, figures: &BTreeMap<String, Figure>) -> Vec<Vec<String>> {
    let line = |(what, of): (&String, &Figure)| {
        let half = of.half_width.map_or(String::new(), figure);
        vec![name.to_owned(), what.clone(), figure(of.value), half]
    };
    figures.iter().map(line).collect()
}

/// Most steps of a histogram in the page: neighbouring steps are joined.
const MOST_STEPS: usize = 60;

/// The frame times of each row in order, and their histogram.
pub fn frames(rows: &[&Row]) -> String {
    let each = rows.iter().filter_map(|row| {
        let (timing, ms) = (row.timing.as_ref()?, row.frame_ms?);
        let label = format!("Frames of {}", row.id);
        let curve = plot::frame_curve(&label, &timing.curve_ms, ms.median);
        let join = timing.histogram.len().div_ceil(MOST_STEPS).max(1);
        let counts: Vec<u32> = timing
            .histogram
            .chunks(join)
            .map(|steps| steps.iter().sum())
            .collect();
        let step_ms = timing.histogram_step_ms * join as f64;
        let histogram = plot::histogram(&label, &counts, timing.histogram_from_ms, step_ms);
        Some(format!(
            "<figure><figcaption>{}</figcaption>{curve}{histogram}</figure>\n",
            escaped(&row.id)
        ))
    });
    let all: String = each.collect();
    if all.is_empty() {
        return all;
    }
    format!(
        "<details><summary>Frame times of each row: in order, and as a histogram</summary>\n{}\
         </details>\n",
        html::plots(&all)
    )
}
