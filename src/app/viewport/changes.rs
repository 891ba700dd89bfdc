//! What was changed about the voxels of a world, while the world is built again, and for saves.

use glam::IVec3;

use super::Viewport;
use crate::{
    app::texts::toasts,
    frame::FrameError,
    world::{
        LampPreset, PlacedLamp, World, placed,
        voxels::{Overlay, Voxels},
    },
};

impl Viewport {
    /// What a person should know about the world and has not been told yet.
    pub fn take_notes(&mut self) -> Vec<String> {
        std::mem::take(&mut self.world.restored.notes)
    }

    /// Everything that was changed about the voxels of the world file, now or in an earlier run.
    ///
    /// # Errors
    /// [`FrameError`] when the voxels must be read back and the device is lost.
    pub fn overlay(&mut self) -> Result<Overlay, FrameError> {
        self.voxels()?;
        Ok(Self::all_changes(&self.world, self.voxels.as_ref()))
    }

    /// The lamps that the player has placed, in the order of placing: lights of the next frame, if they are on.
    pub fn placed_lamps(&self) -> &[PlacedLamp] {
        &self.world.restored.lamps
    }

    /// Places, changes or removes the lamp of a voxel (world space). It stays when the world is built again.
    ///
    /// # Errors
    /// [`FrameError`] when the lamp is the first sphere of the world and the adapter cannot hold the passes for it; then
    /// nothing changes.
    pub fn put_lamp(&mut self, voxel: IVec3, lamp: Option<PlacedLamp>) -> Result<(), FrameError> {
        if lamp.is_some_and(|lamp| lamp.block.is_soft()) {
            self.frame.allow_spheres(&self.gpu)?;
        }
        placed::put(&mut self.world.restored.lamps, voxel, lamp);
        Ok(())
    }

    /// The lamps of the chosen preset, up to the number that the parameters allow.
    pub(super) fn lamps(&self) -> LampPreset {
        let parameters = &self.choice.parameters.lights;
        let presets = &self.world.lamp_presets;
        let chosen = presets
            .iter()
            .find(|preset| preset.name == parameters.preset);
        let mut lamps = chosen
            .unwrap_or_else(|| presets.first().expect("a world has a lamp preset"))
            .clone();
        lamps.lamps.truncate(parameters.max_lamps as usize);
        lamps
    }

    fn all_changes(world: &World, voxels: Option<&Voxels>) -> Overlay {
        let mut all = world.restored.overlay.clone();
        if let Some(voxels) = voxels {
            all.extend(&voxels.overlay());
        }
        all
    }

    /// Gives a world that takes the place of this one all changes that fit it.
    pub(super) fn carry_changes(&self, world: &mut World) {
        let old = &self.world;
        let renumbered = |material: u8| {
            let name = &old.materials.get(usize::from(material) - 1)?.name;
            let mut materials = world.materials.iter();
            let place = materials.position(|known| known.name == *name)?;
            u8::try_from(place + 1).ok()
        };
        let shift = old.origin - world.origin;
        let overlay = Self::all_changes(old, self.voxels.as_ref());
        let (overlay, lost) = overlay.fitted(world.size, shift, renumbered);
        let [lost_bodies, _] = (world.bodies).take_changes(&old.bodies.changes(), renumbered);
        world.restored.overlay = overlay;
        if lost > 0 {
            world.restored.notes.push(toasts::lost_voxels(lost));
        }
        if lost_bodies > 0 {
            let note = toasts::lost_bodies(lost_bodies);
            world.restored.notes.push(note);
        }
        world
            .restored
            .take_lamps(&old.restored.lamps, world.origin, world.size);
    }
}
