//! Pictures and statistics. Knows no world.

pub mod block_sums;
pub mod changes;
pub mod comparison;
pub mod flip;
pub mod frame_times;
pub mod magma;
pub mod metrics;
pub mod palette;
pub mod picture;
pub mod picture_file;
pub mod plot;
pub mod response;
pub mod scaling;
pub mod selection;
pub mod stability;
pub mod statistics;
pub mod thumbnail;
pub mod tonemap;
pub mod welch;
pub mod whole_file;
