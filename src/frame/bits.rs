//! What a frame draws besides voxels: bits that fly, and the bulbs of lamps.

use super::{Frame, FrameError};
use crate::{
    gpu::Gpu,
    passes::view::bits::{Bits, GpuBit},
    world::View,
};

/// The bits of the next pictures.
#[derive(Default)]
pub(super) struct DrawnBits {
    /// Whether their pass is made.
    pub wanted: bool,
    all: Vec<GpuBit>,
}

impl Frame {
    /// Makes the pass that draws bits, so that the first bit need not wait for it.
    ///
    /// # Errors
    /// [`FrameError::Gpu`] when the adapter cannot hold it; the frame is then unchanged.
    pub fn prepare_bits(&mut self, gpu: &Gpu) -> Result<(), FrameError> {
        if !std::mem::replace(&mut self.bits.wanted, true)
            && let Err(error) = self.rebuild_passes(gpu)
        {
            self.bits.wanted = false;
            return Err(error);
        }
        Ok(())
    }

    /// Draws these bits in the next pictures, and no others. Of more than
    /// [`Bits::MOST`](crate::passes::view::bits::Bits::MOST) the first ones are drawn. They change nothing but the picture.
    ///
    /// # Errors
    /// Those of [`prepare_bits`](Self::prepare_bits), with which the first bits begin.
    pub fn set_bits(&mut self, gpu: &Gpu, bits: &[GpuBit]) -> Result<(), FrameError> {
        if !bits.is_empty() {
            self.prepare_bits(gpu)?;
        }
        let is_still = |bit: &&GpuBit| bit.flies == 0;
        let still = bits.iter().filter(is_still);
        if !still.eq(self.bits.all.iter().filter(is_still)) {
            self.antialiasing.change_bits();
        }
        self.bits.all.clear();
        self.bits.all.extend_from_slice(bits);
        Ok(())
    }

    /// Whether bits are drawn over the next picture, if it shows `view`.
    pub(super) fn draws_bits(&self, view: View) -> bool {
        Bits::are_in(view) && self.passes.bits.is_some() && !self.bits.all.is_empty()
    }

    pub(super) fn upload_bits(&mut self, gpu: &Gpu) {
        if let Some(pass) = &mut self.passes.bits {
            pass.set(gpu, &self.bits.all);
        }
    }
}
