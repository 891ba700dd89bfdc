//! What a window begins with: the clock, and the world on the GPU.

use crate::{
    app::{
        Options,
        clock::WorldClock,
        messages::Messages,
        saving::clock_of,
        viewport::{Choice, Viewport},
    },
    frame::FrameError,
    gpu::{Gpu, GpuError, ShaderLibrary},
};

/// World time at the start: that of the save, if the run continues one.
pub(super) fn first_clock(options: &Options) -> WorldClock {
    let continued = options.saves.continued.as_ref();
    let saved = continued.map(|(_, save)| clock_of(save));
    let clock = saved.unwrap_or_default();
    WorldClock {
        paused: clock.paused || options.traced,
        ..clock
    }
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
