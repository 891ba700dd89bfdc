//! What `grotto bench` writes: one report, versioned, read again by `diff`, `history` and `merge`.
//! `docs/bench.md` documents every key.

use std::{collections::BTreeMap, fs, io, path::Path};

use serde::{Deserialize, Serialize};

use super::super::{Failure, shard::Shard};
use crate::measure::frame_times::{FrameStatistics, Interval};

/// Raised when a key changes its meaning or is removed; readers refuse newer schemas.
pub const SCHEMA: u32 = 1;
/// Says what kind of file a report is.
pub const KIND: &str = "grotto bench";
/// The file of the report in its folder, beside `rows.csv`, `frames.csv.gz` and `index.html`.
pub const FILE: &str = "bench.json";

/// Everything that one call of `grotto bench` has measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// [`KIND`].
    pub kind: String,
    /// [`SCHEMA`] of the grotto that wrote it.
    pub schema: u32,
    pub suite: String,
    /// Whether all rows are present: false while rows are left, and when the run was stopped.
    pub complete: bool,
    /// Whether `--quick` reduced everything.
    pub quick: bool,
    pub shard: Shard,
    /// The command line after the program's name.
    pub command: Vec<String>,
    /// Start of the run: UTC, RFC 3339.
    pub started: String,
    pub elapsed_s: f64,
    pub build: Build,
    pub machine: Machine,
    pub worlds: Vec<WorldRecord>,
    pub rows: Vec<Row>,
    /// Rows that could not be measured, and why.
    pub missing: Vec<Missing>,
    /// The reports that `grotto bench merge` put side by side; empty for a single call.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<Part>,
}

/// One of several reports on one page: a card, or a machine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Part {
    /// Suffix after `@` in the ids of its rows.
    pub label: String,
    pub suite: String,
    pub complete: bool,
    pub quick: bool,
    pub command: Vec<String>,
    pub started: String,
    pub elapsed_s: f64,
    pub build: Build,
    pub machine: Machine,
}

/// The build of grotto that measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Build {
    pub version: String,
    /// Short hash, with `+changes` where the sources differed from the commit.
    pub commit: String,
    /// `release` or `debug`.
    pub profile: String,
}

/// The machine that a run used. The adapter is separate: every row names its own.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    pub cpu: String,
    pub cores: u32,
    pub memory_bytes: u64,
    pub os: String,
    /// How the GPU was warmed up, in words.
    pub warm_up: String,
    /// State before the first row and after the last; `null` where the system does not report it.
    pub gpu_before: Option<GpuState>,
    pub gpu_after: Option<GpuState>,
}

/// Clocks and power of the adapter at one moment.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct GpuState {
    pub graphics_mhz: Option<u32>,
    pub memory_mhz: Option<u32>,
    pub power_w: Option<f64>,
    pub temperature_c: Option<u32>,
}

/// The adapter of a row.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Adapter {
    pub name: String,
    /// `discrete`, `integrated`, `software`, `virtual` or `other`.
    pub kind: String,
    pub driver: String,
    pub backend: String,
}

/// A world that rows use.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WorldRecord {
    pub name: String,
    pub title: String,
    /// Hash of the world as it was read, file and overrides: 32 hexadecimal digits.
    pub hash: String,
    pub seed: u32,
    /// Extent in voxels.
    pub size: [u32; 3],
    /// The view of the first row's camera, as a `data:` URI; `null` where no picture was made.
    pub picture: Option<String>,
}

/// One thing that was measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Unique in a report, the same from run to run: `layouts/cave/layout1/moving`. `diff` joins rows by it.
    pub id: String,
    /// Its position in the plan of the whole run, counted from 0: parts made by `--shard` are joined in this
    /// order.
    #[serde(default)]
    pub place: u32,
    /// The suite that the row belongs to; a report of `all` has rows of many.
    pub suite: String,
    pub world: String,
    pub camera: String,
    /// `null` where no probes were used.
    pub layout: Option<String>,
    /// `still`, `moving`, `flight`, `edits`, or what the suite calls it.
    pub condition: String,
    /// As `--view` spells it.
    pub view: String,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Settling frames before each run.
    pub frames: u32,
    pub seed: u32,
    /// The values that the suite varies, by parameter: `probes.rays` → 8.
    pub varied: BTreeMap<String, Varied>,
    /// Parameters that differ from their defaults, as `--set` takes them.
    pub set: Vec<String>,
    pub adapter: Adapter,
    /// `gpu` (two stamps a frame), or `wall` where the adapter has no timestamps or is a CPU.
    pub clock: String,
    /// `null` where the row is not about frames; then `figures` says what it is about.
    pub timing: Option<Timing>,
    /// Frames per second at the median; `null` where `timing` is.
    pub fps: Option<f64>,
    /// Frame times by `clock`, over all runs; `null` where `timing` is.
    pub frame_ms: Option<FrameStatistics>,
    /// Median milliseconds of each pass, from the frames that were timed pass by pass.
    pub passes: BTreeMap<String, f64>,
    /// Rays in one frame, by kind.
    pub rays: BTreeMap<String, u64>,
    pub mrays_per_s: BTreeMap<String, f64>,
    pub probes: Option<Probes>,
    /// Under `voxels`, `probes` and `total`.
    pub memory_bytes: BTreeMap<String, u64>,
    /// Other measurements, under names that end with their unit: `voxelise_ms`.
    pub figures: BTreeMap<String, Figure>,
    /// Error against the path-traced reference; `null` without `--quality`, and where the picture moves.
    pub quality: Option<Quality>,
}

/// How a row's frames were timed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Timing {
    /// Median milliseconds of each run, in the order in which they ran.
    pub runs_ms: Vec<f64>,
    /// 95 % interval of the median of `runs_ms`.
    pub interval: Interval,
    /// Median milliseconds of each pass in each run, in the order of `runs_ms`, by the pass's name. `diff` uses
    /// their spread to decide whether a pass has changed. Empty where passes were not timed in every run.
    #[serde(default)]
    pub pass_runs_ms: BTreeMap<String, Vec<f64>>,
    /// Whether the interval was still wider than ±1 % of the median after the largest number of runs.
    pub noisy: bool,
    /// CPU time of recording and submitting a frame, milliseconds.
    pub cpu_ms: FrameStatistics,
    /// Milliseconds from one frame to the next: what a player would see without waiting for a display.
    pub wall_ms: FrameStatistics,
    /// Milliseconds of the frames of the run in the middle, in order, for curves. There are at most 600 values;
    /// in longer runs each value is the worst of several frames.
    pub curve_ms: Vec<f32>,
    /// Frames by their time, in equal steps of `histogram_step_ms` from `histogram_from_ms` on. The last step
    /// contains all longer frames.
    pub histogram: Vec<u32>,
    pub histogram_from_ms: f64,
    pub histogram_step_ms: f64,
}

/// A value that a suite varies.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Varied {
    Number(f64),
    Text(String),
}

/// A figure other than a frame time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Figure {
    pub value: f64,
    /// Half of the width of the 95 % interval; `null` for counts and for figures that were measured once.
    pub half_width: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Probes {
    pub total: u32,
    pub alive: u32,
    pub sleeping: u32,
    pub dead: u32,
    /// Probes updated in the last frame.
    #[serde(alias = "due")]
    pub updated: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quality {
    /// Mean FLIP of the displayed picture.
    pub flip: f64,
    /// Energy of the bounced light relative to the reference's; `null` where the reference has none.
    pub energy: Option<f64>,
    /// Paths per pixel of the reference.
    pub spp: u32,
    /// Width and height in pixels of the judged picture, which may be smaller than the row's.
    pub size: [u32; 2],
}

/// A row that could not be measured.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Missing {
    pub id: String,
    pub reason: String,
}

impl Report {
    /// Reads a report: its file, or the folder that holds it.
    ///
    /// # Errors
    /// For reports that are missing, damaged, foreign or newer, with the path and the remedy.
    pub fn read(path: &Path) -> Result<Self, Failure> {
        let file = if path.is_dir() {
            path.join(FILE)
        } else {
            path.to_owned()
        };
        let shown = file.display();
        let text = fs::read_to_string(&file).map_err(|reason| match reason.kind() {
            io::ErrorKind::NotFound => Failure::bad_input(format!(
                "{shown}: no such file; name a folder that `grotto bench` wrote, or its {FILE}"
            )),
            _ => Failure::unread(&file, reason),
        })?;
        let value: serde_json::Value = serde_json::from_str(&text).map_err(|error| {
            Failure::bad_input(format!(
                "{shown} is damaged: {error}; measure it again with `grotto bench`"
            ))
        })?;
        if value.get("kind").and_then(|kind| kind.as_str()) != Some(KIND) {
            return Err(Failure::bad_input(format!(
                "{shown} is not a report of `grotto bench`"
            )));
        }
        match value.get("schema").and_then(serde_json::Value::as_u64) {
            Some(schema) if schema == u64::from(SCHEMA) => {}
            Some(schema) if schema > u64::from(SCHEMA) => {
                return Err(Failure::bad_input(format!(
                    "{shown} has schema {schema}, and this grotto reads {SCHEMA}: read it with the grotto \
                     that wrote it, or a newer one"
                )));
            }
            _ => {
                return Err(Failure::bad_input(format!(
                    "{shown} has a schema that this grotto ({SCHEMA}) no longer reads: measure it again"
                )));
            }
        }
        serde_json::from_value(value).map_err(|error| {
            Failure::bad_input(format!(
                "{shown} is damaged: {error}; measure it again with `grotto bench`"
            ))
        })
    }
}

impl Report {
    /// The part that a row of a merged report belongs to.
    fn part_of(&self, row: &Row) -> Option<&Part> {
        let (_, label) = row.id.rsplit_once('@')?;
        self.parts.iter().find(|part| part.label == label)
    }

    /// The machine that measured a row.
    pub fn machine_of(&self, row: &Row) -> &Machine {
        self.part_of(row)
            .map_or(&self.machine, |part| &part.machine)
    }

    /// The build that measured a row.
    pub fn build_of(&self, row: &Row) -> &Build {
        self.part_of(row).map_or(&self.build, |part| &part.build)
    }
}

impl Row {
    /// The figure that rows are compared by, with its 95 % interval: median milliseconds of a frame, or the
    /// first figure. `None` for a row that has neither.
    pub fn headline(&self) -> Option<(&str, Figure)> {
        if let (Some(timing), Some(frame)) = (&self.timing, &self.frame_ms) {
            let figure = Figure {
                value: frame.median,
                half_width: timing.interval.half_width,
            };
            return Some(("frame_ms", figure));
        }
        let first = self.figures.first_key_value();
        first.map(|(name, figure)| (name.as_str(), *figure))
    }

    /// Whether the median is still uncertain after the largest number of runs.
    pub fn is_noisy(&self) -> bool {
        self.timing.as_ref().is_some_and(|timing| timing.noisy)
    }

    pub fn is_software(&self) -> bool {
        self.adapter.kind == "software"
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use serde_json::Value;

    use super::super::made_up::full_report;

    const DOCUMENT: &str = include_str!("../../../docs/bench.md");
    /// Names under these keys are free, and not part of the schema.
    const FREE: [&str; 7] = [
        "varied",
        "passes",
        "pass_runs_ms",
        "rays",
        "mrays_per_s",
        "memory_bytes",
        "figures",
    ];

    /// All keys of the schema. `free` says that the keys of this object are not part of it.
    fn collect(value: &Value, free: bool, keys: &mut BTreeSet<String>) {
        match value {
            Value::Object(members) => {
                for (key, value) in members {
                    if !free {
                        keys.insert(key.clone());
                    }
                    // Below a free name there are keys of the schema again.
                    collect(value, !free && FREE.contains(&key.as_str()), keys);
                }
            }
            Value::Array(values) => values.iter().for_each(|value| collect(value, false, keys)),
            _ => {}
        }
    }

    #[test]
    fn every_key_is_documented() {
        let report = serde_json::to_value(full_report()).expect("JSON");
        let mut keys = BTreeSet::new();
        collect(&report, false, &mut keys);
        for known in [
            "low1_integral_fps",
            "half_width",
            "graphics_mhz",
            "spp",
            "label",
            "reason",
        ] {
            assert!(keys.contains(known), "{known} is not found: {keys:?}");
        }
        let documented = |key: &&String| DOCUMENT.contains(&format!("`{key}`"));
        let missing: Vec<&String> = keys.iter().filter(|key| !documented(key)).collect();
        assert!(
            missing.is_empty(),
            "docs/bench.md does not name {missing:?}"
        );
        assert!(!documented(&&"no_such_key".to_owned()));
    }
}
