//! What a run does with free bodies: it lifts them out of the world, sets them into it, and lets the player push them.

use std::sync::Arc;

use glam::{DVec3, IVec3, Vec3};

use super::Run;
use crate::{
    app::{
        AppError,
        body::{Measures, free::Taken},
        hands::{
            Changes,
            aim::Reach,
            clipboard::size_text,
            lamps,
            lift::{self, BodyChange},
        },
        player::STEP_S,
        run::clip::place_text,
        texts::bodies as texts,
        viewport::Viewport,
    },
    world::{
        Camera,
        bodies::{BodyModel, MAX_BODIES, MAX_BODY_EDGE, PlacedBody, WholeBody},
        voxels::{Edit, Voxels},
    },
};

impl Run<'_> {
    /// Simulates the player until this time (nanoseconds). Before each of his steps free bodies make theirs.
    pub(super) fn advance_player(&mut self, to_ns: u64) -> Result<(), AppError> {
        if self.viewport.free_bodies().exist() {
            while self.player.next_step_ns() <= to_ns {
                let end_ns = self.player.next_step_ns();
                let measures: Measures = self.player.body().measures;
                let pusher = self.player.pusher();
                let moved =
                    (self.viewport).step_bodies(end_ns, pusher.as_ref(), &measures, STEP_S)?;
                self.player.push(moved.pushed);
                self.player.advance(end_ns, &self.viewport.ground()?);
            }
        } else {
            self.player.push(DVec3::ZERO);
        }
        self.player.advance(to_ns, &self.viewport.ground()?);
        Ok(())
    }

    /// Makes a body of the marked box or of what the brush covers; or places the copy as one. Returns whether voxels
    /// changed.
    ///
    /// # Errors
    /// [`AppError`] when the device fails.
    pub(super) fn lift(&mut self) -> Result<bool, AppError> {
        let clipboard = &self.hands.clipboard;
        if clipboard.corner.is_none() && clipboard.is_out {
            return self.place_copy();
        }
        let Some(target) = self.target()? else {
            return Ok(false);
        };
        self.follow_build();
        let brush = self.settings.brush;
        let corner = self.hands.clipboard.corner;
        let (voxels, world) = self.viewport.voxels_and_world()?;
        let corner = corner.map(|corner| corner - world.origin);
        let of_box = corner.map(|corner| [corner.min(target.voxel), corner.max(target.voxel)]);
        let reach = IVec3::splat(brush.reach());
        let [low, high] = of_box.unwrap_or([target.voxel - reach, target.voxel + reach]);
        let size = high - low + 1;
        if size.max_element() > MAX_BODY_EDGE as i32 {
            let text = texts::too_large(&size_text(size), MAX_BODY_EDGE);
            self.messages.toast_error(text);
            return Ok(false);
        }
        let is_lifted = |voxel: IVec3| corner.is_some() || brush.covers(voxel - target.voxel);
        let Some((model, at)) = lift::model_of(voxels, [low, high], is_lifted) else {
            self.messages.hint_error(texts::EMPTY);
            return Ok(false);
        };
        let corner_ws = at + world.origin;
        let Some(change) = self.placed(model, corner_ws) else {
            return Ok(false);
        };
        let is_done = self.change_body(change, |voxels| {
            Changes::make(
                voxels,
                low,
                high,
                |voxel, old| {
                    if is_lifted(voxel) { 0 } else { old }
                },
            )
        });
        if is_done {
            self.hands.clipboard.corner = None;
        }
        Ok(is_done)
    }

    /// Places the copy as a body, where it would be pasted.
    fn place_copy(&mut self) -> Result<bool, AppError> {
        let Some(copied) = self.hands.clipboard.copied.clone() else {
            return Ok(false);
        };
        let Some(target) = self.target()? else {
            return Ok(false);
        };
        self.follow_build();
        let (body, missing) = copied.as_body(&self.viewport.world().materials, &target);
        self.tell_missing(&missing);
        let Some((model, low)) = body else {
            return Ok(false);
        };
        let corner_ws = low + self.viewport.world().origin;
        if !self.has_room(&model, corner_ws, None)? {
            self.messages.toast_error(texts::NO_ROOM);
            return Ok(false);
        }
        if let Some(change) = self.placed(model, corner_ws) {
            self.change_body(change, |_| Default::default());
        }
        Ok(false)
    }

    /// Sets the body aimed at into the world, at the nearest whole place with room. Returns whether voxels changed.
    ///
    /// # Errors
    /// [`AppError`] when the device fails.
    pub(super) fn settle(&mut self) -> Result<bool, AppError> {
        let camera = self.view()?;
        let reach = Reach::of(self.player.body());
        self.follow_build();
        let Some(ahead) = self.viewport.aim_at_body(&reach, &camera)? else {
            self.messages.hint(texts::NONE);
            return Ok(false);
        };
        let Some((index, model, corner)) = self.free_body(&ahead) else {
            self.messages.toast(texts::NOT_FREE);
            return Ok(false);
        };
        let mut place = None;
        for at in lift::whole_places(corner) {
            if place.is_none() && self.has_room(&model, at, Some(index))? {
                place = Some(at);
            }
        }
        let Some(at) = place else {
            self.messages.toast_error(texts::NO_ROOM_TO_SET);
            return Ok(false);
        };
        let low = at - self.viewport.world().origin;
        let high = low + model.size.as_ivec3() - 1;
        let change = BodyChange::of(Some(self.viewport.world().bodies.whole(index)), None);
        let is_done = self.change_body(change, |voxels| {
            Changes::make(voxels, low, high, |voxel, old| {
                match model.material(voxel - low) {
                    0 => old,
                    material => material,
                }
            })
        });
        if is_done {
            self.messages.toast(texts::settled(&place_text(at)));
        }
        Ok(is_done)
    }

    /// A free body's index, its model as it stands in the world, and the lowest corner of that (world space).
    fn free_body(&self, ahead: &Ahead) -> Option<(usize, BodyModel, Vec3)> {
        let index = ahead.free?;
        let (model, corner) = self.viewport.world().bodies.whole(index).upright()?;
        Some((index, model, corner))
    }

    /// Says that nothing can be done to the body aimed at, if one is.
    ///
    /// # Errors
    /// [`AppError`] when the device fails.
    pub(super) fn tell_body(&mut self, reach: &Reach, camera: &Camera) -> Result<bool, AppError> {
        let ahead = self.viewport.aim_at_body(reach, camera)?;
        match ahead {
            Some(Ahead { free: Some(_), .. }) => self.messages.hint(texts::SET_FIRST),
            Some(Ahead { free: None, .. }) => self.messages.toast(texts::NOT_FREE),
            None => {}
        }
        Ok(ahead.is_some())
    }

    /// A new body, unless the world holds no more: then the reason is said.
    fn placed(&mut self, model: BodyModel, corner_ws: IVec3) -> Option<BodyChange> {
        let bodies = &self.viewport.world().bodies;
        if !bodies.has_room_for(&model) {
            let text = match bodies.bodies.len() {
                MAX_BODIES.. => texts::too_many(MAX_BODIES),
                _ => texts::VOXELS.to_owned(),
            };
            self.messages.hint_error(text);
            return None;
        }
        let placed = PlacedBody {
            name: bodies.free_name(),
            model: Arc::new(model),
            corner: corner_ws.as_vec3(),
        };
        Some(BodyChange::of(None, Some(WholeBody::placed(&placed))))
    }

    /// Whether a model has room at a place (world space), beside the player, lamps and bodies other than `except`.
    fn has_room(
        &mut self,
        model: &BodyModel,
        corner_ws: IVec3,
        except: Option<usize>,
    ) -> Result<bool, AppError> {
        let camera = self.view()?;
        let reach = Reach::of(self.player.body());
        let region = [corner_ws, corner_ws + model.size.as_ivec3() - 1];
        let bodies = &self.viewport.world().bodies;
        let taken: Taken = self.viewport.free_bodies().within(bodies, region, except);
        let (voxels, world) = self.viewport.voxels_and_world()?;
        let (low, high) = reach.kept(world.origin, &camera);
        let hung = lamps::occupied(world);
        let is_kept = |voxel: IVec3| {
            let is_of_player = voxel.cmpge(low).all() && voxel.cmple(high).all();
            is_of_player || hung.contains(&voxel) || taken.has(voxel + world.origin)
        };
        let low = corner_ws - world.origin;
        Ok(lift::has_room(voxels, model, low, is_kept))
    }

    /// Places or removes a body and changes the voxels, as one stroke. Returns whether that was done.
    fn change_body(
        &mut self,
        change: BodyChange,
        edit: impl FnOnce(&mut Voxels) -> (Edit, Changes),
    ) -> bool {
        let mut changes = Changes::default();
        let viewport = &mut *self.viewport;
        let done = viewport
            .put_body(&change.name, change.after.as_ref())
            .and_then(|()| {
                let edited = viewport.edit(|voxels, _| {
                    let edited;
                    (edited, changes) = edit(voxels);
                    edited
                });
                if edited.is_err() {
                    viewport.put_body(&change.name, change.before.as_ref())?;
                }
                edited
            });
        if let Err(error) = done {
            self.messages.toast_error(error.to_string());
            return false;
        }
        self.noise_of(&changes);
        if let Some(body) = &change.after {
            let size = size_text(body.model.size.as_ivec3());
            self.messages.hint(texts::lifted(&size));
        }
        if self.viewport.bodies_wait() {
            self.messages.toast(texts::IN_A_MOMENT);
        }
        self.hands.history.push(changes.with_body(change));
        true
    }
}

/// The body that a camera looks at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ahead {
    /// Which free body it is; `None` for one that moves by itself, or stands at an angle.
    pub free: Option<usize>,
    /// From the camera (voxels).
    pub distance: f64,
}

impl Viewport {
    /// The body that a camera looks at, whatever voxels are before it.
    fn body_ahead(&self, camera: &Camera) -> Option<Ahead> {
        let basis = camera.basis(1.0);
        let bodies = &self.world().bodies;
        let direction = basis.forward.normalize();
        let free = self.free_bodies().met(bodies, basis.origin, direction);
        let free = free.map(|(index, distance)| Ahead {
            free: Some(index),
            distance,
        });
        let others = self.free_bodies().others(bodies, self.now_s());
        let other = others.met(basis.origin, direction);
        let other = other.map(|distance| Ahead {
            free: None,
            distance,
        });
        let both = free.into_iter().chain(other);
        both.min_by(|a, b| a.distance.total_cmp(&b.distance))
    }

    /// How far a hand reaches where a camera looks: to the body there, if one is within reach (voxels).
    pub(super) fn reach_ahead(&self, reach: &Reach, camera: &Camera) -> f64 {
        let body = self.body_ahead(camera);
        body.map_or(reach.distance, |body| reach.distance.min(body.distance))
    }

    /// The body that a camera looks at within reach, with nothing before it.
    ///
    /// # Errors
    /// [`AppError`] when the voxels must be read back and the device is lost.
    pub fn aim_at_body(
        &mut self,
        reach: &Reach,
        camera: &Camera,
    ) -> Result<Option<Ahead>, AppError> {
        let ahead = self.body_ahead(camera);
        let Some(body) = ahead.filter(|body| body.distance <= reach.distance) else {
            return Ok(None);
        };
        let is_hidden = self.aim(reach, camera)?.is_some();
        Ok((!is_hidden).then_some(body))
    }
}
