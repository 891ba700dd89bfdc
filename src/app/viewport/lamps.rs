//! The lamps of a world that the window shows: those of the chosen preset, and those that the player has placed.

use glam::IVec3;

use super::{Choice, Viewport};
use crate::{
    frame::{FrameError, Stage},
    gpu::Gpu,
    lights::LampKinds,
    world::{LampPreset, PlacedLamp, World, placed},
};

impl Viewport {
    /// The lamps that the player has placed, in the order of placing: lights of the next frame, if they are on.
    pub fn placed_lamps(&self) -> &[PlacedLamp] {
        &self.world.restored.lamps
    }

    /// Places, changes or removes the lamp of a voxel (world space). It stays when the world is built again.
    ///
    /// # Errors
    /// [`FrameError`] when the world needs another [kind of lamps](LampKinds) now and the adapter cannot hold the passes for it;
    /// then nothing changes.
    pub fn put_lamp(&mut self, voxel: IVec3, lamp: Option<PlacedLamp>) -> Result<(), FrameError> {
        let mut lamps = self.world.restored.lamps.clone();
        placed::put(&mut lamps, voxel, lamp);
        let kinds = LampKinds::of_lamps(&self.world, &self.lamps().lamps, &lamps);
        self.frame.allow_lamps(&self.gpu, kinds)?;
        self.world.restored.lamps = lamps;
        Ok(())
    }

    /// Lets the frame show the lamps of another choice.
    ///
    /// # Errors
    /// [`FrameError`] when the adapter cannot hold the passes for them; then nothing changes.
    pub(super) fn allow_lamps_of(&mut self, choice: &Choice) -> Result<(), FrameError> {
        let kinds = kinds(&self.world, choice);
        self.frame.allow_lamps(&self.gpu, kinds)
    }

    /// The lamps of the chosen preset, up to the number that the parameters allow.
    pub(super) fn lamps(&self) -> LampPreset {
        lamps(&self.world, &self.choice)
    }
}

/// A world's stage, whose kernels know no lists of lamps unless the choice shows so many.
///
/// # Errors
/// [`FrameError`] when the adapter cannot hold it.
pub(super) fn stage(gpu: &Gpu, world: &World, choice: &Choice) -> Result<Stage, FrameError> {
    let mut stage = Stage::build(gpu, world)?;
    stage.lamp_kinds.lists = kinds(world, choice).lists;
    Ok(stage)
}

fn kinds(world: &World, choice: &Choice) -> LampKinds {
    LampKinds::of_lamps(world, &lamps(world, choice).lamps, &world.restored.lamps)
}

fn lamps(world: &World, choice: &Choice) -> LampPreset {
    let parameters = &choice.parameters.lights;
    let presets = &world.lamp_presets;
    let chosen = presets
        .iter()
        .find(|preset| preset.name == parameters.preset);
    let mut lamps = chosen
        .unwrap_or_else(|| presets.first().expect("a world has a lamp preset"))
        .clone();
    lamps.lamps.truncate(parameters.max_lamps as usize);
    lamps
}
