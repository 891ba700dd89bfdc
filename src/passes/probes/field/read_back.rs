//! What tests, tables and views read back from the probes.

use half::f16;

use super::{GpuProbeState, ProbeField, StateCounts};
use crate::{
    gpu::{Gpu, GpuError},
    probes::{Layout as _, packed},
};

impl ProbeField {
    /// Slots that were active in the last update, in no particular order.
    ///
    /// # Errors
    /// [`GpuError::Device`] when the device is lost.
    pub fn active_slots(&self, gpu: &Gpu) -> Result<Vec<u32>, GpuError> {
        self.update_schedule.active_slots(gpu)
    }

    /// Irradiance over π (linear RGB) of every texel of the maps: rows without borders, probe by probe; 0 where a probe
    /// gives no light.
    ///
    /// # Errors
    /// [`GpuError::Device`] when the device is lost.
    pub fn irradiance(&self, gpu: &Gpu) -> Result<Vec<[f32; 3]>, GpuError> {
        let stored: Vec<[u32; 2]> = gpu.read_buffer(&self.irradiance_maps)?;
        Ok(stored.into_iter().map(packed::light_of).collect())
    }

    /// Radiance and length of every ray of the probes whose rays are new. Pairs of then and now are left out: whatever their
    /// bits are, they are finite. So are those that a probe which moved away or is now in stone has left behind.
    ///
    /// # Errors
    /// [`GpuError::Device`] when the device is lost.
    pub fn new_rays(&self, gpu: &Gpu) -> Result<Vec<f32>, GpuError> {
        let rays: Vec<[f16; 4]> = gpu.read_buffer_range(&self.rays, 0, self.memory.rays)?;
        let states: Vec<GpuProbeState> = gpu.read_buffer(&self.states)?;
        let of_probes = rays.chunks(self.rays_per_probe as usize).zip(&states);
        let new = of_probes.filter(|(_, state)| state.updates > 0 && !state.holds_pairs());
        Ok(new
            .flat_map(|(rays, _)| rays.iter().flatten())
            .map(|number| number.to_f32())
            .collect())
    }

    /// The light that probes give to faces of voxels: linear RGB, for each probe two colours along each axis.
    ///
    /// # Errors
    /// [`GpuError::Device`] when the device is lost.
    pub fn light_along_axes(&self, gpu: &Gpu) -> Result<Vec<f32>, GpuError> {
        let vectors: Vec<[u32; 4]> = gpu.read_buffer(&self.ambient_cubes)?;
        let vectors = vectors.into_iter();
        Ok(if self.rhythms.is_some() {
            vectors
                .flat_map(|[light, ..]| packed::radiance_of(light))
                .collect()
        } else {
            vectors.flat_map(packed::axis).collect()
        })
    }

    /// How many probes are in each state, and how many were active in the last update.
    ///
    /// # Errors
    /// [`GpuError::Device`] when the device is lost.
    pub fn state_counts(&self, gpu: &Gpu) -> Result<StateCounts, GpuError> {
        self.update_schedule.count(gpu, &self.states, &self.volume)
    }

    /// How often each probe has been updated since it was new; 0 for a probe in a solid voxel.
    ///
    /// # Errors
    /// [`GpuError::Device`] when the device is lost.
    pub fn updates(&self, gpu: &Gpu) -> Result<Vec<u32>, GpuError> {
        let states = self.states(gpu)?;
        Ok(states.iter().map(|state| state.updates).collect())
    }

    /// What each probe of the lattice knows of its own light.
    ///
    /// # Errors
    /// [`GpuError::Device`] when the device is lost.
    pub fn states(&self, gpu: &Gpu) -> Result<Vec<GpuProbeState>, GpuError> {
        let mut states: Vec<GpuProbeState> = gpu.read_buffer(&self.states)?;
        states.truncate(self.volume.slots() as usize);
        Ok(states)
    }
}
