//! Lamps, sun and sky as the shaders and the reference see them. Knows no GPU.
//!
//! Lamps move with world time. [`evaluate`] is the one owner of that motion: it runs once per frame on
//! the CPU in f64, [`table`] uploads its result, and the CPU path tracer reads the same values. Lamps
//! are summed: adding one never darkens anything.

mod buried;
mod cells;
pub mod change;
pub mod emitters;
mod fresh;
pub mod gain;
mod kinds;
pub mod lamp;
pub mod lists;
pub mod motion;
mod recent;
pub mod rest;
pub mod rhythms;
mod shadows;
pub mod sky;
pub mod sphere;
pub mod table;
pub mod tracked;

pub use buried::BuriedLamps;
pub use cells::Cells;
pub use emitters::Emitters;
pub use fresh::FreshLamps;
pub use gain::{CommonGain, LightsKept};
pub use kinds::LampKinds;
pub use lamp::{LampRay, LampShape, LampState, Rhythm, evaluate};
pub use lists::LampRanks;
pub use recent::RecentLights;
pub use rest::RestingLamps;
pub use rhythms::{Rhythms, RhythmsTold};
pub use shadows::CellShadows;
pub use tracked::{TrackedLamp, TrackedLamps};

use crate::world::{LampPreset, Sky, World};

/// Everything that lights a world at one moment, except the emission of its voxels.
#[derive(Clone, Debug, PartialEq)]
pub struct Lights {
    /// The lamps of the preset, in the order of the file, then the sun if the world has one, then those that a player
    /// has placed: placing one moves no other. Those that are switched off are there, too, and dark, so a switch moves none
    /// either: what faces and cells see of lamps is known by their numbers.
    pub lamps: Vec<LampState>,
    pub sky: Sky,
}

impl Lights {
    /// Whether any lamp is a sphere: its direct light is an estimate.
    pub fn has_spheres(&self) -> bool {
        self.lamps.iter().any(LampState::is_soft)
    }

    /// The lights of `world` under one of its presets at world time `time_s`.
    pub fn at(world: &World, preset: &LampPreset, time_s: f64) -> Self {
        let mut lamps = evaluate(preset, time_s, world.seed);
        lamps.extend(world.sun.as_ref().map(LampState::from_sun));
        let placed = world.restored.lamps.iter();
        lamps.extend(placed.map(|lamp| LampState::of_placed(lamp, world, time_s)));
        Self {
            lamps,
            sky: world.sky,
        }
    }
}
