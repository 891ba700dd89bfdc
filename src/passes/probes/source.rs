//! What a field of probes has in addition under `probes.method=source`. Most passes see it only as constants.

use crate::{
    gpu::{Gpu, GpuError},
    parameters::{
        Method, ProbeParameters, SourceDepth, SourceParameters, SourceRelocation, SourceWeights,
    },
    probes::{MOVE_REACH, atlas::WALK_BYTES},
};

crate::shared! {
    in probes;

    /// The weights of a gather under `probes.method=source`, each with all before it. 0 are grotto's own.
    const TRILINEAR as SOURCE_TRILINEAR: u32 = 1;
    const DIRECTION as SOURCE_DIRECTION: u32 = 2;
    const VISIBILITY as SOURCE_VISIBILITY: u32 = 3;
    const PERCEPTION as SOURCE_PERCEPTION: u32 = 4;
    const ADJUSTED as SOURCE_ADJUSTED: u32 = 5;

    /// Farthest that a probe walks along an axis, in spacings.
    use MOVE_REACH => MOVE_REACH: f32;
}

/// Additional data of a field whose algorithm is not grotto's own.
pub struct Source {
    weights: SourceWeights,
    depth: SourceDepth,
    pub relocation: SourceRelocation,
    /// What each probe knows about its place: `shaders/probes/source_walk.wesl`.
    pub walks: wgpu::Buffer,
}

impl Source {
    /// `None` for grotto's own algorithm.
    ///
    /// # Errors
    /// [`GpuError`] when the adapter cannot hold it.
    pub fn new(
        gpu: &Gpu,
        slots: u32,
        parameters: &ProbeParameters,
    ) -> Result<Option<Self>, GpuError> {
        let SourceParameters {
            weights,
            relocation,
            depth,
        } = parameters.source.clone();
        if parameters.method == Method::Grotto {
            return Ok(None);
        }
        let bytes = u64::from(slots) * WALK_BYTES;
        Ok(Some(Self {
            weights,
            depth,
            relocation,
            walks: gpu.storage_buffer("probe_walks", bytes)?,
        }))
    }

    /// Constant `SOURCE_WEIGHTS` of kernels that gather.
    pub fn weights(&self) -> f64 {
        f64::from(match self.weights {
            SourceWeights::Trilinear => TRILINEAR,
            SourceWeights::Direction => DIRECTION,
            SourceWeights::Visibility => VISIBILITY,
            SourceWeights::Perception => PERCEPTION,
            SourceWeights::Adjusted => ADJUSTED,
        })
    }

    /// Constant `REJECT_LONGER` of pass `probes/blend_distances`.
    pub fn rejects(&self) -> bool {
        self.depth == SourceDepth::Reject
    }
}

/// Longest distance that a probe stores, in diagonals of its cage, where the source rejects longer ones. No cage needs
/// a longer one, however far its probe has moved. `None` where nothing is rejected.
pub fn longest(parameters: &ProbeParameters) -> Option<f32> {
    let source = &parameters.source;
    if parameters.method == Method::Grotto || source.depth == SourceDepth::Clamp {
        return None;
    }
    Some(match source.relocation {
        SourceRelocation::Off => 1.0,
        SourceRelocation::Surface | SourceRelocation::Clear => 1.0 + MOVE_REACH,
    })
}
