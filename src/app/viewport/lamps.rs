//! The lamps of a world that the window shows: those of the chosen preset, and those that the player has placed.

use glam::IVec3;

use super::{Choice, Viewport};
use crate::{
    frame::{FrameError, Stage},
    gpu::Gpu,
    lights::{LampKinds, RhythmsTold},
    world::{Lamp, LampPreset, PlacedLamp, World, placed},
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
        let before = placed::at(&self.world.restored.lamps, voxel).copied();
        placed::put(&mut self.world.restored.lamps, voxel, lamp);
        let kinds = kinds(&self.world, &self.choice);
        if let Err(error) = self.frame.allow_lamps(&self.gpu, kinds) {
            placed::put(&mut self.world.restored.lamps, voxel, before);
            return Err(error);
        }
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
        let (name, lamps) = chosen(&self.world, &self.choice);
        LampPreset {
            name: name.to_owned(),
            lamps: lamps.to_vec(),
        }
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
    LampKinds {
        // To hang a torch makes no kernels anew: light that they cannot tell apart is followed as it comes.
        rhythms: RhythmsTold::None,
        ..LampKinds::of_lamps(world, chosen(world, choice).1)
    }
}

/// The name of the chosen preset, and its lamps up to the number that the parameters allow.
fn chosen<'a>(world: &'a World, choice: &Choice) -> (&'a str, &'a [Lamp]) {
    let parameters = &choice.parameters.lights;
    let presets = &world.lamp_presets;
    let preset = presets
        .iter()
        .find(|preset| preset.name == parameters.preset)
        .unwrap_or_else(|| presets.first().expect("a world has a lamp preset"));
    let count = preset.lamps.len().min(parameters.max_lamps as usize);
    (&preset.name, &preset.lamps[..count])
}
