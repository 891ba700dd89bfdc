//! Bodies that a player places, removes and pushes.

use super::Viewport;
use crate::{
    app::body::{
        Ground, Measures, Walled,
        free::{FreeBodies, Moved, Pusher},
    },
    frame::FrameError,
    world::bodies::WholeBody,
};

impl Viewport {
    pub fn free_bodies(&self) -> &FreeBodies {
        &self.free
    }

    /// World time (seconds) at the moment that the player's simulation has come to.
    pub fn now_s(&self) -> f64 {
        self.clock.time_s(self.clock.at_ns)
    }

    /// Places the body of a name, or removes it. It stays when the world is built again.
    ///
    /// # Errors
    /// [`FrameError`] when the adapter cannot hold it; then nothing changes.
    pub fn put_body(&mut self, name: &str, body: Option<&WholeBody>) -> Result<(), FrameError> {
        let mut bodies = self.world.bodies.clone();
        if let Some(index) = bodies.index_of(name) {
            bodies.remove(index);
        }
        if let Some(body) = body {
            bodies.put(body);
        }
        let waits = !self.frame.has_bodies() && self.is_preparing();
        if !waits {
            self.frame.set_bodies(&self.gpu, &bodies)?;
        }
        self.bodies_wait = waits;
        self.free.follow(&bodies);
        self.world.bodies = bodies;
        self.reference_view = self.traced(&self.choice)?;
        Ok(())
    }

    /// Whether the picture does not show yet what was placed: the kernels for it are being compiled.
    pub fn bodies_wait(&self) -> bool {
        self.bodies_wait
    }

    /// Begins to compile the kernels that the first body needs, on a thread of its own: a lift then stops no picture.
    pub fn prepare_bodies(&mut self) {
        if self.frame.has_bodies() || self.is_preparing() || self.preparation_failed {
            return;
        }
        let ended = self.preparation.take();
        let needed = self.frame.kernels_for_bodies(&self.gpu);
        if needed.is_empty() {
            return;
        }
        // What failed fails again, and is told when a body needs it.
        self.preparation_failed = ended.is_some_and(|ended| ended.finish().is_err());
        if !self.preparation_failed {
            self.preparation = Some(self.gpu.compile_ahead(needed));
        }
    }

    /// Whether a first body would stop the picture until its kernels are compiled.
    pub fn does_first_body_stop(&self) -> bool {
        let is_first = !self.frame.has_bodies() && !self.is_preparing();
        is_first && !self.frame.kernels_for_bodies(&self.gpu).is_empty()
    }

    fn is_preparing(&self) -> bool {
        let preparation = self.preparation.as_ref();
        preparation.is_some_and(|compiling| !compiling.is_over())
    }

    /// Lets the pictures show the bodies that waited for their kernels, once those are compiled. What the player does
    /// with the bodies never waits, so a record plays the same.
    ///
    /// # Errors
    /// [`FrameError`] when the adapter cannot hold them: they stay unseen until another one is placed.
    pub fn show_waiting_bodies(&mut self) -> Result<(), FrameError> {
        if !self.bodies_wait || self.is_preparing() {
            return Ok(());
        }
        self.bodies_wait = false;
        self.frame.set_bodies(&self.gpu, &self.world.bodies)?;
        self.reference_view = self.traced(&self.choice)?;
        Ok(())
    }

    /// Another frame shows the world with all its bodies, or another device does.
    pub(super) fn forget_preparation(&mut self) {
        self.preparation = None;
        self.preparation_failed = false;
        self.bodies_wait &= !self.frame.has_bodies();
    }

    /// Moves the free bodies by a step of the simulation that ends at `end_ns` and lasts `step_s`.
    ///
    /// # Errors
    /// [`FrameError`] when the voxels must be read back and the device is lost.
    pub fn step_bodies(
        &mut self,
        end_ns: u64,
        player: Option<&Pusher>,
        measures: &Measures,
        step_s: f64,
    ) -> Result<Moved, FrameError> {
        self.voxels()?;
        let voxels = self.voxels.as_ref().expect("they were just read");
        let stone = Walled(Ground::new(voxels, self.world.origin));
        let time_s = self.clock.time_s(end_ns);
        let bodies = &mut self.world.bodies;
        let moved = (self.free).step(bodies, &stone, time_s, player, measures, step_s);
        self.bodies_moved |= moved.any;
        Ok(moved)
    }
}
