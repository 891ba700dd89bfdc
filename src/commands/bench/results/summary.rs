//! What the terminal shows at the end: the most important numbers.

use std::fmt::Write as _;

use super::{
    super::model::{Report, Row},
    probe_tables::{self, hit_cells, probe_cells},
};
use crate::measure::plot::figure;

/// A table for each suite, with software adapters in tables of their own.
pub fn summary(report: &Report) -> String {
    let mut text = String::new();
    let of = |software| -> Vec<&Row> {
        let rows = report.rows.iter();
        rows.filter(|row| row.is_software() == software).collect()
    };
    let (hardware, software) = (of(false), of(true));
    add_tables(&mut text, &hardware);
    if !software.is_empty() {
        let name = &software[0].adapter.name;
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "SOFTWARE ADAPTER ({name}): a CPU does the work of the GPU, and these are not figures of a GPU"
        );
        add_tables(&mut text, &software);
    }
    for missing in &report.missing {
        let _ = writeln!(text, "missing: {}: {}", missing.id, missing.reason);
    }
    let noisy = report.rows.iter().filter(|row| row.is_noisy()).count();
    if noisy > 0 {
        let _ = writeln!(
            text,
            "~ noisy: after the largest number of runs the interval of the median is still wider than \
             ±1 % ({noisy} rows)"
        );
    }
    if !report.complete {
        text += "PARTIAL: the run was stopped before all rows were measured\n";
    }
    text
}

fn add_tables(text: &mut String, rows: &[&Row]) {
    let mut suites: Vec<&str> = Vec::new();
    for row in rows {
        if !suites.contains(&row.suite.as_str()) {
            suites.push(&row.suite);
        }
    }
    for suite in suites {
        let of = |timed: bool| -> Vec<&Row> {
            let rows = rows.iter().copied().filter(|row| row.suite == suite);
            rows.filter(|row| row.timing.is_some() == timed).collect()
        };
        let (timed, others) = (of(true), of(false));
        match suite {
            "probes" if !timed.is_empty() => {
                add_table(text, suite, &probe_tables::PROBES, &timed, probe_cells);
                continue;
            }
            "hits" if !others.is_empty() => {
                add_table(text, suite, &probe_tables::HITS, &others, hit_cells);
                continue;
            }
            _ => {}
        }
        if !timed.is_empty() {
            let header = ["FPS", "±", "1% low", "P99 ms", "worst", "stutter"];
            add_table(text, suite, &header, &timed, frame_cells);
        }
        if !others.is_empty() {
            add_table(
                text,
                suite,
                &["figure", "value", "±"],
                &others,
                figure_cells,
            );
        }
    }
}

/// The lines of a row in the table of frames.
fn frame_cells(row: &Row) -> Vec<Vec<String>> {
    let (Some(timing), Some(ms)) = (&row.timing, &row.frame_ms) else {
        return Vec::new();
    };
    let relative = 100.0 * timing.interval.relative();
    let noisy = if timing.noisy { " ~" } else { "" };
    vec![vec![
        figure(ms.fps()),
        if relative.is_finite() {
            format!("{relative:.1} %{noisy}")
        } else {
            format!("?{noisy}")
        },
        figure(ms.low1_fps),
        figure(ms.p99),
        figure(ms.worst),
        format!("{:.1} %", 100.0 * ms.stutter_share),
    ]]
}

/// The lines of a row that is not about frames: one for each figure.
fn figure_cells(row: &Row) -> Vec<Vec<String>> {
    let line = |(name, value): (&String, &super::super::model::Figure)| {
        let half = value.half_width.map_or(String::new(), figure);
        vec![name.clone(), figure(value.value), half]
    };
    row.figures.iter().map(line).collect()
}

fn add_table(
    text: &mut String,
    suite: &str,
    header: &[&str],
    rows: &[&Row],
    cells: fn(&Row) -> Vec<Vec<String>>,
) {
    let within = format!("{suite}/");
    let mut lines = vec![Vec::from_iter(
        [suite]
            .into_iter()
            .chain(header.iter().copied())
            .map(str::to_owned),
    )];
    for row in rows {
        let name = row.id.strip_prefix(&within).unwrap_or(&row.id);
        for (index, cells) in cells(row).into_iter().enumerate() {
            let name = if index == 0 { name } else { "" };
            lines.push([vec![name.to_owned()], cells].concat());
        }
    }
    let width = |column: usize| lines.iter().map(|line| line[column].chars().count()).max();
    let widths: Vec<usize> = (0..=header.len()).filter_map(width).collect();
    for line in &lines {
        let mut cells = line.iter().zip(&widths);
        if let Some((name, width)) = cells.next() {
            let _ = write!(text, "{name:<width$}");
        }
        for (cell, width) in cells {
            let _ = write!(text, "  {cell:>width$}");
        }
        text.push('\n');
    }
    text.push('\n');
}

#[cfg(test)]
mod tests {
    use super::{
        super::super::{made_up, model::Missing},
        *,
    };

    #[test]
    fn the_numbers_that_matter_are_there() {
        let text = summary(&made_up::report());
        for part in [
            "layouts",
            "cave/layout1/moving",
            "1250",
            "±",
            "1% low",
            "first_frame_ms",
            "812",
        ] {
            assert!(text.contains(part), "{part}:\n{text}");
        }
        for warning in ["SOFTWARE", "PARTIAL", "noisy", "missing"] {
            assert!(!text.contains(warning), "{warning}:\n{text}");
        }
        let lines: Vec<&str> = text
            .lines()
            .filter(|line| line.starts_with("cave/layout"))
            .collect();
        let width = lines[0].chars().count();
        assert!(lines[..8].iter().all(|line| line.chars().count() == width));
    }

    #[test]
    fn warnings_are_loud() {
        let mut report = made_up::report();
        report.complete = false;
        report.rows[3].adapter.kind = "software".to_owned();
        report.rows[3].adapter.name = "llvmpipe".to_owned();
        report.rows[0].timing.as_mut().expect("frames").noisy = true;
        report.missing.push(Missing {
            id: "lights/64".to_owned(),
            reason: "no preset has as many".to_owned(),
        });
        let text = summary(&report);
        for part in ["PARTIAL", "missing: lights/64: no preset", "(1 rows)", " ~"] {
            assert!(text.contains(part), "{part}:\n{text}");
        }
        let (before, after) = text
            .split_once("SOFTWARE ADAPTER (llvmpipe)")
            .expect("a heading");
        assert!(!before.contains(&report.rows[3].id["layouts/".len()..]));
        assert!(after.contains(&report.rows[3].id["layouts/".len()..]));
    }
}
