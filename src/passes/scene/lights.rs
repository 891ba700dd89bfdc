//! Lamps, sun and sky on the GPU.

use glam::UVec3;

use super::seen_lamps::SeenLamps;
use crate::{
    gpu::{Gpu, GpuError},
    lights::{
        Cells, LampKinds, Lights, lists,
        table::{GpuLampSlot, LISTED, LISTS_OFFSET, LightsOfFrame},
    },
};

/// For each cell, a bit for each slot of its list, and when that was examined.
const SHADOW_BYTES: u64 = 16;

/// The binding of `shaders/scene/lights.wesl`.
pub struct GpuLights {
    buffer: wgpu::Buffer,
    /// Cells that have lists of lamps.
    listed: Cells,
    /// Cells that know which lamps are seen from them.
    of_sight: Cells,
    kinds: LampKinds,
    seen: SeenLamps,
    /// A word for each cell of sight.
    cells_seen: wgpu::Buffer,
}

impl GpuLights {
    /// Dark until [`set`](Self::set). `size`: voxels of a world whose cells get lists of lamps
    /// ([`lights::lists`](crate::lights::lists)); `None` for kernels that look at all lamps.
    ///
    /// # Errors
    /// [`GpuError`] when the adapter cannot hold it.
    pub fn new(gpu: &Gpu, size: Option<UVec3>) -> Result<Self, GpuError> {
        let listed = size.map_or_else(Cells::default, lists::cells);
        let of_sight = Cells::of_sight(size.unwrap_or(UVec3::ONE));
        // The array of slots must not be empty.
        let slot = size_of::<GpuLampSlot>() as u64;
        let lists =
            (lists::bytes(listed) + SHADOW_BYTES * of_sight.number()).max(u64::from(LISTED) * slot);
        let bytes = LISTS_OFFSET as u64 + lists;
        let buffer = gpu.making("the lamps and their lists", bytes, || {
            gpu.storage_buffer("lights", bytes)
        })?;
        let marks = 4 * of_sight.number();
        let cells_seen = gpu.making("which cells are seen", marks, || {
            gpu.storage_buffer("cells_seen", marks)
        })?;
        Ok(Self {
            buffer,
            cells_seen,
            listed,
            of_sight,
            kinds: LampKinds::ALL,
            seen: SeenLamps::new(gpu, of_sight)?,
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
        let LampKinds { spheres, lists, .. } = self.kinds;
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
        let bytes = lights.to_bytes(of_frame, self.listed, self.of_sight);
        gpu.queue.write_buffer(&self.buffer, 0, &bytes);
    }

    /// Forgets which lamps are seen where, as if no frame had been drawn.
    pub fn forget(&mut self, encoder: &mut wgpu::CommandEncoder) {
        let shadows = LISTS_OFFSET as u64 + lists::bytes(self.listed);
        encoder.clear_buffer(&self.buffer, shadows, None);
        encoder.clear_buffer(&self.cells_seen, 0, None);
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
    pub fn listed(&self) -> Cells {
        self.listed
    }

    /// Cells that know which lamps are seen from them.
    pub fn of_sight(&self) -> Cells {
        self.of_sight
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        self.buffer.size() + self.cells_seen.size() + self.seen.bytes()
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

    /// Which cells pixels see: pass `surface_cache/allocate` writes it, and pass `surface_cache/cell_shadows` reads it.
    pub fn cells_seen(&self) -> (&'static str, wgpu::BindingResource<'_>) {
        ("cells_seen", self.cells_seen.as_entire_binding())
    }

    /// What passes `scene/lamp_lists` and `surface_cache/cell_shadows` write.
    pub fn lists(&self) -> (&'static str, wgpu::BindingResource<'_>) {
        ("lights_out", self.buffer.as_entire_binding())
    }
}
