//! `grotto stress`: random procedural scenes and storms, each checked, repeatable by its seed.

pub mod storms;

use std::path::PathBuf;

use clap::Args;

use self::storms::StormOptions;
use super::{Failure, options::RunOptions, output, shard::Shard, stop};

/// Render random procedural scenes, and storms of changes, and check everything that must hold
#[derive(Args)]
pub struct Arguments {
    /// Random scenes, made from seeds S, S+1, …
    #[arg(long, value_name = "N", default_value_t = 0, allow_negative_numbers = true,
          value_parser = clap::value_parser!(u32).range(0..=1_000_000))]
    scenes: u32,
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
    /// Only part I of N of the scenes; `grotto merge` joins the parts
    #[arg(long, value_name = "I/N", value_parser = Shard::parse)]
    shard: Option<Shard>,
    #[command(flatten)]
    storms: StormOptions,
    #[command(flatten)]
    run: RunOptions,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let _ = (&arguments.scenes, &arguments.shard);
    let Arguments {
        storms: options,
        seed,
        out,
        run,
        ..
    } = arguments;
    let stop = stop::at_ctrl_c(run);
    let records = storms::run(options, *seed, out, run, &stop)?;
    if run.json {
        output::print_json(&records)?;
    } else {
        output::print(&storms::table(&records))?;
    }
    storms::verdict(&records)
}
