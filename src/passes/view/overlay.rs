//! Pass `view/overlay`: draws the picture, stretched over the window, and the panel on top.

use egui_wgpu::{Renderer, RendererOptions, ScreenDescriptor};

use crate::gpu::{Gpu, GpuError, Recorder};

/// Draws into textures of one format.
pub struct Overlay {
    format: wgpu::TextureFormat,
    pipeline: wgpu::RenderPipeline,
    sampler: wgpu::Sampler,
    panel: Renderer,
    /// Textures of the panel that no submission after the last one uses.
    unused: Vec<egui::TextureId>,
}

/// The output of an egui pass that must be drawn.
pub struct PanelShapes {
    pub primitives: Vec<egui::ClippedPrimitive>,
    pub textures: egui::TexturesDelta,
    /// Pixels of the target per point of egui.
    pub pixels_per_point: f32,
}

impl Overlay {
    /// For targets of this format.
    ///
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Result<Self, GpuError> {
        Ok(Self {
            format,
            pipeline: pipeline(gpu, format)?,
            sampler: gpu.device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("picture_sampler"),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..Default::default()
            }),
            panel: Renderer::new(&gpu.device, format, RendererOptions::default()),
            unused: Vec::new(),
        })
    }

    /// Compiles the shader again, as after an edit of the folder `shaders/`.
    ///
    /// # Errors
    /// [`GpuError::Shader`] with the place; the pass is then unchanged.
    pub fn rebuild(&mut self, gpu: &Gpu) -> Result<(), GpuError> {
        self.pipeline = pipeline(gpu, self.format)?;
        Ok(())
    }

    /// Records the pass. `picture` is sRGB-encoded (see [`crate::frame::Frame::display`]), `target`
    /// has `size` pixels and the format that this was made for.
    pub fn record(
        &mut self,
        gpu: &Gpu,
        recorder: &mut Recorder<'_>,
        picture: &wgpu::Texture,
        target: &wgpu::TextureView,
        size: [u32; 2],
        mut shapes: PanelShapes,
    ) {
        for texture in self.unused.drain(..) {
            self.panel.free_texture(&texture);
        }
        for (texture, deltas) in shapes.textures.set.drain() {
            for delta in deltas {
                self.panel
                    .update_texture(&gpu.device, &gpu.queue, texture, &delta);
            }
        }
        self.unused.extend(shapes.textures.free.drain());
        let screen = ScreenDescriptor {
            size_in_pixels: size,
            pixels_per_point: shapes.pixels_per_point,
        };
        let commands = self.panel.update_buffers(
            &gpu.device,
            &gpu.queue,
            &mut recorder.encoder,
            &shapes.primitives,
            &screen,
        );
        debug_assert!(commands.is_empty(), "the panel has no paint callbacks");
        let bindings = self.bind(gpu, picture);
        recorder.render("view/overlay", target, |pass| {
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &bindings, &[]);
            pass.draw(0..3, 0..1);
            self.panel.render(pass, &shapes.primitives, &screen);
        });
    }

    fn bind(&self, gpu: &Gpu, picture: &wgpu::Texture) -> wgpu::BindGroup {
        let view = picture.create_view(&Default::default());
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("view/overlay"),
            layout: &self.pipeline.get_bind_group_layout(0),
            entries: &[
                wgpu::BindGroupEntry {
                    binding: 0,
                    resource: wgpu::BindingResource::TextureView(&view),
                },
                wgpu::BindGroupEntry {
                    binding: 1,
                    resource: wgpu::BindingResource::Sampler(&self.sampler),
                },
            ],
        })
    }
}

fn pipeline(gpu: &Gpu, format: wgpu::TextureFormat) -> Result<wgpu::RenderPipeline, GpuError> {
    const SHADER: &str = "view/overlay";
    let composed = gpu.compose(SHADER, &[])?;
    let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::Validation);
    let module = gpu
        .device
        .create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("view/overlay"),
            source: wgpu::ShaderSource::Wgsl(composed.wgsl.into()),
        });
    let constants = [("encodes", f64::from(u8::from(format.is_srgb())))];
    let pipeline = gpu
        .device
        .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("view/overlay"),
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("corner"),
                compilation_options: Default::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("pixel"),
                compilation_options: wgpu::PipelineCompilationOptions {
                    constants: &constants,
                    ..Default::default()
                },
                targets: &[Some(format.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
    match pollster::block_on(scope.pop()) {
        Some(error) => Err(GpuError::Shader {
            name: SHADER.to_owned(),
            message: error.to_string(),
        }),
        None => Ok(pipeline),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::ShaderChecks;

    const SIZE: [u32; 2] = [4, 2];

    /// What a window of this format shows for a picture whose rows are red and grey.
    fn shown(format: wgpu::TextureFormat) -> Vec<[u8; 4]> {
        let gpu = Gpu::open(None, ShaderChecks::Checked).expect("the tests need an adapter");
        let texture = |format, usage| {
            gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: None,
                size: wgpu::Extent3d {
                    width: SIZE[0],
                    height: SIZE[1],
                    depth_or_array_layers: 1,
                },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage,
                view_formats: &[],
            })
        };
        let picture = texture(
            wgpu::TextureFormat::Rgba8Unorm,
            wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        );
        let texels = [[[255u8, 0, 0, 255]; 4], [[100, 100, 100, 255]; 4]];
        gpu.queue.write_texture(
            picture.as_image_copy(),
            bytemuck::cast_slice(&texels),
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(SIZE[0] * 4),
                rows_per_image: None,
            },
            picture.size(),
        );
        let target = texture(
            format,
            wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        );
        let mut overlay = Overlay::new(&gpu, format).expect("the shader compiles");
        let mut recorder = Recorder::new(&gpu, None);
        let nothing = PanelShapes {
            primitives: Vec::new(),
            textures: Default::default(),
            pixels_per_point: 1.0,
        };
        let view = target.create_view(&Default::default());
        overlay.record(&gpu, &mut recorder, &picture, &view, SIZE, nothing);
        recorder.submit(&gpu).expect("the device works");
        gpu.read_texture(&target).expect("the device works")
    }

    #[test]
    fn windows_of_either_kind_show_the_bytes_of_the_picture() {
        for format in [
            wgpu::TextureFormat::Rgba8Unorm,
            wgpu::TextureFormat::Rgba8UnormSrgb,
        ] {
            let texels = shown(format);
            assert_eq!(texels[..4], [[255, 0, 0, 255]; 4], "{format:?}");
            assert_eq!(texels[4..], [[100, 100, 100, 255]; 4], "{format:?}");
        }
    }
}
