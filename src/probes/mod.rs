//! Probes: where they are, which rays they trace, and how their results are stored. Knows no GPU.
//!
//! A [`Layout`] places probes in numbered slots. Everything else (rays, blending, the atlas, the
//! gather) is indexed by slot and does not depend on how the slots lie in space.
//!
//! Units: a texel of an irradiance map stores Σ w L / Σ w with w = max(0, n·d), which is E/π; radiance
//! reflected by a diffuse surface is therefore albedo × texel. Distances are in voxels.

pub mod atlas;
pub mod changes;
mod level;
mod motion;
mod occlusion;
pub mod octahedral;
pub mod octree;
pub mod packed;
pub mod repeats;
pub mod sampling;
pub mod visibility_bits;
pub mod volume;
mod warmup;

pub use atlas::AtlasLayout;
pub use changes::Changes;
pub use level::Level;
pub use motion::Motion;
pub use occlusion::{MOST_VALUES, OcclusionLayout};
pub use octree::Octree;
pub use visibility_bits::{VisibilityBits, VisibilityBox};
pub use volume::Volume;
pub use warmup::warmup_frames;

use glam::Vec3;

/// Farthest that a probe inside a solid voxel moves along an axis, in spacings.
pub const MOVE_REACH: f32 = 0.95;

/// Where probes are. Slots are numbered from 0 and never move in memory.
pub trait Layout {
    /// Number of probes.
    fn slots(&self) -> u32;

    /// World-space position of a probe: always the centre of a voxel, so that no probe lies on a face
    /// between a solid voxel and air.
    fn position(&self, slot: u32) -> Vec3;

    /// The probes that light a point, and their weights: each in [0, 1], with sum 1. A slot may occur
    /// more than once; its weights then add up.
    fn cage(&self, point_ws: Vec3) -> Vec<(u32, f32)>;
}

/// Why a probe layout cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ProbeError {
    #[error("probe layout `{layout}`: counts must be at least 1 on every axis, not {counts}")]
    NoProbes { layout: String, counts: String },
    #[error("probe layout `{layout}`: `cascades` must be between 1 and {most}, not {cascades}")]
    Cascades {
        layout: String,
        cascades: u32,
        most: u32,
    },
    #[error(
        "probe layout `{layout}`: counts must be at least {least} on every axis, not {counts}, where \
         cascades fade into each other or the volume follows the camera"
    )]
    TooFew {
        layout: String,
        counts: String,
        least: u32,
    },
    #[error(
        "probe layout `{layout}`: spacing must be between {least} and {most} voxels on every axis, not \
         {spacing}"
    )]
    Spacing {
        layout: String,
        spacing: String,
        least: f32,
        most: f32,
    },
    #[error(
        "probe layout `{layout}` reaches {reach:.0} voxels from the origin; {most} are possible. Choose a \
         narrower spacing, or fewer probes or cascades."
    )]
    TooFar {
        layout: String,
        reach: f64,
        most: f32,
    },
    #[error(
        "probe layout `{layout}`: spacing must be a whole multiple of 2^{depth} voxels, so that an octree can halve it \
         {depth} times, not {spacing}"
    )]
    Halves {
        layout: String,
        spacing: String,
        depth: u32,
    },
    #[error(
        "probe layout `{layout}`: the finest lattice of an octree of depth {depth} would have {cells} cells; {most} are \
         possible. Lower `depth` or `counts`."
    )]
    TooDeep {
        layout: String,
        depth: u32,
        cells: u64,
        most: u64,
    },
    #[error(
        "probe layout `{layout}`: the octree of depth {depth} has more than {most} cells in this world. Lower `depth`, or \
         raise `divide_at`."
    )]
    Cells {
        layout: String,
        depth: u32,
        most: u32,
    },
    #[error("probe layout `{layout}`: centre must be finite, not {centre}")]
    Centre { layout: String, centre: String },
    #[error("probe layout `{layout}` has {slots} probes; at most {most} are possible")]
    TooMany {
        layout: String,
        slots: u64,
        most: u32,
    },
    #[error(
        "maps of {texels}×{texels} texels for {slots} probes do not fit the textures of this adapter \
         ({extent}² × {layers} layers). Lower `probes.distance_texels` or choose a smaller layout."
    )]
    Atlas {
        texels: u32,
        slots: u32,
        extent: u32,
        layers: u32,
    },
}
