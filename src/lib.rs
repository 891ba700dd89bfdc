//! grotto renders procedural voxel worlds with real-time global illumination.
//!
//! The map, and who may import whom (held by `tests/house/`):
//!
//! ```text
//! world ← lights, probes ← reference
//! world, lights, probes, gpu ← passes ← frame ← commands, app
//! ```
//!
//! `parameters` and `shared` (what shaders know too) are leaves that everyone may read. `measure` sees pictures, never
//! a world.

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
