//! `grotto check`: reads world files and says what is in them, or what is wrong.

use std::path::PathBuf;

use clap::Args;

use super::{Failure, output};
use crate::world;

/// Validate world files
#[derive(Args)]
pub struct Arguments {
    /// World files (worlds/*.ron)
    #[arg(required = true, value_name = "WORLD")]
    worlds: Vec<PathBuf>,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut failures = Vec::new();
    for path in &arguments.worlds {
        match world::file::check(path) {
            Ok(summary) => output::print(&format!("{}: ok. {summary}\n", path.display()))?,
            Err(error) => failures.push(Failure::from(error)),
        }
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
