//! Which kinds of lamps kernels know: what a world does not have costs neither registers nor time.

use glam::Vec3;

use super::{LampState, Lights, RhythmsTold, motion, rhythms, table::KNOWN_LAMPS};
use crate::world::{Lamp, World};

/// Kinds of lamps beside a few points, spots and suns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LampKinds {
    /// Lamps that are spheres.
    pub spheres: bool,
    /// So many lamps that each cell of the world has a [list](super::lists).
    pub lists: bool,
    /// Lamps that have rhythms, few enough to be told apart: see [`super::rhythms`].
    pub rhythms: RhythmsTold,
}

impl LampKinds {
    /// Every kind, but for rhythms: to tell them apart is worth it only where light is kept from frame to frame.
    pub const ALL: Self = Self {
        spheres: true,
        lists: true,
        rhythms: RhythmsTold::None,
    };

    /// What these lights need.
    pub fn of(lights: &Lights) -> Self {
        Self {
            spheres: lights.has_spheres(),
            lists: lights.lamps.len() > KNOWN_LAMPS as usize,
            rhythms: RhythmsTold::None,
        }
    }

    /// What `world` needs under any of its presets, at any time and whichever of its lamps are on.
    pub fn of_world(world: &World) -> Self {
        let presets = world.lamp_presets.iter();
        presets.fold(Self::of_lamps(world, &[]), |kinds, preset| {
            kinds.with(Self::of_lamps(world, &preset.lamps))
        })
    }

    /// What `world` needs with these lamps in place of its presets', at any time and whichever of the player's are on.
    pub fn of_lamps(world: &World, lamps: &[Lamp]) -> Self {
        let placed = &world.restored.lamps;
        let count = lamps.len() + usize::from(world.sun.is_some()) + placed.len();
        let of_preset = (lamps.iter().enumerate()).map(|(index, lamp)| {
            let seed = motion::lamp_seed(world.seed, index as u32);
            motion::rhythm(&lamp.motion, lamp.colour, seed)
        });
        let of_placed = placed
            .iter()
            .map(|lamp| LampState::of_placed(lamp, world, 0.0).rhythm)
            .map(|rhythm| rhythm.map(|rhythm| rhythm.number));
        let of_lamps: Vec<Option<u32>> = of_preset.chain(of_placed).collect();
        Self {
            spheres: lamps.iter().any(Lamp::is_sphere)
                || placed.iter().any(|lamp| lamp.block.is_soft()),
            lists: count > KNOWN_LAMPS as usize,
            rhythms: if rhythms::is_one(&of_lamps) && is_dark_without_lamps(world) {
                RhythmsTold::None
            } else {
                RhythmsTold::needed(&of_lamps)
            },
        }
    }

    /// What either needs.
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        Self {
            spheres: self.spheres || other.spheres,
            lists: self.lists || other.lists,
            rhythms: self.rhythms.max(other.rhythms),
        }
    }
}

/// Whether a world has neither a sun, a sky nor any material that emits light.
fn is_dark_without_lamps(world: &World) -> bool {
    let mut emitted = world.materials.iter().map(|material| material.emission);
    world.sun.is_none() && world.sky.is_dark() && emitted.all(|emission| emission == Vec3::ZERO)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use glam::IVec3;

    use super::*;
    use crate::world::{self, LampPreset, Motion, Sky, file::Overrides, placed::tests::lamp};

    fn worlds(name: &str) -> World {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("worlds");
        world::file::load(&folder.join(name), &Overrides::default()).expect("it loads")
    }

    /// A world with the sun and, in its second preset, so many lamps that there is room for `room` more without lists.
    fn nearly_full(room: usize) -> World {
        let point = worlds("cornell.ron").lamp_presets[0].lamps[0].clone();
        let mut world = worlds("minimal.ron");
        assert!(world.sun.is_some());
        world.lamp_presets.push(LampPreset {
            name: "many".into(),
            lamps: vec![point; KNOWN_LAMPS as usize - 1 - room],
        });
        world
    }

    #[test]
    fn lists_are_needed_from_the_first_lamp_on_that_faces_do_not_know() {
        for (room, placed, lists) in [(0, 0, false), (0, 1, true), (2, 2, false), (2, 3, true)] {
            let mut world = nearly_full(room);
            let lamps = (0..placed).map(|x| lamp(IVec3::new(x, 12, 3)));
            world.restored.lamps = lamps.collect();
            let kinds = LampKinds::of_world(&world);
            assert_eq!(kinds.lists, lists, "{placed} lamps for {room}");
            let lights = Lights::at(&world, &world.lamp_presets[1], 0.0);
            assert_eq!(LampKinds::of(&lights).lists, lists);
            // Under the first preset alone, there is room.
            let preset = &world.lamp_presets[0].lamps;
            assert!(!LampKinds::of_lamps(&world, preset).lists);
        }
    }

    #[test]
    fn lamps_that_pulse_are_told_apart_while_they_are_few_and_not_all_light() {
        use RhythmsTold::{ByBrightness, ByChannel, None as Not};
        let pulse = |phase| Motion::Pulse {
            amount: 0.5,
            rate: 1.0,
            phase,
        };
        let mut world = worlds("cornell.ron");
        world.sky = Sky {
            zenith: Vec3::ZERO,
            horizon: Vec3::ZERO,
            ground: Vec3::ZERO,
        };
        world
            .materials
            .retain(|material| material.emission == Vec3::ZERO);
        let still = world.lamp_presets[0].lamps[0].clone();
        let lamps = |phases: &[Option<f32>]| -> Vec<Lamp> {
            let lamp = |phase: &Option<f32>| Lamp {
                motion: phase.iter().copied().map(pulse).collect(),
                ..still.clone()
            };
            phases.iter().map(lamp).collect()
        };
        for (phases, told_apart) in [
            (&[None][..], Not),
            (&[Some(0.0)], Not),
            (&[Some(0.0), Some(0.0)], Not),
            (&[Some(0.0), None], ByChannel),
            (&[Some(0.0), Some(1.0), Some(2.0)], ByChannel),
            (&[Some(0.0), Some(1.0), Some(2.0), Some(3.0)], ByBrightness),
        ] {
            let kinds = LampKinds::of_lamps(&world, &lamps(phases));
            assert_eq!(kinds.rhythms, told_apart, "{phases:?}");
        }
        world.sky.zenith = Vec3::ONE;
        let kinds = LampKinds::of_lamps(&world, &lamps(&[Some(0.0)]));
        assert_eq!(kinds.rhythms, ByChannel);
    }

    #[test]
    fn a_sphere_in_any_preset_or_hung_up_switched_off_is_a_sphere() {
        let mut world = worlds("soft_shadows.ron");
        assert!(LampKinds::of_world(&world).spheres);
        world.lamp_presets.clear();
        assert!(!LampKinds::of_world(&world).spheres);
        let mut sphere = lamp(IVec3::ZERO);
        sphere.block.soft_radius = 1.0;
        sphere.is_on = false;
        world.restored.lamps.push(sphere);
        assert!(LampKinds::of_world(&world).spheres);
    }
}
