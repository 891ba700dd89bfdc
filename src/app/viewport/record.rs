//! Draws the picture that is shown.

use super::{ReferenceView, Viewport};
use crate::{
    gpu::{GpuError, Recorder},
    lights::Lights,
    measure::picture::Picture,
    passes::view::Shot,
    world::Camera,
};

impl Viewport {
    /// Records a frame, as seen from `camera` at world time `time_s`.
    ///
    /// # Errors
    /// [`GpuError`] when the device does not take the work.
    pub fn record(
        &mut self,
        recorder: &mut Recorder<'_>,
        camera: &Camera,
        time_s: f64,
        seed: u32,
    ) -> Result<(), GpuError> {
        let parameters = &self.choice.parameters;
        let size = match &self.reference_view {
            Some(reference_view) => reference_view.size(),
            None => self.frame.size(),
        };
        let shot = Shot {
            camera: camera.clone(),
            size,
            frame: self.frame.frames(),
            seed,
            exposure_ev: parameters.picture.exposure_ev,
            view: self.inspection.view,
            time_s,
            textures: parameters.textures.enabled,
            soft_rays: parameters.lights.soft_rays,
            shadows: parameters.lights.shadows,
        };
        if self.frame.has_bodies() && std::mem::take(&mut self.bodies_moved) {
            self.frame.rest_bodies(&self.gpu, &self.world.bodies);
        }
        let lamp_time_s = self.lamp_time_s(time_s);
        let lights = Lights::at(&self.world, &self.lamps(), lamp_time_s);
        if let Some(reference_view) = &mut self.reference_view {
            return reference_view.record(&self.gpu, recorder, shot, &lights);
        }
        let probes = self.effort.probes(&parameters.probes);
        self.frame
            .record(&self.gpu, recorder, &shot, &lights, &probes);
        Ok(())
    }

    /// The path-traced picture, while it is shown.
    pub fn reference_view(&mut self) -> Option<&mut ReferenceView> {
        self.reference_view.as_mut()
    }

    /// The picture shown: `rgba8unorm`, sRGB-encoded.
    pub fn display(&self) -> &wgpu::Texture {
        match &self.reference_view {
            Some(reference_view) => reference_view.display(),
            None => self.frame.display(),
        }
    }

    /// The picture shown, as values in [0, 1].
    ///
    /// # Errors
    /// [`GpuError::Device`] when the device is lost.
    pub fn read_display(&self) -> Result<Picture, GpuError> {
        match &self.reference_view {
            Some(reference_view) => reference_view.read_display(&self.gpu),
            None => self.frame.read_display(&self.gpu),
        }
    }
}
