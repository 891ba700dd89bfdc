//! Pictures and statistics. Knows no world.

pub mod metrics;
pub mod picture;
pub mod statistics;
