//! How many shadow rays a frame sends.

use super::{Frame, offers::offer, stage::scene};
use crate::{
    gpu::{Gpu, GpuError},
    passes::bench::shadow_count::{self, Senders},
};

impl Frame {
    /// Counts the shadow rays of the last frame; `pixels`: whether to count the picture's own, as in views of direct
    /// light.
    ///
    /// # Errors
    /// [`GpuError::Shader`]; [`GpuError::Device`] when the device is lost.
    pub fn count_shadow_rays(&self, gpu: &Gpu, pixels: bool) -> Result<u64, GpuError> {
        let senders = Senders {
            surfaces: &self.passes.camera_rays.surfaces,
            pixels: pixels.then_some(self.drawn.size),
            probe_rays: self.field.atlas().slots * self.field.rays_per_probe(),
            face_groups: (self.faces.is_used()).then(|| self.faces.rays_most(self.size)),
        };
        let scene = scene(&self.stage, &self.view, &self.lights);
        let offer = offer(&self.field, &self.faces, &scene);
        shadow_count::count(gpu, &senders, &offer.with(self.faces.update_resources()))
    }
}
