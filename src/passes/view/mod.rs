//! From the camera's rays to the picture, and views of the probes that light it.

pub mod antialias;
pub mod atlas_view;
pub mod bits;
mod body_tiles;
pub mod camera_rays;
mod display;
mod inspection;
pub mod overlay;
pub mod probe_draw;
pub mod shade;
mod shot;
pub mod state_view;
pub mod tonemap;

pub use display::Display;
pub use inspection::{AtlasLayer, AtlasMap, Inspection, InspectionError, ProbeColour};
pub use shot::{GpuShot, Shot};
