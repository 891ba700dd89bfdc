//! Lamps, sun and sky on the GPU.

use glam::Vec3;

use crate::{
    gpu::Gpu,
    lights::{self, Lights},
};

/// The binding of `shaders/scene/lights.wesl`.
pub struct GpuLights {
    pub buffer: wgpu::Buffer,
}

impl GpuLights {
    /// Dark until [`set`](Self::set).
    pub fn new(gpu: &Gpu) -> Self {
        Self {
            buffer: gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("lights"),
                size: lights::table::BYTES as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
        }
    }

    /// Sets the lights of the next frames. `gain` is the factor by which pictures are brighter ([`lights::CommonGain`]);
    /// `still_since` says since when each lamp rests ([`lights::RestingLamps`]).
    pub fn set(&self, gpu: &Gpu, lights: &Lights, gain: Vec3, still_since: &[u32]) {
        let bytes = lights.to_bytes(gain, still_since);
        gpu.queue.write_buffer(&self.buffer, 0, &bytes);
    }

    /// What the shaders bind by name.
    pub fn resources(&self) -> [(&'static str, wgpu::BindingResource<'_>); 1] {
        [("lights", self.buffer.as_entire_binding())]
    }
}
