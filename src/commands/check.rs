//! `grotto check`: reads world files and reports their contents, or their errors.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::{
    Failure,
    options::{OutputOptions, world_file},
    output,
};
use crate::world;

/// Validate world files
#[derive(Args)]
pub struct Arguments {
    /// World files (worlds/*.ron)
    #[arg(required = true, value_name = "WORLD", value_parser = world_file())]
    worlds: Vec<PathBuf>,
    #[command(flatten)]
    output: OutputOptions,
}

/// The `--json` output for all files.
#[derive(Serialize)]
struct Record {
    worlds: Vec<Checked>,
}

#[derive(Serialize)]
struct Checked {
    file: String,
    ok: bool,
    /// The contents or the errors, as readable text.
    text: String,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut failures = Vec::new();
    let mut record = Record { worlds: Vec::new() };
    for path in &arguments.worlds {
        let file = path.display().to_string();
        let (ok, text) = match world::file::check(path) {
            Ok(summary) => {
                if !arguments.output.json {
                    output::print(&format!("{file}: ok. {summary}\n"))?;
                }
                (true, summary.to_string())
            }
            Err(error) => {
                let failure = Failure::from(error);
                let text = failure.reason().to_owned();
                failures.push(failure);
                (false, text)
            }
        };
        record.worlds.push(Checked { file, ok, text });
    }
    if arguments.output.json {
        output::print_json(&record)?;
    }
    let (bad, all) = (failures.len(), arguments.worlds.len());
    match failures.pop() {
        None => Ok(()),
        Some(failure) if all == 1 => Err(failure),
        Some(last) => {
            for failure in failures.iter().chain([&last]) {
                eprintln!("{failure}");
            }
            Err(Failure::bad_input(format!(
                "{bad} of {all} files cannot be used as they are"
            )))
        }
    }
}
