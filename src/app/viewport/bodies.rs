//! Bodies that a player places, removes and pushes.

use super::Viewport;
use crate::{
    app::body::{
        Ground, Measures, Walled,
        free::{FreeBodies, Moved, Pusher},
    },
    frame::FrameError,
    world::bodies::PlacedBody,
};

impl Viewport {
    pub fn free_bodies(&self) -> &FreeBodies {
        &self.free
    }

    /// Places the body of a name, or removes it. It stays when the world is built again.
    ///
    /// # Errors
    /// [`FrameError`] when the adapter cannot hold it; then nothing changes.
    pub fn put_body(&mut self, name: &str, body: Option<&PlacedBody>) -> Result<(), FrameError> {
        let mut bodies = self.world.bodies.clone();
        if let Some(index) = bodies.index_of(name) {
            bodies.remove(index);
        }
        if let Some(body) = body {
            bodies.add(body);
        }
        self.frame.set_bodies(&self.gpu, &bodies)?;
        self.free.follow(&bodies);
        self.world.bodies = bodies;
        self.reference_view = self.traced(&self.choice)?;
        Ok(())
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
