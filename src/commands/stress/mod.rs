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
mod storms;
mod subject;
mod watched;

use std::path::PathBuf;

use clap::Args;

use self::{known::Known, scenes::SceneOptions, storms::StormOptions};
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
    /// The folder for the report and for scenes that fail, made if need be
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    storms: StormOptions,
    #[command(flatten)]
    run: RunOptions,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments {
        scenes: options,
        seed,
        out,
        storms,
        run,
    } = arguments;
    let examines = options.scenes > 0 || options.world.is_some();
    if !examines && !storms.any() {
        return Err(Failure::bad_input(
            "there is nothing to do: --scenes N asks for N random scenes, --world FILE for one world; \
             `grotto stress --help` lists the storms",
        ));
    }
    if examines {
        let stop = stop::at_ctrl_c(run);
        let report = scenes::run(options, *seed, out, run, Known::list(), &stop)?;
        if run.json {
            output::print_json(&report)?;
        } else {
            output::print(&report.text())?;
        }
        if !report.complete {
            return Err(Failure::interrupted(format!(
                "stopped: {} holds the first {} scenes, and says that there were to be more",
                out.display(),
                report.examined
            )));
        }
        report.verdict()?;
    }
    storms::run(storms, *seed, run)
}
