//! What a run shows of bits: those that fly off what is dug, and the bulbs of placed lamps.

use super::Run;
use crate::{
    app::{AppError, hands::bits::Dug},
    world::Camera,
};

impl Run<'_> {
    /// Bits fly off the voxels that the last stroke removed.
    pub(super) fn burst(&mut self, camera: &Camera) {
        let world = self.viewport.world();
        let Some(changes) = self.hands.history.last() else {
            return;
        };
        let dug = changes.removed(world.size.as_ivec3());
        let dug: Vec<Dug> = dug
            .map(|(voxel, material)| Dug {
                voxel: voxel + world.origin,
                material,
            })
            .collect();
        let measures = self.player.body().measures;
        let eye = camera.position.as_dvec3();
        self.hands
            .bits
            .burst(&dug, &world.materials, eye, &measures);
    }

    /// Lets the next pictures show the bits that fly now, and the bulbs of placed lamps.
    ///
    /// # Errors
    /// [`AppError`] when the device fails.
    pub fn show_bits(&mut self) -> Result<(), AppError> {
        self.follow_build();
        let measures = self.player.body().measures;
        let time_s = self.settings.clock.time_s;
        let ground = self.viewport.ground()?;
        let mut bits = self
            .hands
            .bits
            .seen(self.player.now_ns(), &ground, &measures);
        bits.extend(self.viewport.bulbs(time_s));
        Ok(self.viewport.show_bits(&bits)?)
    }
}
