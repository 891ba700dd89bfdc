//! Moves a frame to another device when its own is lost.

use super::{Frame, FrameError, Stage};
use crate::{
    gpu::Gpu,
    parameters::ProbeParameters,
    world::{LayoutSpec, World, voxels::Voxels},
};

impl Frame {
    /// The same picture on a device that was opened again ([`Gpu::reopened`]). Light must be found again, because the
    /// lost device held it. `voxels` is the CPU's copy with all edits. `None` means that nothing was edited; the world
    /// is then built again.
    ///
    /// # Errors
    /// [`FrameError`] when the adapter cannot hold it; [`crate::gpu::GpuError::Device`] when this device is lost
    /// too.
    pub fn moved_to(
        &self,
        gpu: &Gpu,
        world: &World,
        voxels: Option<&Voxels>,
        layout: &LayoutSpec,
        probes: &ProbeParameters,
    ) -> Result<Self, FrameError> {
        let stage = match voxels {
            Some(voxels) => Stage::upload(gpu, world, voxels)?,
            None => Stage::build(gpu, world)?,
        };
        let mut moved = Self::new(gpu, stage, layout, probes, self.size)?;
        moved.antialias(gpu, self.antialiasing.wanted)?;
        moved.inspect(gpu, self.passes.inspect.wanted)?;
        if self.bits.wanted {
            moved.prepare_bits(gpu)?;
        }
        Ok(moved)
    }
}
