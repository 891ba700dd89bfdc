//! What can be heard: events of a run.

use crate::world::materials::MaterialSound;

/// Noises that are kept between two frames: more at once would only be one din.
const MOST: usize = 32;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A foot is set down.
    Step,
    /// The body lands after a fall or a jump.
    Land,
    /// Voxels are dug away.
    Dig,
    /// Voxels are placed.
    Place,
    /// A lamp goes on or off.
    Switch,
}

/// Something that happened at the player's place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    pub kind: Kind,
    pub material: MaterialSound,
    /// 0 to 1: how fast a foot was, how deep a fall, how much was dug.
    pub strength: f32,
    /// Simulated time in nanoseconds.
    pub at_ns: u64,
}

/// The noises since the last frame.
#[derive(Clone, Debug, Default)]
pub struct Noises(Vec<Noise>);

impl Noises {
    pub fn make(&mut self, noise: Noise) {
        if self.0.len() < MOST {
            self.0.push(noise);
        }
    }

    pub fn drain(&mut self) -> impl Iterator<Item = Noise> {
        self.0.drain(..)
    }
}
