//! What a run does with its clipboard.

use std::collections::BTreeMap;

use glam::IVec3;

use super::Run;
use crate::app::{
    AppError,
    hands::{
        aim::{Reach, Target},
        clipboard::{Clip, Copied, MOST_EDGE, Pasted, size_text},
        lamps,
    },
    texts::toasts,
};

impl Run<'_> {
    /// Marks, copies, turns or pastes. Returns whether voxels changed.
    ///
    /// # Errors
    /// [`AppError`] when the device fails.
    pub fn clip(&mut self, clip: Clip) -> Result<bool, AppError> {
        let clipboard = &mut self.hands.clipboard;
        match clip {
            Clip::Mark => self.mark()?,
            Clip::Paste => return self.paste(),
            Clip::Lift => return self.lift(),
            Clip::Settle => return self.settle(),
            Clip::Turn => {
                if let Some(copied) = clipboard.copied.as_mut().filter(|_| clipboard.is_out) {
                    *copied = copied.turned();
                    let size = size_text(copied.size());
                    self.messages.toast(format!("Turned: {size}"));
                }
            }
            Clip::Air => {
                clipboard.with_air = !clipboard.with_air;
                self.messages.hint(match clipboard.with_air {
                    true => toasts::WITH_AIR,
                    false => toasts::WITHOUT_AIR,
                });
            }
            Clip::Cancel => {
                clipboard.is_out &= clipboard.corner.take().is_some();
            }
        }
        Ok(false)
    }

    pub(super) fn target(&mut self) -> Result<Option<Target>, AppError> {
        let camera = self.view()?;
        let reach = Reach::of(self.player.body());
        let target = self.viewport.aim(&reach, &camera)?;
        if target.is_none() {
            self.tell_miss(&reach, &camera)?;
        }
        Ok(target)
    }

    fn mark(&mut self) -> Result<(), AppError> {
        let Some(target) = self.target()? else {
            return Ok(());
        };
        let world = self.viewport.world();
        let (origin, materials) = (world.origin, world.materials.clone());
        let clipboard = &mut self.hands.clipboard;
        let Some(corner) = clipboard.corner else {
            let corner = target.voxel + origin;
            clipboard.corner = Some(corner);
            self.messages.hint(toasts::corner(&place_text(corner)));
            return Ok(());
        };
        let corner = corner - origin;
        let (low, high) = (corner.min(target.voxel), corner.max(target.voxel));
        let size = high - low + 1;
        if size.max_element() > MOST_EDGE {
            let text = toasts::too_large(&size_text(size), MOST_EDGE);
            self.messages.toast_error(text);
            return Ok(());
        }
        let copied = Copied::of(self.viewport.voxels()?, &materials, low, high);
        self.messages.hint(toasts::copied(
            &size_text(size),
            &place_text(low + origin),
            copied.solid(),
        ));
        let clipboard = &mut self.hands.clipboard;
        clipboard.corner = None;
        clipboard.copied = Some(copied);
        clipboard.is_out = true;
        Ok(())
    }

    fn paste(&mut self) -> Result<bool, AppError> {
        let clipboard = &mut self.hands.clipboard;
        clipboard.corner = None;
        let with_air = clipboard.with_air;
        let Some(copied) = clipboard.copied.clone() else {
            self.messages.hint(toasts::NO_COPY);
            return Ok(false);
        };
        if !std::mem::replace(&mut clipboard.is_out, true) {
            return Ok(false);
        }
        let Some(target) = self.target()? else {
            return Ok(false);
        };
        self.follow_build();
        let camera = self.view()?;
        let reach = Reach::of(self.player.body());
        let free = self.viewport.free_bodies().clone();
        let mut pasted = Pasted::default();
        let changed = self.edit(|voxels, world| {
            let (low, high) = reach.kept(world.origin, &camera);
            let hung = lamps::occupied(world);
            let around = MOST_EDGE + 1;
            let region = [target.voxel - around, target.voxel + around].map(|at| at + world.origin);
            let taken = free.within(&world.bodies, region, None);
            let is_kept = |voxel: IVec3| {
                let is_of_body = voxel.cmpge(low).all() && voxel.cmple(high).all();
                is_of_body || hung.contains(&voxel) || taken.has(voxel + world.origin)
            };
            pasted = copied.paste(voxels, &world.materials, &target, with_air, is_kept);
            std::mem::take(&mut pasted.stroked)
        });
        let at = target.before().unwrap_or(target.voxel) + self.viewport.world().origin;
        self.tell_pasted(&pasted, at);
        self.tell_missing(&pasted.missing);
        Ok(changed)
    }

    fn tell_pasted(&mut self, pasted: &Pasted, at: IVec3) {
        let text = toasts::pasted(&place_text(at), pasted.changed, pasted.outside);
        self.messages.toast(text);
    }

    /// Says which materials of a copy this world lacks.
    pub(super) fn tell_missing(&mut self, missing: &BTreeMap<String, u64>) {
        if !missing.is_empty() {
            let names: Vec<&str> = missing.keys().map(|name| &**name).collect();
            let voxels: u64 = missing.values().sum();
            let text = toasts::no_material(&names.join(", "), voxels);
            self.messages.toast_error(text);
        }
    }
}

/// `(x, y, z)`, in world space.
pub(super) fn place_text(voxel: IVec3) -> String {
    format!("({}, {}, {})", voxel.x, voxel.y, voxel.z)
}
