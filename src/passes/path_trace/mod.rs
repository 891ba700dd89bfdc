//! The truth that probes are judged by, sample by sample.

mod schedule;
pub mod trace;

pub use schedule::{Chunk, Schedule};
