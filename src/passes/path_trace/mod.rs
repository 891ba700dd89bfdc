//! The path tracer, whose pictures are the ground truth for the probes.

mod blocks;
mod schedule;
mod sums;
pub mod trace;

pub use blocks::{Blocks, Sampled};
