//! Probes: where they stand, how they look around, and how what they see is laid out. Knows no GPU.
//!
//! A [`Layout`] places probes in numbered slots. Everything else (rays, blending, the atlas, the
//! gather) is indexed by slot and knows nothing of how the slots lie in space.
//!
//! Units: a texel of an irradiance map stores Σ w L / Σ w with w = max(0, n·d), which is E/π;
//! radiance reflected by a diffuse surface is therefore albedo × texel. Distances are in voxels.

pub mod atlas;
pub mod changes;
pub mod octahedral;
pub mod sampling;
pub mod sight;
pub mod volume;

pub use atlas::AtlasLayout;
pub use changes::Changes;
pub use sight::Sight;
pub use volume::Volume;

use glam::Vec3;

/// Where probes stand. Slots are numbered from 0 and never move in memory.
pub trait Layout {
    /// How many probes there are.
    fn slots(&self) -> u32;

    /// World-space position of a probe: always the centre of a voxel, so that no probe lies on a
    /// face between stone and air.
    fn position(&self, slot: u32) -> Vec3;

    /// The probes that light a point, and their weights: each in [0, 1], together 1. A slot may
    /// occur more than once; its weights then add up.
    fn cage(&self, point_ws: Vec3) -> [(u32, f32); 8];
}

/// Why a probe layout cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ProbeError {
    #[error("probe layout `{layout}`: counts must be at least 1 on every axis, not {counts}")]
    NoProbes { layout: String, counts: String },
    #[error(
        "probe layout `{layout}`: spacing must be finite and above 0 on every axis, not {spacing}"
    )]
    Spacing { layout: String, spacing: String },
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
