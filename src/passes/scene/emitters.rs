//! The faces of emissive voxels on the GPU, for passes that choose from them.

use crate::{
    gpu::{Gpu, GpuError},
    lights::{Emitters, emitters::FACINGS},
};

/// One group per direction of faces and emissive material.
const MOST_GROUPS: usize = FACINGS * 255;
/// Spare room of the list: SPARE_FACES faces, and one more for every SPARE_SHARE faces in it.
const SPARE_FACES: usize = 1024;
const SPARE_SHARE: usize = 4;

/// The bindings of `shaders/scene/emitters.wesl`, with room for more.
pub struct GpuEmitters {
    /// The list that the buffers hold.
    pub known: Emitters,
    room: usize,
    groups: wgpu::Buffer,
    faces: wgpu::Buffer,
}

impl GpuEmitters {
    /// A list that the adapter cannot hold is left empty. Rays then find emissive voxels only by chance, which is
    /// unbiased too, but noisier.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`] when not even an empty list fits.
    pub fn upload(gpu: &Gpu, emitters: Emitters) -> Result<Self, GpuError> {
        let count = emitters.faces.len();
        let room = if emitters.may_grow() {
            count + count / SPARE_SHARE + SPARE_FACES
        } else {
            0
        };
        let made = |room: usize| -> Result<Self, GpuError> {
            let groups = if room > 0 { MOST_GROUPS } else { 1 };
            Ok(Self {
                known: Emitters::default(),
                room,
                groups: gpu.storage_buffer("emitters", Emitters::bytes(groups))?,
                faces: gpu.storage_buffer("emitter_faces", 4 * room as u64)?,
            })
        };
        match made(room) {
            Ok(mut made) => {
                made.write(gpu, emitters);
                Ok(made)
            }
            Err(error) => {
                tracing::warn!("emissive voxels are not sampled: {error}");
                made(0)
            }
        }
    }

    /// Whether there is room for a list.
    pub fn holds(&self, emitters: &Emitters) -> bool {
        emitters.faces.len() <= self.room
    }

    /// Replaces the list by one that it [`holds`](Self::holds).
    pub fn write(&mut self, gpu: &Gpu, emitters: Emitters) {
        gpu.queue
            .write_buffer(&self.groups, 0, &emitters.to_bytes());
        let faces = bytemuck::cast_slice(&emitters.faces);
        gpu.queue.write_buffer(&self.faces, 0, faces);
        self.known = emitters;
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        self.groups.size() + self.faces.size()
    }

    /// What the shaders bind by name.
    pub fn resources(&self) -> [(&'static str, wgpu::BindingResource<'_>); 2] {
        [
            ("emitters", self.groups.as_entire_binding()),
            ("emitter_faces", self.faces.as_entire_binding()),
        ]
    }
}
