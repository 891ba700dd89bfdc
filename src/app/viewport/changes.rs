//! What was changed about the voxels of a world, while the world is built again, and for saves.

use super::Viewport;
use crate::{
    app::texts::toasts,
    frame::FrameError,
    world::{
        World,
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
