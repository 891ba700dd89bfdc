//! Files that are read again when they are edited, and what a window begins with.

use std::time::Instant;

use super::Session;
use crate::{
    app::{
        Options,
        clock::WorldClock,
        input::Input,
        messages::Messages,
        saving::clock_of,
        viewport::{Choice, Viewport},
    },
    frame::FrameError,
    gpu::{Gpu, GpuError, ShaderLibrary},
};

impl Session {
    pub(super) fn follow_files(&mut self, now: Instant) {
        let world = self.world_watch.changed(now);
        let shaders = match &mut self.shaders {
            Some((_, watch)) => watch.changed(now),
            None => false,
        };
        self.reload(world, shaders);
    }

    pub(super) fn reload(&mut self, world: bool, shaders: bool) {
        if shaders && let Some((folder, _)) = &self.shaders {
            let reloaded = self
                .viewport
                .reload_shaders(folder)
                .and_then(|()| Ok(self.overlay.rebuild(&self.viewport.gpu)?));
            self.messages.shaders = reloaded.err().map(|error| error.to_string());
            if self.messages.shaders.is_none() {
                self.messages.toast("shaders compiled");
            }
            self.remade();
        }
        if world {
            self.world_watch.follow_world();
            self.give(Input::Reload);
        }
    }
}

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
