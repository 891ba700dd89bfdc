//! What a window begins with: the world on the GPU.

use crate::{
    app::{
        Options,
        messages::Messages,
        viewport::{Choice, Viewport},
    },
    frame::FrameError,
    gpu::{Gpu, GpuError, ShaderLibrary},
};

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
