//! Pictures and statistics. Knows no world.

pub mod metrics;
pub mod picture;
pub mod picture_file;
pub mod statistics;
pub mod tonemap;
