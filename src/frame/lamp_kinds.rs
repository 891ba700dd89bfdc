//! Kinds of lamps that come, or go, while a frame is shown.

use super::{Frame, FrameError};
use crate::{gpu::Gpu, lights::LampKinds};

impl Frame {
    /// Makes every pass again, with what `kinds` need, where its kernels do not know them all; the probes keep their light.
    /// Must be called before such lights are recorded.
    ///
    /// # Errors
    /// [`FrameError`] when the adapter cannot hold the passes; the frame is then unchanged.
    pub fn allow_lamps(&mut self, gpu: &Gpu, kinds: LampKinds) -> Result<(), FrameError> {
        self.know_lamps(gpu, self.lights.kinds().with(kinds))
    }

    /// Makes every pass again, for these kinds of lamps alone, unless that is how they are. What the frame was made to know of
    /// rhythms stays.
    ///
    /// # Errors
    /// As [`Frame::allow_lamps`].
    pub fn know_lamps(&mut self, gpu: &Gpu, kinds: LampKinds) -> Result<(), FrameError> {
        let before = self.lights.kinds();
        // How probes tell rhythms apart was fixed when they were made.
        let kinds = LampKinds {
            rhythms: before.rhythms,
            ..kinds
        };
        if kinds == before {
            return Ok(());
        }
        self.lights.set_kinds(kinds);
        if let Err(error) = self.rebuild_passes(gpu) {
            self.lights.set_kinds(before);
            return Err(error);
        }
        self.stage.lamp_kinds = kinds;
        Ok(())
    }
}
