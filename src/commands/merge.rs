//! `grotto merge`: joins what `--shard I/N` of stress, judge, reference and bench wrote.

use std::path::PathBuf;

use clap::Args;

use super::{Failure, options::RunOptions};

/// Join the parts that --shard I/N of stress, judge, reference or bench wrote
#[derive(Args)]
pub struct Arguments {
    /// The folders of the parts, in any order
    #[arg(value_name = "DIR", required = true)]
    parts: Vec<PathBuf>,
    /// The folder for the whole, made if need be
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    run: RunOptions,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let _ = (&arguments.parts, &arguments.out, &arguments.run);
    Err(Failure::bad_input("there is nothing to join"))
}
