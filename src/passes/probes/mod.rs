//! The field of probes: which probes are updated, what their rays find, and the maps that store it.

pub mod blend;
pub mod blend_distances;
mod changes;
pub mod classify;
pub mod cover;
mod field;
pub mod forget_hits;
mod info;
mod kept_hits;
mod level;
mod occlusion;
pub mod occlusion_blend;
pub mod occlusion_rays;
mod octree;
pub mod rhythms;
pub mod schedule;
pub mod seed;
mod source;
pub mod source_walk;
mod state;
pub mod trace;
mod update_schedule;
pub mod visibility;

pub use changes::{GpuChanges, GpuEditSphere};
pub use field::{ProbeField, ProbeFieldError};
pub use info::GpuProbeInfo;
pub use level::GpuProbeLevel;
pub use occlusion::{GpuOcclusion, GpuOcclusionValue, OcclusionField, OcclusionFrame};
pub use state::{GpuProbePlace, GpuProbeState, ProbeClass};
pub use update_schedule::{GpuUpdateSchedule, StateCounts};
