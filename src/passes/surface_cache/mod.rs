//! Light of the faces that the camera sees, kept from frame to frame.

pub mod allocate;
pub mod body_cells;
pub mod body_lamps;
pub mod body_light;
pub mod body_shafts;
mod cache;
pub mod cell_shadows;
pub mod estimate;
pub mod gains;
pub mod lamps;
pub mod place_requested;
pub mod resolve;
mod shared;
pub mod trace;

pub use cache::{NextFrame, SurfaceCache};
pub use shared::{GpuFaceHistory, GpuFaceQuadrant, GpuSurfaceCacheInfo};
