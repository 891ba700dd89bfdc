//! Pass `probe_paint`: the states of the probes as an atlas of colours, for the view of states.

use super::{ProbeField, probe_field::layers_of};
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Recorder, rectangle};

pub struct ProbePaint {
    kernel: Kernel,
    bindings: Bindings,
    groups: [u32; 2],
    /// Laid out as [`ProbeField::irradiance_atlas`]. RGB: the colour of the state, linear for the display;
    /// A: as the atlas has it.
    pub atlas: wgpu::Texture,
}

impl ProbePaint {
    /// # Errors
    /// [`GpuError::TooLarge`], [`GpuError::Shader`].
    pub fn new(gpu: &Gpu, field: &ProbeField) -> Result<Self, GpuError> {
        let layout = field.atlas();
        let extent = layout.texture_extent(layout.irradiance_texels);
        let atlas = gpu.texture("state_atlas", extent, wgpu::TextureFormat::Rgba16Float)?;
        let kernel = Kernel::new(
            gpu,
            &KernelSpec {
                shader: "passes/probe_paint",
                ..Default::default()
            },
        )?;
        let mut all = field.resources().to_vec();
        all.extend(field.due_resources());
        let view = layers_of(&atlas);
        all.push(("state_atlas", wgpu::BindingResource::TextureView(&view)));
        Ok(Self {
            bindings: kernel.bind(gpu, &all),
            kernel,
            groups: rectangle(layout.slots),
            atlas,
        })
    }

    /// For those who gather from it.
    pub fn view(&self) -> wgpu::TextureView {
        layers_of(&self.atlas)
    }

    /// After pass `probe_blend`, before pass `shade`.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        recorder.run(&self.kernel, &self.bindings, self.groups);
    }
}
