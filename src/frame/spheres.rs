//! Lamps that are spheres and come while a frame is shown.

use super::{Frame, FrameError};
use crate::gpu::Gpu;

impl Frame {
    /// Makes every pass again, with what spheres need, where the world had none so far; the probes keep their light. Must be
    /// called before lights with the first sphere are recorded.
    ///
    /// # Errors
    /// [`FrameError`] when the adapter cannot hold the passes; the frame is then unchanged.
    pub fn allow_spheres(&mut self, gpu: &Gpu) -> Result<(), FrameError> {
        if self.lights.has_spheres() {
            return Ok(());
        }
        self.lights.set_spheres(true);
        if let Err(error) = self.rebuild_passes(gpu) {
            self.lights.set_spheres(false);
            return Err(error);
        }
        self.stage.has_spheres = true;
        Ok(())
    }
}
