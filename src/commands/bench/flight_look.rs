//! The pictures that `grotto bench flight` compares from frame to frame.

use super::super::Failure;
use crate::measure::{changes::ChangeMeter, picture::Picture};

/// The view of a camera.
pub(super) struct Look {
    /// Indirect irradiance, in linear light.
    pub irradiance: Picture,
    /// Tone-mapped, in [0, 1].
    pub displayed: Picture,
}

/// Changes of both pictures.
pub(super) struct Meters {
    pub irradiance: ChangeMeter,
    pub displayed: ChangeMeter,
}

impl Meters {
    /// `floor`: smallest irradiance that counts.
    pub fn new(floor: f64) -> Self {
        Self {
            irradiance: ChangeMeter::new(floor),
            displayed: ChangeMeter::of_display(),
        }
    }

    /// Adds the changes from one view to the next of the same surfaces.
    pub fn add(&mut self, before: &Look, after: &Look) -> Result<(), Failure> {
        let irradiance = (&mut self.irradiance, &before.irradiance, &after.irradiance);
        let displayed = (&mut self.displayed, &before.displayed, &after.displayed);
        for (meter, before, after) in [irradiance, displayed] {
            meter.add(before, after).map_err(Failure::fault)?;
        }
        Ok(())
    }
}
