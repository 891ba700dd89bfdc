//! What is stored of each probe besides its maps.

use crate::probes::atlas;

/// How often a probe is updated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProbeClass {
    /// In every frame.
    Alive,
    /// Every few frames: it lights only what the rays of alive probes hit.
    IndirectOnly,
    Asleep,
    /// Never: it lies in a solid voxel.
    Dead,
}

crate::shared! {
    in probes;

    enum ProbeClass as CLASS { Alive, IndirectOnly, Asleep, Dead }

    /// Bits of a probe's flags that are its class.
    const CLASS_BITS: u32 = 3;

    /// Set in a probe's flags when no solid voxel lies within a spacing of it.
    const STATE_FAR: u32 = 4;

    /// Set in a probe's flags from when pass `probes/classify` moves it until pass `probes/visibility` has found what it
    /// sees from its new place.
    const STATE_MOVED: u32 = 8;

    /// Set in a probe's flags when its stored rays are pairs of then and now.
    const HOLDS_PAIRS: u32 = 16;

    /// The upper bits of a probe's flags from this one on: the number of the frame that was the first to send its rays.
    const RAYS_FRAME_SHIFT: u32 = 16;

    /// What a probe knows of its own light.
    pub struct GpuProbeState as ProbeState {
        /// Updates so far; 0 for a probe in a solid voxel.
        pub updates: u32,
        /// Mean luminance of its rays.
        pub luminance: f32,
        /// How much its light changes now.
        pub variability: f32,
        /// What pass `probes/classify` found about it, and its class.
        pub flags: u32,
    }

    /// Where a probe is.
    pub struct GpuProbePlace as ProbePlace {
        pub position_ws: [f32; 3],
        /// 0: in a solid voxel; 1: outside; 2: outside, with a back-side probe.
        pub alive: f32,
    }
}

const _: () = assert!(size_of::<GpuProbeState>() as u64 == atlas::STATE_BYTES);
const _: () = assert!(size_of::<GpuProbePlace>() as u64 == atlas::PLACE_BYTES);

impl GpuProbeState {
    /// Whether no solid voxel lies within a spacing of the probe.
    pub fn is_far(&self) -> bool {
        self.flags & STATE_FAR != 0
    }

    /// Whether the rays that are stored for the probe are pairs: `shaders/probes/repeated_rays.wesl`.
    pub fn holds_pairs(&self) -> bool {
        self.flags & HOLDS_PAIRS != 0
    }

    pub fn class(&self) -> ProbeClass {
        use ProbeClass::{Alive, Asleep, Dead, IndirectOnly};
        [Alive, IndirectOnly, Asleep, Dead][(self.flags & CLASS_BITS) as usize]
    }
}
