//! Lamps, sun and sky on the GPU.

use glam::UVec3;

use super::seen_lamps::SeenLamps;
use crate::{
    gpu::{Gpu, GpuError},
    lights::{
        LampKinds, Lights, lists,
        table::{GpuLampSlot, LISTED, LISTS_OFFSET, LightsOfFrame},
    },
};

/// The binding of `shaders/scene/lights.wesl`.
pub struct GpuLights {
    buffer: wgpu::Buffer,
    /// Cells that have lists of lamps, and log2 of the voxels along a cell.
    cells: UVec3,
    shift: u32,
    kinds: LampKinds,
    seen: SeenLamps,
}

impl GpuLights {
    /// Dark until [`set`](Self::set). `size`: voxels of a world whose cells get lists of lamps
    /// ([`lights::lists`](crate::lights::lists)); `None` for kernels that look at all lamps.
    ///
    /// # Errors
    /// [`GpuError`] when the adapter cannot hold it.
    pub fn new(gpu: &Gpu, size: Option<UVec3>) -> Result<Self, GpuError> {
        let (cells, shift) = size.map_or((UVec3::ZERO, 0), |size| {
            (lists::cells(size), lists::cell_shift(size))
        });
        // The array of slots must not be empty.
        let slot = size_of::<GpuLampSlot>() as u64;
        let bytes = LISTS_OFFSET as u64 + lists::bytes(cells).max(u64::from(LISTED) * slot);
        let buffer = gpu.making("the lamps and their lists", bytes, || {
            gpu.storage_buffer("lights", bytes)
        })?;
        Ok(Self {
            buffer,
            cells,
            shift,
            kinds: LampKinds::ALL,
            seen: SeenLamps::new(gpu, size.unwrap_or(UVec3::ONE))?,
        })
    }

    /// The same for kernels that know these kinds of lamps alone.
    #[must_use]
    pub fn with_kinds(self, kinds: LampKinds) -> Self {
        Self { kinds, ..self }
    }

    /// The kinds of lamps that kernels know which are made for these lights.
    pub fn kinds(&self) -> LampKinds {
        self.kinds
    }

    /// Says which kinds of lamps kernels know; those that exist must be made again.
    pub fn set_kinds(&mut self, kinds: LampKinds) {
        self.kinds = kinds;
    }

    /// The constants of kernels that are made for these lights.
    pub fn constants(&self) -> [(&'static str, f64); 2] {
        let LampKinds { spheres, lists } = self.kinds;
        [
            ("SPHERES", f64::from(u8::from(spheres))),
            ("LISTS", f64::from(u8::from(lists))),
        ]
    }

    /// Sets the lights of the next frames.
    pub fn set(&self, gpu: &Gpu, lights: &Lights, of_frame: &LightsOfFrame) {
        let needed = LampKinds::of(lights);
        debug_assert!(
            self.kinds.with(needed) == self.kinds,
            "kernels were made for other kinds of lamps: {:?}",
            self.kinds
        );
        let bytes = lights.to_bytes(of_frame, self.cells, self.shift);
        gpu.queue.write_buffer(&self.buffer, 0, &bytes);
    }

    /// Forgets which lamps are seen where, as if no frame had been drawn.
    pub fn forget(&mut self, encoder: &mut wgpu::CommandEncoder) {
        self.seen.forget(encoder);
    }

    /// Begins a frame of rays that learn which of `lights` are seen where. `repeats`: rays of probes are repeated.
    pub fn begin_frame(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        lights: &Lights,
        repeats: bool,
    ) {
        self.seen.begin_frame(gpu, encoder, lights, repeats);
    }

    /// Cells that have lists.
    pub fn cells(&self) -> UVec3 {
        self.cells
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        self.buffer.size() + self.seen.bytes()
    }

    /// What the shaders bind by name.
    pub fn resources(&self) -> [(&'static str, wgpu::BindingResource<'_>); 2] {
        [
            ("lights", self.buffer.as_entire_binding()),
            self.seen.of_probes(),
        ]
    }

    /// What pass `surface_cache/trace` binds in place of the same of pass `probes/trace`: the two run concurrently.
    pub fn seen_by_faces(&self) -> (&'static str, wgpu::BindingResource<'_>) {
        self.seen.of_faces()
    }

    /// What pass `scene/lamp_lists` writes.
    pub fn lists(&self) -> (&'static str, wgpu::BindingResource<'_>) {
        ("lights_out", self.buffer.as_entire_binding())
    }
}
