//! From the camera's rays to the picture, and views of what lights it.

pub mod atlas_view;
pub mod camera_rays;
mod camera_view;
mod inspection;
pub mod overlay;
pub mod probe_draw;
pub mod shade;
pub mod state_view;
pub mod tonemap;

pub use camera_view::{GpuView, View, ViewMode};
pub use inspection::{AtlasLayer, AtlasMap, Inspection, InspectionError, ProbeColour};
