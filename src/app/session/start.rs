//! What a window begins with: an adapter that presents there, and the world on the GPU.

use std::sync::Arc;

use winit::window::Window;

use crate::{
    app::{
        AppError, Options,
        messages::Messages,
        screen,
        viewport::{Choice, Viewport},
    },
    frame::FrameError,
    gpu::{self, Gpu, GpuError, ShaderChecks, ShaderLibrary},
};

/// The adapter that was opened before there was a window, or another one if that cannot present to this window.
pub(super) fn open_gpu(
    window: &Arc<Window>,
    options: &Options,
) -> Result<(Gpu, wgpu::Surface<'static>), AppError> {
    let opened = options.opened.take();
    let instance = opened.as_ref().map(|gpu| gpu.instance.clone());
    let instance = instance.unwrap_or_else(gpu::instance);
    let surface = screen::surface(&instance, window)?;
    if let Some(gpu) = opened.filter(|gpu| gpu.adapter.is_surface_supported(&surface)) {
        return Ok((gpu, surface));
    }
    let adapter = options.adapter.as_deref();
    let gpu = Gpu::open_with(instance, adapter, Some(&surface), ShaderChecks::default())?;
    Ok((gpu, surface))
}

/// The first viewport: with the shaders of a folder if they compile, else with those of the binary.
pub(super) fn build(
    gpu: &Gpu,
    options: &Options,
    choice: Choice,
    messages: &mut Messages,
) -> Result<Viewport, FrameError> {
    let new = |gpu: Gpu| {
        let world = options.world.clone();
        Viewport::new(gpu, &options.world_path, world, choice.clone())
    };
    if let Some(folder) = &options.shaders {
        let shown = ShaderLibrary::from_folder(folder)
            .map_err(FrameError::from)
            .and_then(|shaders| new(gpu.with_shaders(shaders)));
        match shown {
            Err(FrameError::Gpu(error @ GpuError::Shader { .. })) => {
                messages.shaders = Some(error.to_string());
            }
            shown => return shown,
        }
    }
    new(gpu.clone())
}
