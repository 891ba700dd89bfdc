//! Kernels that measure. No frame runs them.

pub mod rays;
pub mod shadow_count;
