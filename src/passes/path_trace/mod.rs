//! The truth that probes are judged by, sample by sample.

mod blocks;
mod schedule;
mod sums;
pub mod trace;

pub use blocks::{Blocks, Sampled};
