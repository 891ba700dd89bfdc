//! Light of the faces that the camera sees, kept from frame to frame.

pub mod allocate;
mod cache;
pub mod resolve;
pub mod trace;

pub use cache::{GpuFaceHistory, GpuFaceQuarter, GpuSurfaceCacheInfo, NextFrame, SurfaceCache};
