//! grotto renders procedural voxel worlds with real-time global illumination.
//!
//! The module map: who may import whom (checked by `tests/house/`):
//!
//! ```text
//! world ← lights, probes ← reference
//! world, lights, probes, gpu ← passes ← frame ← app ← commands
//! ```
//!
//! `parameters` and `shared` (facts that shaders know too) are leaves that every module may import.
//! `measure` sees pictures, never a world.

pub mod app;
pub mod commands;
pub mod frame;
pub mod gpu;
pub mod lights;
pub mod measure;
pub mod parameters;
pub mod passes;
pub mod probes;
pub mod reference;
pub mod shared;
pub mod world;
