//! Bodies that a player places, removes or pushes while a frame is shown.

use std::mem;

use super::{Frame, FrameError};
use crate::{gpu::Gpu, world::bodies::Bodies};

impl Frame {
    /// Shows other bodies; the probes keep their light. The first ones of a world that had none, and more than there is
    /// room for, bind every pass again; the first ones compile them, too.
    ///
    /// # Errors
    /// [`FrameError`] when the adapter cannot hold them; the frame is then unchanged.
    pub fn set_bodies(&mut self, gpu: &Gpu, bodies: &Bodies) -> Result<(), FrameError> {
        if self.stage.voxels.bodies.take(gpu, bodies) {
            return Ok(());
        }
        let larger = self.stage.voxels.bodies.with_room(gpu, bodies)?;
        let before = mem::replace(&mut self.stage.voxels.bodies, larger);
        if let Err(error) = self.rebuild_passes(gpu) {
            self.stage.voxels.bodies = before;
            return Err(error);
        }
        Ok(())
    }

    /// Moves the bodies to where they rest now.
    pub fn rest_bodies(&self, gpu: &Gpu, bodies: &Bodies) {
        self.stage.voxels.bodies.rest(gpu, bodies);
    }
}
