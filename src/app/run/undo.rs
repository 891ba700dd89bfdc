//! Strokes that are undone and made again. Neither voxels nor a body ever come back inside a body that was pushed there:
//! the stroke then waits until there is room.

use glam::IVec3;

use super::Run;
use crate::{
    app::{
        AppError,
        body::{Body, Mode, Obstacles, Terrain},
        hands::{Changes, Side},
        texts::{bodies as texts, toasts},
        viewport::Viewport,
    },
    frame::FrameError,
    world::bodies::WholeBody,
};

/// Why a stroke was neither undone nor made again.
#[derive(Debug, thiserror::Error)]
enum Refused {
    #[error("{0}")]
    NoRoom(&'static str),
    #[error(transparent)]
    App(#[from] AppError),
}

impl From<FrameError> for Refused {
    fn from(error: FrameError) -> Self {
        Self::App(error.into())
    }
}

impl Run<'_> {
    /// Returns whether anything changed.
    pub(super) fn undo(&mut self) -> bool {
        self.follow_build();
        let (viewport, body) = (&mut *self.viewport, self.player.body());
        let undone = (self.hands.history)
            .undo(|changes| viewport.put_where_free(changes, Side::Before, body));
        self.went(undone, toasts::NO_UNDO)
    }

    /// Returns whether anything changed.
    pub(super) fn redo(&mut self) -> bool {
        self.follow_build();
        let (viewport, body) = (&mut *self.viewport, self.player.body());
        let redone = (self.hands.history)
            .redo(|changes| viewport.put_where_free(changes, Side::After, body));
        self.went(redone, toasts::NO_REDO)
    }

    fn went(&mut self, done: Result<bool, Refused>, nothing: &str) -> bool {
        match done {
            Ok(true) => return true,
            Ok(false) => self.messages.toast(nothing),
            Err(error) => self.messages.toast_error(error.to_string()),
        }
        false
    }
}

impl Viewport {
    /// Gives everything that a stroke changed what it was before, or after, unless a body or the player is in the way.
    fn put_where_free(
        &mut self,
        changes: &Changes,
        side: Side,
        player: &Body,
    ) -> Result<(), Refused> {
        let returning = changes.body(side);
        let own = returning.and_then(|(name, _)| self.world().bodies.index_of(name));
        let body = returning.and_then(|(_, body)| body);
        if self.has_body_in_the_way(changes, side, own, body) {
            return Err(Refused::NoRoom(texts::IN_THE_WAY));
        }
        if self.has_player_in_the_way(changes, side, player, body)? {
            return Err(Refused::NoRoom(texts::PLAYER_IN_THE_WAY));
        }
        Ok(self.put(changes, side)?)
    }

    /// Whether voxels or a body would come back inside a free body. `own` is the body that the stroke takes away. Bodies
    /// that are not free are never in the way: they move through voxels as they please, or stand where they always did.
    fn has_body_in_the_way(
        &self,
        changes: &Changes,
        side: Side,
        own: Option<usize>,
        body: Option<&WholeBody>,
    ) -> bool {
        let (free, bodies) = (self.free_bodies(), &self.world().bodies);
        let (origin, size) = (self.world().origin, self.world().size.as_ivec3());
        let comes_back = |voxel: IVec3| {
            let at = voxel - origin;
            let material = |side| changes.material(size, at, side);
            material(side).is_some_and(|new| new != 0) && material(side.other()) == Some(0)
        };
        let is_in_voxels = changes.bounds().is_some_and(|bounds| {
            let region = bounds.map(|at| at + origin);
            let taken = free.within(bodies, region, own);
            taken.voxels().any(comes_back)
        });
        is_in_voxels || body.is_some_and(|body| free.has_in_the_way(bodies, body, own))
    }

    /// Whether voxels or a body would come back where the player is, and no room is near. Where there is some, the player
    /// gets out, as out of any stone.
    fn has_player_in_the_way(
        &mut self,
        changes: &Changes,
        side: Side,
        player: &Body,
        body: Option<&WholeBody>,
    ) -> Result<bool, AppError> {
        if player.mode == Mode::NoClip {
            return Ok(false);
        }
        let taken = body.map(WholeBody::taken).unwrap_or_default();
        let now_ns = self.clock.at_ns;
        let ground = self.ground()?;
        let (origin, size) = (ground.origin, ground.voxels.size().as_ivec3());
        let after = Changed {
            now: ground.at(now_ns),
            is_solid: |voxel| {
                let material = changes.material(size, voxel - origin, side);
                taken
                    .has(voxel)
                    .then_some(true)
                    .or(material.map(|material| material != 0))
            },
        };
        // Who is shut in already may undo what they did.
        Ok(!player.finds_room(&after) && player.finds_room(&after.now))
    }

    /// Gives everything that a stroke changed what it was before, or after.
    ///
    /// # Errors
    /// [`FrameError`] when the adapter cannot hold it; then nothing changes.
    fn put(&mut self, changes: &Changes, side: Side) -> Result<(), FrameError> {
        if let Some((name, body)) = changes.body(side) {
            let bodies = &self.world().bodies;
            let now = bodies.index_of(name).map(|index| bodies.whole(index));
            self.put_body(name, body)?;
            if let Err(error) = self.edit(|voxels, _| changes.put(voxels, side)) {
                self.put_body(name, now.as_ref())?;
                return Err(error);
            }
            return Ok(());
        }
        self.edit(|voxels, _| changes.put(voxels, side))?;
        if let Some((voxel, lamp)) = changes.lamp(side) {
            self.put_lamp(voxel, lamp)?;
        }
        Ok(())
    }
}

/// What stops the player once a stroke is undone: `is_solid` says it of the voxels (world space) that it changes.
struct Changed<T, F> {
    now: T,
    is_solid: F,
}

impl<T: Terrain, F: Fn(IVec3) -> Option<bool>> Terrain for Changed<T, F> {
    fn is_solid(&self, voxel: IVec3) -> bool {
        (self.is_solid)(voxel).unwrap_or_else(|| self.now.is_solid(voxel))
    }

    fn in_the_way(&self) -> &Obstacles<'_> {
        self.now.in_the_way()
    }
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, Vec3};

    use super::*;
    use crate::app::{
        body::Measures,
        hands::lift::BodyChange,
        viewport::sample::{body_at, shown},
    };

    /// Digs a voxel (world space) in the air of `minimal.ron`, where one is placed first.
    fn dug(viewport: &mut Viewport, voxel: IVec3) -> Changes {
        let mut changes = Changes::default();
        for material in [1, 0] {
            let edited = viewport.edit(|voxels, world| {
                let at = voxel - world.origin;
                let (edit, made) = Changes::make(voxels, at, at, |_, _| material);
                changes = made;
                edit
            });
            edited.expect("it fits");
        }
        changes
    }

    fn material(viewport: &mut Viewport, voxel: IVec3) -> u8 {
        let ground = viewport.ground().expect("no device is lost");
        ground.voxels.material(voxel - ground.origin)
    }

    fn flyer(eye: DVec3, viewport: &mut Viewport) -> Body {
        let ground = viewport.ground().expect("no device is lost");
        let bottom = f64::from(ground.origin.y);
        Body::with_eye_at(eye, Measures::of_height(1.77), bottom, &ground.at(0))
    }

    #[test]
    fn voxels_do_not_come_back_inside_a_body_and_a_body_not_inside_the_player() {
        let mut viewport = shown();
        let voxel = IVec3::new(3, 20, 5);
        let changes = dug(&mut viewport, voxel);
        let far = flyer(DVec3::new(-8.0, 24.0, -8.0), &mut viewport);
        // A part of a voxel is enough.
        let corner = voxel.as_vec3() + Vec3::new(0.75, 0.0, 0.0);
        let put = |viewport: &mut Viewport, corner| {
            let body = body_at(corner);
            viewport.put_body("placed 1", Some(&body)).expect("it fits");
        };
        put(&mut viewport, corner);
        let refused = viewport.put_where_free(&changes, Side::Before, &far);
        let refused = refused.expect_err("a body is there").to_string();
        assert_eq!(refused, texts::IN_THE_WAY);
        assert_eq!(material(&mut viewport, voxel), 0);
        put(&mut viewport, corner + Vec3::X * 0.25);
        let undone = viewport.put_where_free(&changes, Side::Before, &far);
        undone.expect("beside it there is room");
        assert_eq!(material(&mut viewport, voxel), 1);

        let mut other = body_at(Vec3::new(-4.0, 20.0, 5.0));
        other.body.name = "placed 2".into();
        let lifted = Changes::default().with_body(BodyChange::of(None, Some(other.clone())));
        // The player gets out of it, and out of voxels, where there is room near.
        let inside = flyer(DVec3::new(-3.5, 21.0, 5.5), &mut viewport);
        viewport
            .put_where_free(&lifted, Side::After, &inside)
            .expect("there is room near");
        let moved = Changes::default().with_body(BodyChange::of(
            None,
            Some(WholeBody {
                body: crate::world::bodies::Body {
                    name: "placed 3".into(),
                    ..other.body
                },
                ..other
            }),
        ));
        let refused = viewport.put_where_free(&moved, Side::After, &far);
        let refused = refused.expect_err("another body is there").to_string();
        assert_eq!(refused, texts::IN_THE_WAY);

        // Far enough below the top of the world, beyond which there would be room.
        let place = IVec3::new(9, 14, -6);
        let voxels = dug(&mut viewport, place);
        let filled = viewport.edit(|voxels, world| {
            let at = place - world.origin;
            voxels.edit(at - 9, at + 9, |voxel, old| {
                let is_room = (voxel - at).abs().cmple(IVec3::new(0, 1, 0)).all();
                if is_room { old } else { 1 }
            })
        });
        filled.expect("it fits");
        let shut_in = flyer(place.as_dvec3() + DVec3::new(0.5, 1.0, 0.5), &mut viewport);
        let refused = viewport.put_where_free(&voxels, Side::Before, &shut_in);
        let refused = refused.expect_err("there is no room near").to_string();
        assert_eq!(refused, texts::PLAYER_IN_THE_WAY);
        let undone = viewport.put_where_free(&voxels, Side::After, &shut_in);
        undone.expect("air is never in the way");
    }
}
