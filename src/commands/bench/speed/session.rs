//! One call of `grotto bench SUITE`: measures group after group, run after run, and adds to the report.

use std::{
    collections::{BTreeMap, btree_map::Entry},
    sync::atomic::AtomicBool,
    time::{Duration, Instant},
};

use base64::{Engine as _, prelude::BASE64_STANDARD};
use indicatif::ProgressBar;

use super::{
    super::{
        super::{EXIT_FAULT, EXIT_INTERRUPTED, Failure, output},
        model::{Adapter, Missing, Report, Row},
        results::{Files, FrameLog},
    },
    Arguments,
    machine::gpu_state,
    plan::{Group, Plan},
    quality::Judging,
    rig::{Length, Rig},
    row::Measured,
    runner::Common,
    spec::{Condition, RowSpec, Work},
};
use crate::{
    gpu::Gpu,
    measure::{
        statistics::median,
        thumbnail::{jpeg, reduced},
    },
};

/// Width in pixels of the pictures of worlds.
const PICTURE_WIDTH: u32 = 320;
/// Shortest time between two writings of the report.
const WRITE_INTERVAL: Duration = Duration::from_secs(10);
/// Frames of one step of the warm-up.
const WARM_UP: Length = Length {
    settling: 0,
    measured: 60,
};
/// The warm-up ends when two steps agree by this share …
const SETTLED: f64 = 0.005;
/// … but lasts at least LEAST, because clocks rise slowly, and not much longer than MOST.
const LEAST_WARM_UP: Duration = Duration::from_secs(1);
const MOST_WARM_UP: Duration = Duration::from_secs(6);

pub struct Session<'a> {
    pub gpu: &'a Gpu,
    pub adapter: &'a Adapter,
    pub arguments: &'a Arguments,
    pub plan: &'a Plan,
    pub judging: &'a Judging<'a>,
    pub stop: &'a AtomicBool,
    pub started: Instant,
    pub log: Option<FrameLog>,
    pub files: Option<&'a Files>,
    pub report: Report,
    pub bar: ProgressBar,
}

/// The worlds that are on the adapter, by index.
type Rigs<'a> = BTreeMap<usize, Rig<'a>>;

impl<'a> Session<'a> {
    /// Measures all groups.
    ///
    /// # Errors
    /// When the adapter fails, when the user stops the run, and when a file cannot be written. Rows that were
    /// measured by then are in the report.
    pub fn measure(&mut self) -> Result<(), Failure> {
        let mut rigs = Rigs::new();
        let plan = self.plan;
        if !self.gpu.features.contains(wgpu::Features::TIMESTAMP_QUERY) {
            output::note(
                &self.arguments.run,
                "note: this adapter has no timestamps: frames are timed by the wall clock",
            );
        }
        self.warm_up(&mut rigs)?;
        let mut written = Instant::now();
        for group in &plan.groups {
            self.group(group, &mut rigs, &mut written)?;
        }
        Ok(())
    }

    /// Closes the report and writes it for the last time.
    ///
    /// # Errors
    /// When a file cannot be written, as on a full disk.
    pub fn finish(mut self, measured: &Result<(), Failure>) -> Result<Report, Failure> {
        self.bar.finish_and_clear();
        self.report.complete = measured.is_ok();
        self.report.machine.gpu_after = gpu_state(&self.gpu.summary);
        self.write()?;
        if let Some(log) = self.log.take() {
            log.finish()?;
        }
        Ok(self.report)
    }

    fn write(&mut self) -> Result<(), Failure> {
        self.report.elapsed_s = self.started.elapsed().as_secs_f64();
        self.files.map_or(Ok(()), |files| files.write(&self.report))
    }

    /// Renders the first row's frames until they take as long as the previous ones.
    fn warm_up(&mut self, rigs: &mut Rigs<'a>) -> Result<(), Failure> {
        let mut rows = self.plan.groups.iter().flat_map(|group| &group.rows);
        let first = rows.find(|row| matches!(row.work, Work::Frames(_)));
        let (Some(spec), false) = (first, self.gpu.summary.is_software()) else {
            self.report.machine.warm_up = "none".to_owned();
            return Ok(());
        };
        let rig = self.rig(rigs, spec)?;
        let start = Instant::now();
        let mut before = f64::INFINITY;
        let mut frames = 0;
        loop {
            let run = rig.run(spec, Condition::Still, WARM_UP)?;
            frames += run.samples.len();
            let times: Vec<f64> = run
                .samples
                .iter()
                .filter_map(|sample| sample.gpu_ms)
                .collect();
            let now = median(&times).unwrap_or_default();
            let settled = (now - before).abs() <= SETTLED * now;
            before = now;
            let elapsed = start.elapsed();
            if (settled && elapsed >= LEAST_WARM_UP) || elapsed >= MOST_WARM_UP {
                self.report.machine.warm_up = format!(
                    "{frames} frames of the first row in {:.1} s, {}",
                    elapsed.as_secs_f64(),
                    if settled {
                        "until sixty took as long as the sixty before (within 0.5 %)"
                    } else {
                        "whose times never agreed"
                    }
                );
                return Ok(());
            }
        }
    }

    fn rig<'r>(&self, rigs: &'r mut Rigs<'a>, spec: &RowSpec) -> Result<&'r mut Rig<'a>, Failure> {
        match rigs.entry(spec.scene) {
            Entry::Occupied(known) => Ok(known.into_mut()),
            Entry::Vacant(place) => {
                let scene = &self.plan.scenes[spec.scene];
                let start = (self.arguments.seed, self.arguments.time);
                Ok(place.insert(Rig::new(self.gpu, scene, spec, start, self.stop)?))
            }
        }
    }

    /// The rows of a group: each run is made for all rows before the next run of any row.
    fn group(
        &mut self,
        group: &Group,
        rigs: &mut Rigs<'a>,
        written: &mut Instant,
    ) -> Result<(), Failure> {
        let (least, most) = Plan::runs(self.arguments);
        let mut frames: Vec<Measured> = Vec::new();
        let first_row = self.report.rows.len();
        for spec in &group.rows {
            if matches!(spec.work, Work::Frames(_)) {
                frames.push(Measured::new(spec.clone()));
            } else {
                let rows = self.other(spec, rigs);
                self.keep(&spec.id, rows)?;
                self.bar.inc(1);
            }
        }
        let others = self.report.rows.len();
        let mut failed = vec![false; frames.len()];
        for round in 0..most {
            let mut any = false;
            let mut ended = Ok(());
            for (index, measured) in frames.iter_mut().enumerate() {
                let more = !measured.is_sure() && !measured.is_hopeless(most);
                let unsure = round < least || more;
                if failed[index] || !unsure {
                    continue;
                }
                any = true;
                if round >= least {
                    self.bar.inc_length(1);
                }
                if let Err(failure) = self.one_run(measured, rigs) {
                    failed[index] = true;
                    ended = self.keep(&measured.spec.id, Err(failure));
                    if ended.is_err() {
                        break;
                    }
                }
                self.bar.inc(1);
            }
            self.report.rows.truncate(others);
            let rows = frames.iter().filter_map(|measured| self.row(measured));
            let rows: Vec<Row> = rows.collect();
            self.report.rows.extend(rows);
            // Checked only now, so that a stopped run keeps the rows of its last round.
            ended?;
            if written.elapsed() >= WRITE_INTERVAL {
                self.write()?;
                *written = Instant::now();
            }
            if !any {
                break;
            }
        }
        if self.arguments.quality {
            for index in first_row..self.report.rows.len() {
                self.judge_row(index, &frames, rigs)?;
            }
        }
        Ok(())
    }

    /// One run of a row, into the log and the row.
    fn one_run(&mut self, measured: &mut Measured, rigs: &mut Rigs<'a>) -> Result<(), Failure> {
        let Work::Frames(condition) = measured.spec.work else {
            return Ok(());
        };
        let length = self.plan.length(&measured.spec, self.arguments);
        let rig = self.rig(rigs, &measured.spec)?;
        let run = rig.run(&measured.spec, condition, length)?;
        measured.add(run, rig)?;
        let known = |hash: &str| self.report.worlds.iter().any(|world| world.hash == hash);
        if !known(&rig.scene.hash) {
            let mut record = rig.scene.record();
            let picture = reduced(&rig.frame.read_display(self.gpu)?, PICTURE_WIDTH);
            let data = BASE64_STANDARD.encode(jpeg(&picture));
            record.picture = Some(format!("data:image/jpeg;base64,{data}"));
            self.report.worlds.push(record);
        }
        if let Some(log) = &mut self.log {
            let run = measured.runs() as u32 - 1;
            log.run(&measured.spec.id, run, measured.last())?;
        }
        Ok(())
    }

    fn row(&self, measured: &Measured) -> Option<Row> {
        let length = self.plan.length(&measured.spec, self.arguments);
        measured.row(self.gpu, length, self.arguments.seed, self.adapter)
    }

    /// The rows of a spec that times no frames.
    fn other(&mut self, spec: &RowSpec, rigs: &mut Rigs<'a>) -> Result<Vec<Row>, Failure> {
        let common = Common {
            gpu: self.gpu,
            adapter: self.adapter,
            asked: self.arguments.run.adapter.as_deref(),
            seed: self.arguments.seed,
            judging: self.judging,
            quick: self.arguments.quick,
            settled: self.settled(spec),
            runs: self.arguments.runs.unwrap_or(1),
            length: self.plan.length(spec, self.arguments),
        };
        let scene = &self.plan.scenes[spec.scene];
        if !self
            .report
            .worlds
            .iter()
            .any(|world| world.hash == scene.hash)
        {
            self.report.worlds.push(scene.record());
        }
        match spec.work {
            Work::Build | Work::Start | Work::Traversal => common.without_rig(spec, scene),
            _ => Ok(vec![common.with_rig(spec, self.rig(rigs, spec)?)?]),
        }
    }

    /// Frames of a start after which light counts as settled.
    fn settled(&self, spec: &RowSpec) -> u32 {
        /// For a world of ordinary size: its surface cache has settled by then.
        const SETTLED: u32 = 400;
        let length = self.plan.length(spec, self.arguments);
        let ordinary = match self.arguments.quick || self.plan.is_large(spec) {
            true => length.settling,
            false => SETTLED,
        };
        self.arguments.frames.unwrap_or(ordinary)
    }

    /// Adds rows, or notes why there are none. Returns only errors that end the whole run.
    fn keep(&mut self, id: &str, rows: Result<Vec<Row>, Failure>) -> Result<(), Failure> {
        match rows {
            Ok(rows) => self.report.rows.extend(rows),
            Err(failure) if failure.exit_code() == EXIT_INTERRUPTED => return Err(failure),
            Err(failure) if failure.exit_code() == EXIT_FAULT => return Err(failure),
            Err(failure) => {
                let text = format!("{id} is left out: {}", failure.reason());
                output::note(&self.arguments.run, &text);
                self.report.missing.push(Missing {
                    id: id.to_owned(),
                    reason: failure.reason().to_owned(),
                });
            }
        }
        Ok(())
    }

    /// Judges the light of a row, if its picture does not move.
    fn judge_row(
        &mut self,
        index: usize,
        frames: &[Measured],
        rigs: &mut Rigs<'a>,
    ) -> Result<(), Failure> {
        let id = &self.report.rows[index].id;
        let still = Work::Frames(Condition::Still);
        let mut found = frames.iter().map(|measured| &measured.spec);
        let Some(spec) = found.find(|spec| spec.id == *id && spec.work == still) else {
            return Ok(());
        };
        let judging = self.judging;
        let rig = self.rig(rigs, spec)?;
        self.report.rows[index].quality = Some(judging.quality(rig, spec)?);
        Ok(())
    }
}
