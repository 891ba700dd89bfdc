//! The window saves: at Ctrl+S, every minute, and at its end.

use std::{path::PathBuf, time::Instant};

use super::{
    super::saving::{Kept, clock_of},
    Session,
    play::Play,
};
use crate::{
    app::{
        AppError, Options, clock::WorldClock, panel::Settings, record::assignments,
        viewport::Viewport,
    },
    world::save::State,
};

impl Session {
    /// Saves because the user wants it.
    pub(super) fn save(&mut self) {
        match self.kept() {
            Ok(kept) => self.saving.save(kept, &mut self.messages),
            Err(error) => self.messages.toast_error(error.to_string()),
        }
    }

    /// Says what became of the last save, and begins the next when it is due.
    pub(super) fn save_now_and_then(&mut self, now: Instant) {
        self.saving.hear(&mut self.messages);
        if self.saving.is_due(now) {
            match self.kept() {
                Ok(kept) => self.saving.save_changes(kept, &mut self.messages),
                Err(error) => self.messages.toast_error(error.to_string()),
            }
        }
    }

    /// Saves at the end of the run. Returns the file that was written.
    ///
    /// # Errors
    /// [`AppError`] when it cannot be written.
    pub fn save_at_end(&mut self) -> Result<Option<PathBuf>, AppError> {
        let kept = self.kept()?;
        Ok(self.saving.finish(kept)?)
    }

    pub(super) fn kept(&mut self) -> Result<Kept, AppError> {
        kept(&mut self.viewport, &self.play, &self.settings)
    }
}

/// What a save keeps of a run at this moment.
///
/// # Errors
/// [`AppError`] when the voxels must be read back and the device is lost.
pub(super) fn kept(
    viewport: &mut Viewport,
    play: &Play,
    settings: &Settings,
) -> Result<Kept, AppError> {
    let view = play.player.view(&viewport.ground()?);
    let overlay = viewport.overlay()?;
    let clock = &settings.clock;
    let (world, choice) = (viewport.world(), viewport.choice());
    let state = State {
        time_s: clock.time_s,
        paused: clock.paused,
        rate: clock.rate,
        eye: view.position.to_array(),
        yaw_deg: view.yaw_deg,
        pitch_deg: view.pitch_deg,
        fov_deg: view.fov_deg,
        layout: choice.layout.clone(),
        // What the preset sets belongs to the machine.
        set: assignments(&settings.preset.without(&choice.parameters)),
        materials: world
            .materials
            .iter()
            .map(|known| known.name.clone())
            .collect(),
        origin: world.origin.to_array(),
        hotbar: play.hands.hotbar.saved(world),
    };
    Ok(Kept {
        state,
        overlay,
        lamps: viewport.placed_lamps().to_vec(),
        bodies: viewport.world().bodies.changes(),
    })
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
