//! Pictures and statistics. Knows no world.

pub mod comparison;
pub mod flip;
pub mod magma;
pub mod metrics;
pub mod picture;
pub mod picture_file;
pub mod selection;
pub mod statistics;
pub mod tonemap;
