//! What a field of probes has in addition under `probes.hits=kept`. The hits themselves lie behind the rays in their
//! buffer: pass `probes/trace` has no room for another binding.

use crate::{
    gpu::{Gpu, GpuError},
    parameters::{ProbeHits, ProbeParameters},
    probes::sampling,
};

/// Data of the pass that forgets hits, and the number of sets.
pub struct KeptHits {
    /// Sets of directions that updates take in turn.
    pub sets: u32,
    /// Unit directions of all rays, set by set.
    pub directions: wgpu::Buffer,
    /// Where each probe was when its hits were traced.
    pub places: wgpu::Buffer,
}

impl KeptHits {
    /// `None` where every update traces its rays.
    ///
    /// # Errors
    /// [`GpuError`] when the adapter cannot hold it.
    pub fn new(
        gpu: &Gpu,
        place_bytes: u64,
        parameters: &ProbeParameters,
    ) -> Result<Option<Self>, GpuError> {
        if parameters.hits == ProbeHits::Traced {
            return Ok(None);
        }
        let directions: Vec<[f32; 4]> = (0..parameters.hit_sets)
            .flat_map(|set| sampling::kept_directions(parameters, set))
            .map(|direction| direction.as_vec3().extend(0.0).to_array())
            .collect();
        Ok(Some(Self {
            sets: parameters.hit_sets,
            directions: gpu.storage_buffer_of("hit_directions", &directions)?,
            places: gpu.storage_buffer("hit_places", place_bytes)?,
        }))
    }
}
