//! Work on the GPU, by subject. A pass is one file here, one shader of the same folder and name, and one label:
//! `probes/trace` is `passes/probes/trace.rs`, `shaders/probes/trace.wesl`, and the name in all timings.
//!
//! Subjects never import each other. The frame passes the resources and kernel constants that one subject needs from
//! another, by name.

pub mod bench;
pub mod path_trace;
pub mod probes;
pub mod scene;
pub mod surface_cache;
pub mod view;
