//! `grotto bench history`: a curve over commits for each row.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::{
    super::{Failure, options::RunOptions, out_file::OutFile, output},
    model::{Figure, Report},
    page::{
        adapter_words,
        html::{self, document, paragraph, warning},
        names::distinct,
    },
};
use crate::measure::plot::{self, Curve, Curves, Mark, Scale, escaped, figure};

/// Draw each row's curve over the commits of several results
///
/// The results are ordered by the time when they started, whatever the order of their folders.
#[derive(Args)]
pub struct Arguments {
    /// The folders of the results
    #[arg(value_name = "DIR", required = true)]
    results: Vec<PathBuf>,
    /// The page
    #[arg(long, value_name = "FILE.html")]
    out: PathBuf,
    #[command(flatten)]
    run: RunOptions,
}

/// One row in all results.
#[derive(Debug, PartialEq, Serialize)]
struct Line {
    suite: String,
    id: String,
    /// `frame_ms`, or the name of a figure.
    quantity: String,
    points: Vec<Point>,
}

#[derive(Debug, PartialEq, Serialize)]
struct Point {
    /// Index of the result, counted from 0.
    result: usize,
    #[serde(flatten)]
    figure: Figure,
}

/// What `--json` prints.
#[derive(Serialize)]
struct Record<'a> {
    results: Vec<Origin<'a>>,
    rows: &'a [Line],
}

#[derive(Serialize)]
struct Origin<'a> {
    started: &'a str,
    commit: &'a str,
    suite: &'a str,
    adapters: Vec<String>,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let out = &arguments.out;
    let wanted = || {
        Failure::bad_input(format!(
            "--out {}: name a file, as in history.html",
            out.display()
        ))
    };
    let name = out
        .file_name()
        .and_then(|name| name.to_str())
        .ok_or_else(wanted)?;
    if !name.ends_with(".html") {
        return Err(wanted());
    }
    let mut reports = Vec::new();
    for path in &arguments.results {
        reports.push(Report::read(path)?);
    }
    reports.sort_by(|a, b| a.started.cmp(&b.started));
    let file = OutFile::new(out.parent().unwrap_or(out), name)?;
    let lines = lines(&reports);
    file.write(&page(&reports, &lines))?;
    if arguments.run.json {
        let results = reports.iter().map(|report| Origin {
            started: &report.started,
            commit: &report.build.commit,
            suite: &report.suite,
            adapters: adapters(report),
        });
        return output::print_json(&Record {
            results: results.collect(),
            rows: &lines,
        });
    }
    output::print(&format!(
        "{}: {} rows over {} results\n",
        out.display(),
        lines.len(),
        reports.len()
    ))
}

fn adapters(report: &Report) -> Vec<String> {
    distinct(report.rows.iter().map(|row| adapter_words(&row.adapter)))
}

/// A line for each row and quantity, in order of first appearance.
fn lines(reports: &[Report]) -> Vec<Line> {
    let mut lines: Vec<Line> = Vec::new();
    for (result, report) in reports.iter().enumerate() {
        for row in &report.rows {
            let Some((quantity, figure)) = row.headline() else {
                continue;
            };
            let known = lines
                .iter_mut()
                .find(|line| line.id == row.id && line.quantity == quantity);
            let point = Point { result, figure };
            match known {
                Some(line) => line.points.push(point),
                None => lines.push(Line {
                    suite: row.suite.clone(),
                    id: row.id.clone(),
                    quantity: quantity.to_owned(),
                    points: vec![point],
                }),
            }
        }
    }
    lines
}

/// Characters of a commit hash that are shown.
const SHORT: usize = 7;

fn short(commit: &str) -> String {
    let hash: String = commit.chars().take(SHORT).collect();
    if commit.contains('+') {
        hash + "+"
    } else {
        hash
    }
}

fn page(reports: &[Report], lines: &[Line]) -> String {
    let commits: Vec<String> = reports
        .iter()
        .map(|report| short(&report.build.commit))
        .collect();
    let mut body = "<h1>grotto bench history</h1>\n".to_owned();
    let machines = distinct(
        reports
            .iter()
            .map(|report| (adapters(report), &report.machine.cpu)),
    );
    if machines.len() > 1 {
        body += &warning(
            "The results are not all of one machine: steps in the curves may be changes of machine.",
        );
    }
    if reports.iter().any(|report| !report.complete) {
        body += &warning("Some results are partial.");
    }
    let origins: Vec<Vec<String>> = reports
        .iter()
        .enumerate()
        .map(|(index, report)| {
            vec![
                (index + 1).to_string(),
                report.started.clone(),
                report.build.commit.clone(),
                report.suite.clone(),
                adapters(report).join("; "),
                report.machine.cpu.clone(),
            ]
        })
        .collect();
    body += &html::table(
        &["", "started", "commit", "suite", "adapter", "CPU"],
        &origins,
    );
    body += &paragraph(
        "Medians with their 95 % intervals, oldest result first. The axes do not begin at zero.",
    );
    for suite in distinct(lines.iter().map(|line| line.suite.as_str())) {
        let of_suite = || lines.iter().filter(|line| line.suite == suite);
        body += &format!("<h2>{}</h2>\n", escaped(suite));
        body += &html::plots(
            &of_suite()
                .map(|line| plotted(line, &commits))
                .collect::<String>(),
        );
        let mut header = vec!["row".to_owned(), String::new()];
        header.extend(commits.iter().cloned());
        let numbers: Vec<Vec<String>> = of_suite()
            .map(|line| {
                let at = |result| line.points.iter().find(|point| point.result == result);
                let value =
                    |result| at(result).map_or(String::new(), |point| figure(point.figure.value));
                let mut cells = vec![line.id.clone(), line.quantity.clone()];
                cells.extend((0..commits.len()).map(value));
                cells
            })
            .collect();
        body += &html::table(&header, &numbers);
    }
    document("grotto bench history", &body)
}

fn plotted(line: &Line, commits: &[String]) -> String {
    let ends = line.points.iter().flat_map(|point| {
        let half = point.figure.half_width.unwrap_or(0.0);
        [point.figure.value - half, point.figure.value + half]
    });
    let points = line.points.iter().map(|point| {
        (
            point.result as f64,
            point.figure.value,
            point.figure.half_width,
        )
    });
    let svg = plot::curves(&Curves {
        label: &format!("{} over commits", line.id),
        x: Scale::named(commits),
        y: Scale::around(ends, 5),
        x_name: "commit",
        y_name: &line.quantity,
        curves: vec![Curve {
            series: 0,
            points: points.collect(),
            mark: Mark::Line,
        }],
        notes: Vec::new(),
    });
    html::plot(&line.id, &svg, &[], &[])
}

#[cfg(test)]
mod tests {
    use super::{super::made_up, *};

    #[test]
    fn every_row_has_its_curve_and_gaps_stay_gaps() {
        let mut reports = vec![made_up::report(), made_up::report(), made_up::report()];
        reports[1].rows.remove(0);
        reports[2].build.commit = "fedcba987654+changes".to_owned();
        let lines = lines(&reports);
        assert_eq!(lines.len(), 12);
        let results: Vec<usize> = lines[0].points.iter().map(|point| point.result).collect();
        assert_eq!(results, [0, 2]);
        let page = page(&reports, &lines);
        assert_eq!(page.matches("<svg").count(), 12);
        for part in ["0123456", "fedcba9+", "first_frame_ms", "Card 9000"] {
            assert!(page.contains(part), "{part}");
        }
        assert!(!page.contains("not all of one machine"));
        reports[0].machine.cpu = "other".to_owned();
        assert!(super::page(&reports, &lines).contains("not all of one machine"));
    }
}
