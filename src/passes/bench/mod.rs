//! What no frame has: kernels that measure.

pub mod rays;
pub mod shadow_count;
