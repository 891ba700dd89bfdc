//! The scene on the GPU: voxels, materials, lights, emissive faces.

mod bodies;
mod body_emitters;
mod body_facts;
mod body_lit_faces;
mod body_models;
mod body_poses;
mod body_records;
mod body_room;
mod body_supports;
pub mod distances;
mod emitters;
mod hierarchy;
pub mod lamp_lists;
mod lights;
mod materials;
pub mod publish_facts;
mod seen_lamps;
pub mod voxelise;
mod voxels;

pub use bodies::{BODIES, GpuBodies};
pub use emitters::GpuEmitters;
pub use lights::GpuLights;
pub use materials::GpuMaterials;
pub use seen_lamps::GpuSeenLampsHeader;
pub use voxels::{GpuVoxels, MemoryUse};
