//! Storms: changes that come faster than any player makes them.

use clap::Args;

use super::super::{Failure, options::RunOptions};

/// Which storms, and how long each.
#[derive(Args)]
pub struct StormOptions {}

impl StormOptions {
    /// Whether any storm was asked for.
    pub fn any(&self) -> bool {
        false
    }
}

pub fn run(_options: &StormOptions, _seed: u32, _run: &RunOptions) -> Result<(), Failure> {
    Ok(())
}
