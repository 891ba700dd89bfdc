//! What shaders know of a probe field as a whole.

use bytemuck::{Pod, Zeroable};

use super::probe_level::{GpuProbeLevel, LEVELS};

/// `ProbeInfo` of `shaders/data/probes.wesl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct GpuProbeInfo {
    pub levels: [GpuProbeLevel; LEVELS],
    pub counts: [u32; 3],
    pub slots: u32,
    pub level_count: u32,
    pub level_slots: u32,
    pub rays: u32,
    pub columns_log2: u32,
    pub rows_log2: u32,
    pub irradiance_texels: f32,
    pub irradiance_scale: [f32; 2],
    pub distance_scale: [f32; 2],
    pub distance_texels: f32,
    pub reject_longer: u32,
    pub normal_bias: f32,
    pub view_bias: f32,
    pub wrap_offset: f32,
    pub crush: f32,
    pub visibility: u32,
    pub chebyshev_power: f32,
    pub chebyshev_floor: f32,
    pub least_weight: f32,
    pub hysteresis: f32,
    pub warmup_frames: u32,
    pub firefly_clamp: f32,
    pub move_reach: f32,
}
