//! What is kept of each probe besides its maps.

use crate::probes::atlas;

/// How often a probe is updated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProbeClass {
    /// In every frame.
    Alive,
    /// Now and then: it lights what the rays of those alive hit.
    IndirectOnly,
    Asleep,
    /// Never: it lies in stone.
    Dead,
}

crate::shared! {
    in probes;

    enum ProbeClass as CLASS { Alive, IndirectOnly, Asleep, Dead }

    /// Bits of a probe's flags that are its class.
    const CLASS_BITS: u32 = 3;

    /// Set in a probe's flags when there is no stone within a spacing of it.
    const STATE_FAR: u32 = 4;

    /// What a probe knows of its own light.
    pub struct GpuProbeState as ProbeState {
        /// So far; 0 for a probe in stone.
        pub updates: u32,
        /// Mean of its rays.
        pub luminance: f32,
        /// How much its light changes now.
        pub variability: f32,
        /// What pass `probes/classify` knows of it, and its class.
        pub flags: u32,
    }

    /// Where a probe stands.
    pub struct GpuProbePlace as ProbePlace {
        pub position_ws: [f32; 3],
        /// 0 for a probe in stone, 1 for others, 2 for one that has a twin.
        pub alive: f32,
    }
}

const _: () = assert!(size_of::<GpuProbeState>() as u64 == atlas::STATE_BYTES);
const _: () = assert!(size_of::<GpuProbePlace>() as u64 == atlas::PLACE_BYTES);

impl GpuProbeState {
    /// Whether no stone lies within a spacing of the probe.
    pub fn is_far(&self) -> bool {
        self.flags & STATE_FAR != 0
    }

    pub fn class(&self) -> ProbeClass {
        use ProbeClass::{Alive, Asleep, Dead, IndirectOnly};
        [Alive, IndirectOnly, Asleep, Dead][(self.flags & CLASS_BITS) as usize]
    }
}
