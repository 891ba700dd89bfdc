//! Lamps, sun and sky on the GPU.

use glam::UVec3;

use super::seen_lamps::SeenLamps;
use crate::{
    gpu::{Gpu, GpuError},
    lights::{
        Lights, lists,
        table::{GpuLampSlot, LISTED, LISTS_OFFSET, LightsOfFrame},
    },
};

/// The binding of `shaders/scene/lights.wesl`.
pub struct GpuLights {
    buffer: wgpu::Buffer,
    /// Cells that have lists of lamps, and log2 of the voxels along a cell.
    cells: UVec3,
    shift: u32,
    has_spheres: bool,
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
            has_spheres: true,
            seen: SeenLamps::new(gpu, size.unwrap_or(UVec3::ONE))?,
        })
    }

    /// For a world in which no lamp is a sphere: kernels leave out what spheres need.
    #[must_use]
    pub fn without_spheres(self) -> Self {
        Self {
            has_spheres: false,
            ..self
        }
    }

    /// Whether kernels that are made for these lights know spheres.
    pub fn has_spheres(&self) -> bool {
        self.has_spheres
    }

    /// Says whether kernels know spheres; those that exist must be made again.
    pub fn set_spheres(&mut self, has_spheres: bool) {
        self.has_spheres = has_spheres;
    }

    /// The constant of kernels that are made for these lights.
    pub fn constants(&self) -> [(&'static str, f64); 1] {
        [("SPHERES", f64::from(u8::from(self.has_spheres)))]
    }

    /// Sets the lights of the next frames.
    pub fn set(&self, gpu: &Gpu, lights: &Lights, of_frame: &LightsOfFrame) {
        debug_assert!(
            self.has_spheres || !lights.has_spheres(),
            "kernels were made for lamps that are no spheres"
        );
        let bytes = lights.to_bytes(of_frame, self.cells, self.shift);
        gpu.queue.write_buffer(&self.buffer, 0, &bytes);
    }

    /// Forgets which lamps are seen where, as if no frame had been drawn.
    pub fn forget(&mut self, encoder: &mut wgpu::CommandEncoder) {
        self.seen.forget(encoder);
    }

    /// Begins a frame of rays that learn which lamps are seen where. `lamps_change_greatly`: lamps were switched;
    /// `repeats`: rays of probes are repeated.
    pub fn begin_frame(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        lamps_change_greatly: bool,
        repeats: bool,
    ) {
        self.seen
            .begin_frame(gpu, encoder, lamps_change_greatly, repeats);
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
