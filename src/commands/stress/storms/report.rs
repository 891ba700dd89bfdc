//! The output of storms: a record for each, as JSON and as a table.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use serde::Serialize;

use super::{judge::Check, soak::Sample};

/// The file of the records in the folder of `--out`.
pub const FILE: &str = "storms.json";

/// One run: the kinds that ran at the same time in one world, and the results.
#[derive(Clone, Debug, Serialize)]
pub struct StormRecord {
    /// The flags of its kinds, joined by `+`.
    pub storm: String,
    pub world: String,
    pub seed: u32,
    /// Frames of the storm itself.
    pub frames: u32,
    /// Frames without a change after the storm, and frames of the fresh pictures that it is compared with.
    pub settling: u32,
    /// Width and height in pixels at the start.
    pub size: [u32; 2],
    /// Whether the storm ended normally; if not, there are no checks.
    pub complete: bool,
    /// Number of changes of each kind.
    pub changes: BTreeMap<&'static str, u64>,
    pub checks: Vec<Check>,
    /// The command that repeats the run.
    pub repeat: String,
    /// Values that vary from run to run.
    pub measured: Measured,
}

/// Values that vary from run to run.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Measured {
    /// Seconds of the storm itself.
    pub seconds: f64,
    /// Under the name of the check.
    pub values: BTreeMap<String, f64>,
    /// Samples of a soak.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub samples: Vec<Sample>,
}

impl StormRecord {
    /// Whether the run is complete and all its checks hold.
    pub fn passed(&self) -> bool {
        self.complete && self.checks.iter().all(|check| check.passed)
    }

    fn failed(&self) -> impl Iterator<Item = &Check> {
        self.checks.iter().filter(|check| !check.passed)
    }
}

/// A few lines for each record.
pub fn table(records: &[StormRecord]) -> String {
    let mut text = String::new();
    for record in records {
        let verdict = match (record.complete, record.passed()) {
            (false, _) => "stopped",
            (true, true) => "passed",
            (true, false) => "FAILED",
        };
        let _ = writeln!(
            text,
            "{verdict}  {} · {} · seed {} · {} frames at {}x{}",
            record.storm, record.world, record.seed, record.frames, record.size[0], record.size[1]
        );
        let changes = record
            .changes
            .iter()
            .map(|(what, count)| format!("{count} {what}"));
        let _ = writeln!(text, "        {}", changes.collect::<Vec<_>>().join(", "));
        for check in &record.checks {
            let value = check
                .value
                .or_else(|| record.measured.values.get(&check.name).copied());
            let _ = writeln!(
                text,
                "  {} {:<30} {:>14} {}",
                if check.passed { " " } else { "✗" },
                check.name,
                figure(value.unwrap_or(f64::NAN)),
                check
                    .bound
                    .map_or("not judged here".to_owned(), |bound| format!(
                        "≤ {}",
                        figure(bound)
                    )),
            );
        }
    }
    text
}

fn figure(value: f64) -> String {
    if value == value.trunc() {
        format!("{value:.0}")
    } else {
        format!("{value:.4}")
    }
}

/// The failed checks, and the commands that repeat them; `None` if nothing failed.
pub fn verdict(records: &[StormRecord]) -> Option<String> {
    let failed: Vec<String> = records
        .iter()
        .filter(|record| record.complete && !record.passed())
        .map(|record| {
            let names: Vec<&str> = record.failed().map(|check| check.name.as_str()).collect();
            format!(
                "{} in {} failed: {}\n  again: {}",
                record.storm,
                record.world,
                names.join(", "),
                record.repeat
            )
        })
        .collect();
    (!failed.is_empty()).then(|| failed.join("\n"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(value: f64) -> StormRecord {
        StormRecord {
            storm: "edit-storm".to_owned(),
            world: "cave".to_owned(),
            seed: 3,
            frames: 60,
            settling: 32,
            size: [64, 36],
            complete: true,
            changes: [("strokes", 9)].into(),
            checks: vec![Check::none("voxels.gpu_differs", value as u64)],
            repeat: "grotto stress --edit-storm".to_owned(),
            measured: Measured::default(),
        }
    }

    #[test]
    fn a_failed_check_is_named_with_the_command() {
        assert_eq!(verdict(&[record(0.0)]), None);
        let said = verdict(&[record(0.0), record(2.0)]).expect("one failed");
        assert!(said.contains("voxels.gpu_differs") && said.contains("grotto stress --edit-storm"));
        assert!(table(&[record(0.0)]).starts_with("passed"));
        assert!(table(&[record(2.0)]).starts_with("FAILED"));
        let stopped = StormRecord {
            complete: false,
            ..record(0.0)
        };
        assert!(!stopped.passed() && table(&[stopped]).starts_with("stopped"));
    }

    #[test]
    fn what_varies_is_only_under_measured() {
        let mut record = record(0.0);
        record.checks[0] =
            Check::at_most("soak.object_growth", 3.0, 16.0).measured(&mut record.measured.values);
        let json = serde_json::to_value(&record).expect("serialises");
        assert!(json["checks"][0]["value"].is_null());
        assert_eq!(json["measured"]["values"]["soak.object_growth"], 3.0);
    }
}
