//! Bits in the picture, and the bulbs of the lamps that a player has placed.

use std::f32::consts::PI;

use super::Viewport;
use crate::{
    app::hands::bits,
    frame::FrameError,
    lights::LampState,
    passes::view::bits::{Bits, GpuBit},
    world::{PlacedLamp, World, placed::MOST_PLACED},
};

/// Radiance of the bulb of a white lamp, whatever its power: bright, but not so bright that its colour is lost.
const GLOW: f32 = 6.0;
/// Most that a flare of the lamp may add to that.
const MOST_GAIN: f32 = 2.0;
/// What a bulb reflects of white light, as a share of its colour.
const GLASS: f32 = 0.5;
/// Half of the smallest and the largest edge (voxels).
const HALF_SIZES: [f32; 2] = [0.08, 0.25];

const _: () = assert!(
    MOST_PLACED + bits::MOST <= Bits::MOST,
    "all of them are drawn"
);

impl Viewport {
    /// Draws these bits in the next pictures, and no others. The path-traced picture has none.
    ///
    /// # Errors
    /// [`FrameError`] when they cannot be drawn.
    pub fn show_bits(&mut self, bits: &[GpuBit]) -> Result<(), FrameError> {
        self.frame.set_bits(&self.gpu, bits)
    }

    /// The time that lamps are at: they stand still if they are not animated.
    pub(super) fn lamp_time_s(&self, time_s: f64) -> f64 {
        match self.choice.parameters.lights.animate {
            true => time_s,
            false => 0.0,
        }
    }

    /// The bulbs at world time `time_s`, dark ones too.
    pub fn bulbs(&self, time_s: f64) -> Vec<GpuBit> {
        let time_s = self.lamp_time_s(time_s);
        let lamps = self.placed_lamps().iter();
        lamps.map(|lamp| bulb(lamp, &self.world, time_s)).collect()
    }
}

fn bulb(lamp: &PlacedLamp, world: &World, time_s: f64) -> GpuBit {
    let [smallest, largest] = HALF_SIZES;
    let dark = GpuBit {
        centre_ws: lamp.centre_ws().to_array(),
        half_size: (lamp.block.radius)
            .max(lamp.block.soft_radius)
            .clamp(smallest, largest),
        albedo: (GLASS * lamp.colour()).to_array(),
        ..GpuBit::default()
    };
    if !lamp.is_on {
        return dark;
    }
    let now = LampState::of_placed(lamp, world, time_s);
    let at_rest = lamp.lamp(world.voxel_m).power / (4.0 * PI);
    let glow = GLOW * (now.intensity.as_vec3() / at_rest).min(glam::Vec3::splat(MOST_GAIN));
    GpuBit {
        centre_ws: now.position_ws.as_vec3().to_array(),
        emission: glow.to_array(),
        ..dark
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use glam::{IVec3, Vec3};

    use super::*;
    use crate::world::{
        file::{self, Overrides},
        placed::{LampMotion, tests::lamp},
    };

    #[test]
    fn a_bulb_has_the_colour_of_its_lamp_follows_it_and_is_dark_when_off() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("worlds/minimal.ron");
        let world = file::load(&path, &Overrides::default()).expect("it loads");
        let mut lamp = lamp(IVec3::new(3, 4, -5));
        let on = bulb(&lamp, &world, 1.0);
        assert_eq!(on.centre_ws, [3.5, 4.5, -4.5]);
        let glow = Vec3::from(on.emission);
        assert!(glow.distance(GLOW * lamp.colour()) < 1e-4, "{glow}");
        lamp.block.power *= 10.0;
        assert!(Vec3::from(bulb(&lamp, &world, 1.0).emission).distance(glow) < 1e-4);
        lamp.is_on = false;
        let off = bulb(&lamp, &world, 1.0);
        assert_eq!(
            off,
            GpuBit {
                emission: [0.0; 3],
                ..on
            }
        );
        lamp.is_on = true;
        lamp.block.motion = LampMotion::Orbit;
        let moved = Vec3::from(bulb(&lamp, &world, 1.0).centre_ws);
        assert!(moved.distance(lamp.centre_ws()) > 0.1, "{moved}");
    }
}
