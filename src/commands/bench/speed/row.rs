//! Computes the figures of a row from its runs.

use std::collections::BTreeMap;

use super::{
    super::{
        super::{
            Failure,
            record::{ProbeCounts, median_passes, mrays_per_s},
        },
        model::{Adapter, Figure, Probes, Row, Timing},
        results::FrameSample,
    },
    rig::{Length, Rig, Run},
    spec::{RowSpec, changed},
};
use crate::{
    gpu::{Gpu, PassTimes},
    measure::{
        frame_times::{FrameStatistics, Interval},
        statistics::median,
    },
};

/// Most points of a row's curve.
const CURVE_POINTS: usize = 600;
/// Bars of a row's histogram.
const BARS: usize = 40;
/// A row is repeated until the half width of its median's interval is this share of the median.
const SURE: f64 = 0.01;

/// The runs of one row so far.
pub struct Measured {
    pub spec: RowSpec,
    runs: Vec<Run>,
    /// Known after the first run.
    facts: Option<Facts>,
}

/// Facts that are equal in every run.
struct Facts {
    rays: BTreeMap<String, u64>,
    probes: Probes,
    memory_bytes: BTreeMap<String, u64>,
}

/// Milliseconds of the frames that count: by the adapter's clock where it has one, and only those that were
/// timed as a whole, if there are any.
fn counted(samples: &[FrameSample]) -> Vec<f64> {
    let some_whole = samples.iter().any(|sample| !sample.by_pass);
    let counted = samples
        .iter()
        .filter(|sample| !some_whole || !sample.by_pass);
    counted
        .map(|sample| sample.gpu_ms.unwrap_or(sample.wall_ms))
        .collect()
}

impl Measured {
    pub fn new(spec: RowSpec) -> Self {
        Self {
            spec,
            runs: Vec::new(),
            facts: None,
        }
    }

    pub fn runs(&self) -> usize {
        self.runs.len()
    }

    /// Adds a run. The rig must be as the run left it.
    ///
    /// # Errors
    /// When the adapter fails.
    pub fn add(&mut self, run: Run, rig: &Rig<'_>) -> Result<(), Failure> {
        if self.facts.is_none() {
            self.facts = Some(Facts::of(rig, &self.spec)?);
        }
        self.runs.push(run);
        Ok(())
    }

    /// The last run's frames.
    pub fn last(&self) -> &[FrameSample] {
        self.runs.last().map_or(&[], |run| &run.samples)
    }

    /// Medians of the runs, in milliseconds.
    fn medians(&self) -> Vec<f64> {
        let medians = self.runs.iter().map(|run| median(&counted(&run.samples)));
        medians.flatten().collect()
    }

    /// Whether the median is known to ±1 %.
    pub fn is_sure(&self) -> bool {
        Interval::of(&self.medians()).is_some_and(|interval| interval.relative() <= SURE)
    }

    /// Whether even `most` runs would not make it sure, as far as the runs so far tell.
    pub fn is_hopeless(&self, most: usize) -> bool {
        /// Fewer runs say too little about their spread.
        const ENOUGH: usize = 10;
        let medians = self.medians();
        let hopeless = |interval: Interval| interval.relative_after(medians.len(), most) > SURE;
        medians.len() >= ENOUGH && Interval::of(&medians).is_some_and(hopeless)
    }

    /// The row with the runs so far; `None` before the first run.
    pub fn row(&self, gpu: &Gpu, length: Length, seed: u32, adapter: &Adapter) -> Option<Row> {
        let facts = self.facts.as_ref()?;
        let all: Vec<f64> = self
            .runs
            .iter()
            .flat_map(|run| counted(&run.samples))
            .collect();
        let frame_ms = FrameStatistics::of(&all)?;
        let passes: Vec<PassTimes> = self
            .runs
            .iter()
            .flat_map(|run| run.passes.clone())
            .collect();
        let passes = median_passes(&passes);
        let rates = facts.rays.iter().filter_map(|(kind, &count)| {
            // Shadow rays share their passes with other work, so no pass has their name.
            let pass = format!("{kind}_rays");
            let rate = mrays_per_s(Some(count), passes.get(&pass).copied())?;
            Some((kind.clone(), rate))
        });
        let timed = self.runs[0]
            .samples
            .iter()
            .any(|frame| frame.gpu_ms.is_some());
        let spec = &self.spec;
        let clock = if timed && !gpu.summary.is_software() {
            "gpu"
        } else {
            "wall"
        };
        Some(Row {
            frames: length.settling,
            timing: Some(self.timing(&frame_ms)?),
            fps: Some(frame_ms.fps()),
            frame_ms: Some(frame_ms),
            rays: facts.rays.clone(),
            mrays_per_s: rates.collect(),
            passes,
            probes: Some(facts.probes),
            memory_bytes: facts.memory_bytes.clone(),
            figures: self.edits(),
            ..blank(spec, seed, adapter, clock)
        })
    }

    /// The CPU's time for an edit; nothing where there are none.
    fn edits(&self) -> BTreeMap<String, Figure> {
        let edits: Vec<f64> = self
            .runs
            .iter()
            .flat_map(|run| &run.edits_ms)
            .copied()
            .collect();
        let Some(statistics) = FrameStatistics::of(&edits) else {
            return BTreeMap::new();
        };
        let figures = [
            ("edit_cpu_ms", statistics.median),
            ("edit_cpu_worst_ms", statistics.worst),
        ];
        figures
            .map(|(name, value)| {
                let figure = Figure {
                    value,
                    half_width: None,
                };
                (name.to_owned(), figure)
            })
            .into()
    }

    fn timing(&self, all: &FrameStatistics) -> Option<Timing> {
        let runs_ms = self.medians();
        let interval = Interval::of(&runs_ms)?;
        let of_all = |figure: fn(&FrameSample) -> f64| {
            let frames = self.runs.iter().flat_map(|run| &run.samples);
            FrameStatistics::of(&frames.map(figure).collect::<Vec<_>>())
        };
        let mut pass_runs_ms: BTreeMap<String, Vec<f64>> = BTreeMap::new();
        for run in &self.runs {
            for (pass, ms) in median_passes(&run.passes) {
                pass_runs_ms.entry(pass).or_default().push(ms);
            }
        }
        let middle = self.middle_run(all.median)?;
        let frames = counted(&middle.samples);
        // From the fastest frame to three medians; all longer frames go into the last bar.
        let fastest = frames.iter().copied().fold(f64::INFINITY, f64::min);
        let step = ((3.0 * all.median - fastest) / BARS as f64).max(f64::MIN_POSITIVE);
        let mut histogram = vec![0; BARS];
        for ms in self.runs.iter().flat_map(|run| counted(&run.samples)) {
            let bar = ((ms - fastest) / step).max(0.0) as usize;
            histogram[bar.min(BARS - 1)] += 1;
        }
        Some(Timing {
            noisy: interval.relative() > SURE,
            runs_ms,
            pass_runs_ms,
            interval,
            cpu_ms: of_all(|frame| frame.cpu_ms)?,
            wall_ms: of_all(|frame| frame.wall_ms)?,
            curve_ms: curve(&frames),
            histogram,
            histogram_from_ms: fastest,
            histogram_step_ms: step,
        })
    }

    /// The run whose median is nearest to the median of all runs.
    fn middle_run(&self, all: f64) -> Option<&Run> {
        let off = |run: &&Run| {
            let own = median(&counted(&run.samples)).unwrap_or(f64::INFINITY);
            (own - all).abs()
        };
        self.runs.iter().min_by(|a, b| off(a).total_cmp(&off(b)))
    }
}

/// The row of a spec before anything has been measured.
pub fn blank(spec: &RowSpec, seed: u32, adapter: &Adapter, clock: &str) -> Row {
    Row {
        id: spec.id.clone(),
        place: spec.place,
        suite: spec.suite.to_owned(),
        world: spec.world.clone(),
        camera: spec.camera.name.clone(),
        layout: Some(spec.layout.name.clone()),
        condition: spec.condition.clone(),
        view: "full".to_owned(),
        size: spec.size,
        frames: 0,
        seed,
        varied: spec.varied.clone(),
        set: changed(&spec.parameters),
        adapter: adapter.clone(),
        clock: clock.to_owned(),
        timing: None,
        fps: None,
        frame_ms: None,
        passes: BTreeMap::new(),
        rays: BTreeMap::new(),
        mrays_per_s: BTreeMap::new(),
        probes: None,
        memory_bytes: BTreeMap::new(),
        figures: BTreeMap::new(),
        quality: None,
    }
}

/// At most [`CURVE_POINTS`] values, each the worst of the frames that it represents.
fn curve(frames_ms: &[f64]) -> Vec<f32> {
    let stride = frames_ms.len().div_ceil(CURVE_POINTS).max(1);
    let worst = |chunk: &[f64]| chunk.iter().copied().fold(0.0, f64::max) as f32;
    frames_ms.chunks(stride).map(worst).collect()
}

impl Facts {
    fn of(rig: &Rig<'_>, spec: &RowSpec) -> Result<Self, Failure> {
        let (gpu, frame) = (rig.gpu, &rig.frame);
        let counts = ProbeCounts::read(gpu, frame.field())?;
        let [width, height] = frame.rendered_size().map(u64::from);
        let pixels = width * height;
        let probe_rays =
            u64::from(counts.updated) * u64::from(spec.parameters.probes.rays_per_update());
        let mut rays: BTreeMap<String, u64> = [
            ("camera".to_owned(), pixels),
            ("shadow".to_owned(), frame.count_shadow_rays(gpu, true)?),
            ("probe".to_owned(), probe_rays),
        ]
        .into();
        if frame.faces().is_used() {
            rays.insert("face".to_owned(), frame.faces().rays_sent(gpu)?);
        }
        let memory = frame.memory();
        Ok(Self {
            rays,
            probes: Probes {
                total: counts.total,
                alive: counts.alive,
                sleeping: counts.sleeping,
                dead: counts.dead,
                updated: counts.updated,
            },
            memory_bytes: [
                ("voxels".to_owned(), memory.voxels),
                ("probes".to_owned(), memory.probes),
                ("total".to_owned(), memory.total),
            ]
            .into(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(gpu_ms: f64, by_pass: bool) -> FrameSample {
        FrameSample {
            gpu_ms: Some(gpu_ms),
            cpu_ms: 0.1,
            wall_ms: gpu_ms + 0.2,
            by_pass,
        }
    }

    #[test]
    fn frames_that_were_timed_pass_by_pass_do_not_count_where_others_do() {
        let mixed = [sample(1.0, false), sample(9.0, true), sample(2.0, false)];
        assert_eq!(counted(&mixed), [1.0, 2.0]);
        assert_eq!(counted(&mixed[1..2]), [9.0]);
        let no_clock = FrameSample {
            gpu_ms: None,
            ..sample(1.0, false)
        };
        assert_eq!(counted(&[no_clock]), [1.2]);
    }

    #[test]
    fn a_curve_keeps_its_worst_frames() {
        let mut frames = vec![1.0; 1500];
        frames[1001] = 50.0;
        let curve = curve(&frames);
        assert_eq!(curve.len(), 500);
        assert_eq!(curve[333], 50.0);
        assert_eq!(curve.iter().filter(|&&ms| ms > 1.0).count(), 1);
    }
}
