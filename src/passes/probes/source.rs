//! What a field of probes has in addition under `probes.method=source`. Most passes see it only as constants.

use crate::{
    gpu::{Gpu, GpuError},
    parameters::{
        Method, ProbeParameters, SourceDepth, SourceParameters, SourceRelocation, SourceWeights,
    },
    probes::MOVE_REACH,
};

/// Additional data of a field whose algorithm is not grotto's own.
pub struct Source {
    weights: SourceWeights,
    depth: SourceDepth,
    pub relocation: SourceRelocation,
    /// What each probe knows about its place: `shaders/probes/source_walk.wesl`.
    pub walks: wgpu::Buffer,
}

impl Source {
    /// Bytes of each probe's walk.
    const WALK_BYTES: u64 = 8;

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
        let bytes = u64::from(slots) * Self::WALK_BYTES;
        Ok(Some(Self {
            weights,
            depth,
            relocation,
            walks: gpu.storage_buffer("probe_walks", bytes)?,
        }))
    }

    /// Constant `SOURCE_WEIGHTS` of kernels that gather.
    pub fn weights(&self) -> f64 {
        match self.weights {
            SourceWeights::Trilinear => 1.0,
            SourceWeights::Direction => 2.0,
            SourceWeights::Visibility => 3.0,
            SourceWeights::Perception => 4.0,
            SourceWeights::Adjusted => 5.0,
        }
    }

    /// Constant `REJECT_LONGER` of pass `probes/blend`.
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
