//! Faults planted on purpose, each of which a check must find: the proof that checks can fail.

use clap::ValueEnum;

/// One fault, planted into every scene of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Fault {
    /// A NaN in what the probes remember.
    Nan,
    /// Probes light through walls.
    Leak,
    /// The distance of an empty cell of the grid, overstated.
    Distance,
    /// A buffer that is never dropped.
    Buffer,
    /// A dispatch that takes longer than any may.
    Slow,
    /// A second rendering that differs from the first.
    Order,
}
