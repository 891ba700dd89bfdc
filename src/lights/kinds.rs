//! Which kinds of lamps kernels know: what a world does not have costs neither registers nor time.

use super::{Lights, table::KNOWN_LAMPS};
use crate::world::{Lamp, PlacedLamp, World};

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
        presets.fold(
            Self::of_lamps(world, &[], &world.restored.lamps),
            |kinds, preset| kinds.and(Self::of_lamps(world, &preset.lamps, &world.restored.lamps)),
        )
    }

    /// What `world` needs with these lamps in place of its own, and with these of a player.
    pub fn of_lamps(world: &World, lamps: &[Lamp], placed: &[PlacedLamp]) -> Self {
        let count = lamps.len() + usize::from(world.sun.is_some()) + placed.len();
        Self {
            spheres: lamps.iter().any(Lamp::is_sphere)
                || placed.iter().any(|lamp| lamp.block.is_soft()),
            lists: count > KNOWN_LAMPS as usize,
        }
    }

    /// What either needs.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            spheres: self.spheres || other.spheres,
            lists: self.lists || other.lists,
        }
    }
}
