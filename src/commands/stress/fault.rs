//! Faults planted on purpose. A check must find each of them: this proves that checks can fail.

use clap::ValueEnum;

/// A fault, planted into every scene of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Fault {
    /// A NaN in the stored light of the probes
    Nan,
    /// Probes light through walls.
    Leak,
    /// The distance of an empty cell of the grid, overstated.
    Distance,
    /// A buffer that is never dropped
    Buffer,
    /// A dispatch that takes longer than the limit
    Slow,
    /// A second rendering that differs from the first.
    Order,
}
