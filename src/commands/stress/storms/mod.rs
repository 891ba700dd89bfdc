//! Storms: changes that come faster than any player makes them.

use clap::Args;

use super::super::{Failure, options::RunOptions};

/// Which storms, and how long each.
#[derive(Args)]
pub struct StormOptions {}

pub fn run(_options: &StormOptions, _seed: u32, _run: &RunOptions) -> Result<(), Failure> {
    Ok(())
}
