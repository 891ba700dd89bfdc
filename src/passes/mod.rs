//! One file a pass: its kernel, its own buffers, how it is recorded. Passes never import each
//! other; what several need lies here.

pub mod atlas_view;
pub mod camera_rays;
pub mod distances;
mod emitters;
pub mod face_blend;
pub mod face_mark;
pub mod face_rays;
mod face_table;
mod inspection;
mod lighting;
pub mod overlay;
pub mod path_trace;
pub mod probe_blend;
mod probe_changes;
pub mod probe_draw;
pub mod probe_due;
mod probe_field;
mod probe_info;
mod probe_level;
mod probe_plan;
pub mod probe_rays;
pub mod probe_seed;
pub mod probe_sight;
pub mod probe_states;
pub mod ray_bench;
mod scene;
mod schedule;
pub mod shade;
pub mod shadow_count;
pub mod state_view;
pub mod tonemap;
mod view;
pub mod voxelise;

pub use emitters::GpuEmitters;
pub use face_table::{FaceTable, GpuFaceInfo};
pub use inspection::{AtlasLayer, AtlasMap, Inspection, InspectionError, ProbeColour};
pub use lighting::{GpuLights, GpuMaterials};
pub use probe_changes::{GpuChanges, GpuEditSphere};
pub use probe_field::{ProbeField, ProbeFieldError};
pub use probe_info::GpuProbeInfo;
pub use probe_level::GpuProbeLevel;
pub use probe_plan::{GpuProbePlan, StateCounts};
pub use scene::{GpuVoxels, MemoryUse};
pub use schedule::{Schedule, Slice};
pub use view::{GpuView, View, ViewMode};
