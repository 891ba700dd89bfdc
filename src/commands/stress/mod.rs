//! `grotto stress`: random procedural scenes and storms, each checked, repeatable by its seed.

pub mod checks;
mod examine;
pub mod fault;
pub mod grammar;
pub mod known;
pub mod merge;
mod play;
pub mod report;
mod scene;
mod scenes;
mod shrink;
pub mod storms;
mod test_case;
mod watched;

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use self::{
    known::Known,
    report::Report,
    scenes::SceneOptions,
    storms::{StormOptions, StormRecord},
};
use super::{Failure, options::RunOptions, output, stop};

/// Render random procedural scenes, and storms of changes, and check everything that must hold
#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    scenes: SceneOptions,
    /// Seed of the first scene, and of the storms
    #[arg(
        long,
        value_name = "S",
        default_value_t = 0,
        allow_negative_numbers = true
    )]
    seed: u32,
    /// The folder for the report and for scenes that fail, created if it does not exist
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    storms: StormOptions,
    #[command(flatten)]
    run: RunOptions,
}

/// The results, as `--json` prints them: the report of the scenes, and the records of the storms.
#[derive(Serialize)]
struct Found<'a> {
    #[serde(flatten)]
    scenes: Option<&'a Report>,
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    storms: &'a [StormRecord],
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments {
        scenes: options,
        seed,
        out,
        storms: storm_options,
        run,
    } = arguments;
    let examines = options.scenes > 0 || options.world.is_some();
    if !examines && !storm_options.any() {
        return Err(Failure::bad_input(
            "there is nothing to do: --scenes N asks for N random scenes, --world FILE for one world; \
             `grotto stress --help` lists the storms",
        ));
    }
    let stop = stop::at_ctrl_c(run);
    let report = examines
        .then(|| scenes::run(options, *seed, out, run, Known::list(), &stop))
        .transpose()?;
    let is_stopped = report.as_ref().is_some_and(|report| !report.complete);
    let records = match storm_options.any() && !is_stopped {
        true => storms::run(storm_options, *seed, out, run, &stop)?,
        false => Vec::new(),
    };
    if run.json {
        output::print_json(&Found {
            scenes: report.as_ref(),
            storms: &records,
        })?;
    } else {
        let scenes = report.as_ref().map_or(String::new(), Report::text);
        let storms = match &records[..] {
            [] => String::new(),
            records => storms::table(records),
        };
        output::print(&(scenes + &storms))?;
    }
    if let Some(report) = &report {
        if !report.complete {
            return Err(Failure::interrupted(format!(
                "stopped: {} holds the first {} scenes and is marked incomplete",
                out.display(),
                report.examined
            )));
        }
        report.verdict()?;
    }
    storms::verdict(&records)
}
