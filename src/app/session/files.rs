//! Files that are read again when they are edited.

use std::time::Instant;

use super::Session;
use crate::app::{input::Input, texts::toasts};

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
                self.messages.toast(toasts::SHADERS);
            }
            self.remade();
        }
        if world {
            self.world_watch.follow_world();
            self.give(Input::Reload);
        }
    }
}
