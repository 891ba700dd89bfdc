//! What a stroke does: it digs, places and picks voxels and lamps.

use super::Run;
use crate::{
    app::{
        AppError,
        hands::{
            Changes, Item,
            aim::{Reach, Target},
            brush::{Stroke, Stroked},
            lamps::{self, LampChange},
        },
        sound::Kind,
        texts::toasts,
        viewport::Viewport,
    },
    world::{Camera, World, voxels::Voxels},
};

/// Whether a stroke is the first of its button, or one of those while it is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Turn {
    First,
    Repeated,
}

impl Run<'_> {
    /// Makes a stroke where the player looks. Returns whether voxels changed.
    pub(super) fn stroke(&mut self, stroke: Stroke, turn: Turn) -> Result<bool, AppError> {
        let camera = self.view()?;
        let reach = Reach::of(self.player.body());
        self.follow_build();
        let Some(target) = self.viewport.aim(&reach, &camera)? else {
            if turn == Turn::First && stroke != Stroke::Pick {
                self.tell_miss(&reach, &camera)?;
            }
            return Ok(false);
        };
        let world = self.viewport.world();
        let lamp = lamps::met(world, &target).copied();
        match (stroke, lamp) {
            (Stroke::Pick, Some(lamp)) => self.hands.hotbar.pick(Item::Lamp(lamp.block)),
            (Stroke::Pick, None) => self.hands.hotbar.pick(Item::Material(target.material)),
            (Stroke::Dig, Some(lamp)) => self.change_lamp(lamps::dug(&lamp)),
            (Stroke::Dig, None) => {
                let brush = self.settings.brush;
                let is_dug = self.edit(|voxels, _| brush.dig(voxels, target.voxel));
                if is_dug {
                    self.burst(&camera);
                }
                return Ok(is_dug);
            }
            (Stroke::Replace, Some(_)) => {}
            (Stroke::Replace, None) => return Ok(self.replace(&target)),
            // One press hangs or switches one lamp.
            (Stroke::Place, Some(lamp)) if turn == Turn::First => {
                self.change_lamp(lamps::switched(&lamp));
            }
            (Stroke::Place, Some(_)) => {}
            (Stroke::Place, None) => return self.place(&target, &camera, &reach, turn),
        }
        Ok(false)
    }

    /// Says why the hands meet no voxel.
    pub(super) fn tell_miss(&mut self, reach: &Reach, camera: &Camera) -> Result<(), AppError> {
        if !self.tell_body(reach, camera)? {
            self.messages.hint(toasts::OUT_OF_REACH);
        }
        Ok(())
    }

    /// Places what is in the hand. Returns whether voxels changed.
    fn place(
        &mut self,
        target: &Target,
        camera: &Camera,
        reach: &Reach,
        turn: Turn,
    ) -> Result<bool, AppError> {
        match self.hands.hotbar.item() {
            Some(Item::Material(material)) => {
                let Some(at) = target.before() else {
                    return Ok(false);
                };
                let brush = self.settings.brush;
                let free = self.viewport.free_bodies().clone();
                Ok(self.edit(|voxels, world| {
                    let (low, high) = reach.kept(world.origin, camera);
                    let hung = lamps::occupied(world);
                    let region = [at - brush.reach(), at + brush.reach()];
                    let region = region.map(|at| at + world.origin);
                    let taken = free.within(&world.bodies, region, None);
                    brush.place(voxels, at, material, |voxel| {
                        let is_of_body = voxel.cmpge(low).all() && voxel.cmple(high).all();
                        is_of_body || hung.contains(&voxel) || taken.has(voxel + world.origin)
                    })
                }))
            }
            Some(Item::Lamp(block)) if turn == Turn::First => {
                let eye = camera.position.floor().as_ivec3();
                let (voxels, world) = self.viewport.voxels_and_world()?;
                match lamps::hung(block, voxels, world, target, eye) {
                    Ok(change) => self.change_lamp(change),
                    Err(reason) => self.messages.toast(reason),
                }
                Ok(false)
            }
            Some(Item::Lamp(_)) => Ok(false),
            None => {
                self.messages.hint(toasts::EMPTY_SLOT);
                Ok(false)
            }
        }
    }

    /// Gives voxels the material in the hand. Returns whether voxels changed.
    fn replace(&mut self, target: &Target) -> bool {
        let Some(Item::Material(material)) = self.hands.hotbar.item() else {
            self.messages.toast(toasts::REPLACING);
            return false;
        };
        let brush = self.settings.brush;
        self.edit(|voxels, _| brush.replace(voxels, target.voxel, material))
    }

    fn change_lamp(&mut self, change: LampChange) {
        if let Err(error) = self.viewport.put_lamp(change.voxel, change.after) {
            self.messages.toast_error(error.to_string());
            return;
        }
        self.noise_of_lamp(match (change.before, change.after) {
            (Some(_), Some(_)) => Kind::Switch,
            (Some(_), None) => Kind::Dig,
            (None, _) => Kind::Place,
        });
        self.hands.history.push(Changes::of_lamp(change));
    }

    /// Changes voxels by a stroke. Returns whether there were any to change.
    pub(super) fn edit(&mut self, stroke: impl FnOnce(&mut Voxels, &World) -> Stroked) -> bool {
        let mut changes = Changes::default();
        let edited = self.viewport.edit(|voxels, world| {
            let stroked = stroke(voxels, world);
            changes = stroked.changes;
            stroked.edit
        });
        if let Err(error) = edited {
            self.messages.toast_error(error.to_string());
            return false;
        }
        let edited = !changes.is_empty();
        if edited {
            self.noise_of(&changes);
        }
        self.hands.history.push(changes);
        edited
    }

    pub(super) fn follow_build(&mut self) {
        let build = self.viewport.build();
        self.hands.follow(self.viewport.world(), build);
    }
}

impl Viewport {
    /// What a stroke where `camera` looks would meet: nothing behind a body.
    ///
    /// # Errors
    /// [`AppError`] when the voxels must be read back and the device is lost.
    pub fn aim(&mut self, reach: &Reach, camera: &Camera) -> Result<Option<Target>, AppError> {
        let distance = self.reach_ahead(reach, camera);
        let (voxels, world) = self.voxels_and_world()?;
        let reach = Reach { distance, ..*reach };
        Ok(reach.aim(voxels, &world.restored.lamps, world.origin, camera))
    }
}
