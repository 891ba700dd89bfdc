//! What every pass knows of the probe field.

use super::{GpuProbeLevel, ProbeField, level::LEVELS};
use crate::{
    parameters::{ProbeParameters, Relocation},
    probes::{Layout as _, MOVE_REACH, VisibilityBits},
};

crate::shared! {
    in probes;

    /// What every pass knows of the probe field.
    pub struct GpuProbeInfo as ProbeInfo {
        /// The finest first.
        pub levels: [GpuProbeLevel; LEVELS],
        /// Probes of each level along each axis.
        pub counts: [u32; 3],
        pub slots: u32,
        pub level_count: u32,
        /// Probes of each level.
        pub level_slots: u32,
        /// Rays that an update traces.
        pub rays: u32,
        /// log2 of the tiles in a row of the atlas, and of the rows in a layer.
        pub columns_log2: u32,
        pub rows_log2: u32,
        /// Texels along a map, without its border.
        pub irradiance_texels: f32,
        pub distance_texels: f32,
        pub normal_bias: f32,
        pub hysteresis: f32,
        pub warmup_frames: u32,
        pub firefly_clamp: f32,
        /// Farthest along an axis that a probe in a solid voxel moves, in spacings; 0: probes stay on the lattice.
        pub move_reach: f32,
        /// Slots of all levels; the back-side probe of slot s is s + lattice_slots.
        pub lattice_slots: u32,
        /// Words of `probe_visibility` before those of the back-side probes.
        pub visibility_lattice_words: u32,
        /// A probe that misses more than this share of the surfaces in its cages gets a back-side probe; 1: none does.
        pub back_side_share: f32,
        /// Rays of a probe that the buffers have room for.
        pub ray_room: u32,
        /// Corners of a cage: 8. A loop that ends here is not unrolled, for compilers do not know the number.
        pub cage_corners: u32,
        pub _pad: [u32; 3],
    }
}

/// A probe that misses more than this share of the surfaces in its cages gets a back-side probe.
const BACK_SIDE_SHARE: f32 = 0.1;

/// Share of history that an update keeps when no lamp and no voxel has changed for long: more noise is averaged away.
const STILL_HYSTERESIS: f32 = 0.998;

/// Largest share of its history that a probe keeps. It rises when nothing has changed for long.
fn hysteresis(parameters: &ProbeParameters, stillness: f32) -> f32 {
    let still = STILL_HYSTERESIS.max(parameters.hysteresis);
    parameters.hysteresis + (still - parameters.hysteresis) * stillness
}

impl GpuProbeInfo {
    /// The uniform of a field in a frame.
    pub(super) fn new(field: &ProbeField, parameters: &ProbeParameters, frame: u64) -> Self {
        let (volume, atlas) = (field.volume(), field.atlas());
        let visibility_bits = field.visibility_bits();
        Self {
            levels: GpuProbeLevel::all(volume, field.motion(), visibility_bits, parameters, frame),
            counts: volume.counts().to_array(),
            slots: atlas.slots,
            level_count: volume.levels().len() as u32,
            level_slots: volume.level_slots(),
            rays: parameters.rays_per_update().min(field.rays_per_probe()),
            ray_room: field.rays_per_probe(),
            columns_log2: atlas.columns_log2,
            rows_log2: atlas.rows_log2,
            irradiance_texels: atlas.irradiance_texels as f32,
            distance_texels: atlas.distance_texels as f32,
            normal_bias: parameters.normal_bias,
            hysteresis: hysteresis(parameters, field.changes.stillness()),
            warmup_frames: parameters.warmup_frames,
            firefly_clamp: parameters.firefly_clamp,
            move_reach: match parameters.relocation {
                Relocation::Off => 0.0,
                Relocation::Exact => MOVE_REACH,
            },
            lattice_slots: volume.slots(),
            visibility_lattice_words: visibility_bits.map_or(0, VisibilityBits::lattice_words),
            back_side_share: match visibility_bits {
                Some(visibility_bits) if visibility_bits.back_side() => BACK_SIDE_SHARE,
                _ => 1.0,
            },
            cage_corners: 8,
            _pad: [0; 3],
        }
    }
}
