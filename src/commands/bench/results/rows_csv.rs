//! `rows.csv`: one line for each row, for spreadsheets.

use std::collections::BTreeSet;

use super::super::model::{Report, Row, Varied};
use crate::measure::frame_times::FrameStatistics;

/// A field as RFC 4180 defines it.
pub fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}

/// All rows. Values that a row does not have are empty fields.
pub fn rows_csv(report: &Report) -> String {
    let columns = Columns::of(report);
    let mut text = line(&columns.names());
    for row in &report.rows {
        text += &line(&columns.fields(report, row));
    }
    text
}

fn line(fields: &[String]) -> String {
    let fields: Vec<String> = fields.iter().map(|field| quoted(field)).collect();
    fields.join(",") + "\n"
}

const FIXED: [&str; 25] = [
    "id",
    "suite",
    "world",
    "world_hash",
    "camera",
    "layout",
    "condition",
    "view",
    "width",
    "height",
    "frames",
    "seed",
    "varied",
    "set",
    "adapter",
    "kind",
    "driver",
    "backend",
    "cpu",
    "os",
    "commit",
    "clock",
    "fps",
    "half_width_ms",
    "noisy",
];
const STATISTICS: [&str; 11] = [
    "count",
    "median",
    "mean",
    "p95",
    "p99",
    "p999",
    "worst",
    "low1_fps",
    "low1_integral_fps",
    "stutters",
    "stutter_share",
];
const STATISTICS_OF: [&str; 3] = ["frame_ms", "cpu_ms", "wall_ms"];
const LAST: [&str; 12] = [
    "runs_ms",
    "probes",
    "probes_alive",
    "probes_sleeping",
    "probes_dead",
    "probes_updated",
    "flip",
    "energy",
    "spp",
    "graphics_mhz",
    "memory_mhz",
    "power_w",
];

/// The columns of a report: the fixed ones, and one for each name that a row has.
struct Columns {
    /// `passes.`, `rays.`, … with the names under each prefix.
    named: Vec<(&'static str, BTreeSet<String>)>,
}

impl Columns {
    fn of(report: &Report) -> Self {
        let union = |names: fn(&Row) -> Vec<&String>| -> BTreeSet<String> {
            report.rows.iter().flat_map(names).cloned().collect()
        };
        Self {
            named: vec![
                ("passes", union(|row| row.passes.keys().collect())),
                ("rays", union(|row| row.rays.keys().collect())),
                ("mrays_per_s", union(|row| row.mrays_per_s.keys().collect())),
                (
                    "memory_bytes",
                    union(|row| row.memory_bytes.keys().collect()),
                ),
                ("figures", union(|row| row.figures.keys().collect())),
                ("half_width", union(|row| row.figures.keys().collect())),
            ],
        }
    }

    fn names(&self) -> Vec<String> {
        let mut names: Vec<String> = FIXED.map(str::to_owned).to_vec();
        for of in STATISTICS_OF {
            names.extend(STATISTICS.map(|name| format!("{of}.{name}")));
        }
        names.extend(LAST.map(str::to_owned));
        for (group, keys) in &self.named {
            names.extend(keys.iter().map(|key| format!("{group}.{key}")));
        }
        names
    }

    fn fields(&self, report: &Report, row: &Row) -> Vec<String> {
        let machine = report.machine_of(row);
        let world = report.worlds.iter().find(|world| world.name == row.world);
        let timing = row.timing.as_ref();
        let state = machine.gpu_after.or(machine.gpu_before);
        let varied = row.varied.iter().map(|(key, value)| match value {
            Varied::Number(number) => format!("{key}={number}"),
            Varied::Text(text) => format!("{key}={text}"),
        });
        let mut fields = vec![
            row.id.clone(),
            row.suite.clone(),
            row.world.clone(),
            world.map_or(String::new(), |world| world.hash.clone()),
            row.camera.clone(),
            row.layout.clone().unwrap_or_default(),
            row.condition.clone(),
            row.view.clone(),
            row.size[0].to_string(),
            row.size[1].to_string(),
            row.frames.to_string(),
            row.seed.to_string(),
            varied.collect::<Vec<_>>().join("; "),
            row.set.join("; "),
            row.adapter.name.clone(),
            row.adapter.kind.clone(),
            row.adapter.driver.clone(),
            row.adapter.backend.clone(),
            machine.cpu.clone(),
            machine.os.clone(),
            report.build_of(row).commit.clone(),
            row.clock.clone(),
            maybe(row.fps),
            maybe(timing.and_then(|timing| timing.interval.half_width)),
            maybe(timing.map(|timing| timing.noisy)),
        ];
        fields.extend(statistics(row.frame_ms.as_ref()));
        fields.extend(statistics(timing.map(|timing| &timing.cpu_ms)));
        fields.extend(statistics(timing.map(|timing| &timing.wall_ms)));
        let runs = timing.map_or(&[][..], |timing| &timing.runs_ms);
        let runs: Vec<String> = runs.iter().map(f64::to_string).collect();
        let probes = row.probes.as_ref();
        let quality = row.quality.as_ref();
        fields.extend([
            runs.join(" "),
            maybe(probes.map(|probes| probes.total)),
            maybe(probes.map(|probes| probes.alive)),
            maybe(probes.map(|probes| probes.sleeping)),
            maybe(probes.map(|probes| probes.dead)),
            maybe(probes.map(|probes| probes.updated)),
            maybe(quality.map(|quality| quality.flip)),
            maybe(quality.and_then(|quality| quality.energy)),
            maybe(quality.map(|quality| quality.spp)),
            maybe(state.and_then(|state| state.graphics_mhz)),
            maybe(state.and_then(|state| state.memory_mhz)),
            maybe(state.and_then(|state| state.power_w)),
        ]);
        for (group, keys) in &self.named {
            fields.extend(keys.iter().map(|key| match *group {
                "passes" => maybe(row.passes.get(key)),
                "rays" => maybe(row.rays.get(key)),
                "mrays_per_s" => maybe(row.mrays_per_s.get(key)),
                "memory_bytes" => maybe(row.memory_bytes.get(key)),
                "figures" => maybe(row.figures.get(key).map(|figure| figure.value)),
                _ => maybe(row.figures.get(key).and_then(|figure| figure.half_width)),
            }));
        }
        fields
    }
}

fn maybe(value: Option<impl ToString>) -> String {
    value.map_or(String::new(), |value| value.to_string())
}

fn statistics(of: Option<&FrameStatistics>) -> Vec<String> {
    let Some(of) = of else {
        return vec![String::new(); STATISTICS.len()];
    };
    let figures = [
        of.median,
        of.mean,
        of.p95,
        of.p99,
        of.p999,
        of.worst,
        of.low1_fps,
        of.low1_integral_fps,
    ];
    let mut fields = vec![of.count.to_string()];
    fields.extend(figures.map(|figure| figure.to_string()));
    fields.extend([of.stutters.to_string(), of.stutter_share.to_string()]);
    fields
}

#[cfg(test)]
mod tests {
    use super::{super::super::made_up, *};

    /// A parser of RFC 4180, for the round trip.
    fn parsed(text: &str) -> Vec<Vec<String>> {
        let (mut lines, mut fields, mut field) = (Vec::new(), Vec::new(), String::new());
        let (mut inside, mut characters) = (false, text.chars().peekable());
        while let Some(character) = characters.next() {
            match character {
                '"' if inside && characters.peek() == Some(&'"') => {
                    characters.next();
                    field.push('"');
                }
                '"' => inside = !inside,
                ',' if !inside => fields.push(std::mem::take(&mut field)),
                '\n' if !inside => {
                    fields.push(std::mem::take(&mut field));
                    lines.push(std::mem::take(&mut fields));
                }
                other => field.push(other),
            }
        }
        lines
    }

    #[test]
    fn every_field_comes_back_as_it_was() {
        let mut report = made_up::report();
        report.rows[0].condition = "with \"quotes\",\nand lines".to_owned();
        let lines = parsed(&rows_csv(&report));
        assert_eq!(lines.len(), report.rows.len() + 1);
        assert!(lines.iter().all(|line| line.len() == lines[0].len()));
        let names: BTreeSet<&String> = lines[0].iter().collect();
        assert_eq!(names.len(), lines[0].len(), "no name twice");
        let field = |row: usize, name: &str| {
            let column = lines[0].iter().position(|found| found == name);
            lines[row + 1][column.expect(name)].clone()
        };
        for (index, row) in report.rows.iter().enumerate() {
            assert_eq!(field(index, "id"), row.id);
            assert_eq!(field(index, "condition"), row.condition);
            let number = |name: &str| field(index, name).parse::<f64>().ok();
            assert_eq!(number("fps"), row.fps);
            assert_eq!(
                number("frame_ms.low1_integral_fps"),
                row.frame_ms.map(|ms| ms.low1_integral_fps)
            );
            for (pass, ms) in &row.passes {
                assert_eq!(number(&format!("passes.{pass}")), Some(*ms));
            }
            for (name, figure) in &row.figures {
                assert_eq!(number(&format!("figures.{name}")), Some(figure.value));
            }
            assert_eq!(field(index, "commit"), report.build.commit);
            assert_eq!(field(index, "world_hash").len(), 32);
        }
    }
}
