//! Which kinds of lamps kernels know: what a world does not have costs neither registers nor time.

use super::{Lights, table::KNOWN_LAMPS};
use crate::world::{Lamp, World};

/// Kinds of lamps beside a few points, spots and suns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LampKinds {
    /// Lamps that are spheres.
    pub spheres: bool,
    /// So many lamps that each cell of the world has a [list](super::lists).
    pub lists: bool,
}

impl LampKinds {
    /// Every kind.
    pub const ALL: Self = Self {
        spheres: true,
        lists: true,
    };

    /// What these lights need.
    pub fn of(lights: &Lights) -> Self {
        Self {
            spheres: lights.has_spheres(),
            lists: lights.lamps.len() > KNOWN_LAMPS as usize,
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
        Self {
            spheres: lamps.iter().any(Lamp::is_sphere)
                || placed.iter().any(|lamp| lamp.block.is_soft()),
            lists: count > KNOWN_LAMPS as usize,
        }
    }

    /// What either needs.
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        Self {
            spheres: self.spheres || other.spheres,
            lists: self.lists || other.lists,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use glam::IVec3;

    use super::*;
    use crate::world::{self, LampPreset, file::Overrides, placed::tests::lamp};

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
