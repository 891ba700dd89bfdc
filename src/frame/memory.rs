//! How much memory a frame takes.

use super::Frame;
use crate::passes::{
    scene::MemoryUse,
    view::{antialias::TemporalAntialias, bits::Bits},
};

impl Frame {
    /// Bytes of GPU memory.
    pub fn memory(&self) -> MemoryUse {
        let [width, height] = self.size.map(u64::from);
        let antialias = u64::from(self.passes.antialias.is_some());
        let per_pixel = 8 + 4 + antialias * TemporalAntialias::BYTES_PER_PIXEL;
        let picture = self.passes.camera_rays.surfaces.size() + width * height * per_pixel;
        let voxels = self.stage.voxels.bytes();
        let probes = self.field.memory().total() + self.passes.visibility.bytes();
        let others = picture
            + self.passes.inspect.bytes(self.size)
            + self.faces.bytes()
            + self.lights.bytes()
            + self.passes.bits.as_ref().map_or(0, Bits::bytes)
            + self.stage.emitters.bytes();
        MemoryUse {
            voxels,
            probes,
            total: voxels + probes + others,
        }
    }
}
