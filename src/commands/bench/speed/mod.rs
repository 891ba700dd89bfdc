//! The suites that time frames: frame rates by layout, rays, lamps and everything else that costs time.
//!
//! Every run starts with fresh probes, which settle first. Runs of the rows of a suite are interleaved, so that
//! changes of the machine meanwhile affect all rows alike. Frames are neither presented nor paced.

mod arguments;
mod machine;
mod motion;
mod occlusion;
mod plan;
mod probe_figures;
mod probe_tables;
mod quality;
mod rig;
mod row;
mod runner;
mod session;
mod spec;
pub mod start;
mod suites;
mod tables;

pub use self::{arguments::Arguments, plan::SpeedSuite};

use std::time::{Instant, SystemTime};

use self::{
    machine::{adapter, build, machine},
    plan::Plan,
    quality::Judging,
    session::Session,
};
use super::{
    super::{Failure, judge::cache::Cache, options::note_restored, output, shard::Shard, stop},
    model::{KIND, Report, SCHEMA},
    results::{Files, summary},
};

/// Measures a suite.
///
/// # Errors
/// For bad input, before anything is measured, and when the run is stopped: the rows finished by then are on the
/// disk.
pub fn run(suite: SpeedSuite, arguments: &Arguments) -> Result<(), Failure> {
    let run = &arguments.run;
    let plan = Plan::new(suite, arguments)?;
    for scene in &plan.scenes {
        note_restored(run, &scene.world);
    }
    let files = arguments
        .out
        .as_deref()
        .map(|folder| Files::new(folder, arguments.overwrite))
        .transpose()?;
    let stop = stop::at_ctrl_c(run);
    let gpu = output::open_gpu(run)?;
    let summary_of_adapter = adapter(&gpu.summary);
    let cache = Cache::new(arguments.cache.as_deref());
    let judging = Judging {
        cache: &cache,
        run,
        stop: &stop,
        spp: arguments.spp,
        settling: arguments.frames,
    };
    let report = Report {
        kind: KIND.to_owned(),
        schema: SCHEMA,
        suite: suite.name().to_owned(),
        complete: false,
        quick: arguments.quick,
        shard: arguments.shard.unwrap_or(Shard::WHOLE),
        command: std::env::args().skip(1).collect(),
        started: humantime::format_rfc3339_seconds(SystemTime::now()).to_string(),
        elapsed_s: 0.0,
        build: build(),
        machine: machine(&gpu.summary),
        worlds: Vec::new(),
        rows: Vec::new(),
        missing: plan.missing.clone(),
        parts: Vec::new(),
    };
    let mut session = Session {
        gpu: &gpu,
        adapter: &summary_of_adapter,
        arguments,
        plan: &plan,
        judging: &judging,
        stop: &stop,
        started: Instant::now(),
        log: files
            .as_ref()
            .map(|files| files.frame_log(&gpu.summary.name))
            .transpose()?,
        files: files.as_ref(),
        report,
        bar: output::progress(run, "runs", plan.least_runs(arguments)),
    };
    let measured = session.measure();
    let report = session.finish(&measured)?;
    if run.json {
        output::print_json(&report)?;
    } else {
        output::print(&summary(&report))?;
    }
    measured
}
