//! What parameters change in a world that has been read.

use super::{Colour, World};
use crate::parameters::MaterialParameters;

impl World {
    /// Gives every material the albedo and the emission that the parameters name. Patterns stay, but
    /// their two colours are then the same.
    pub fn override_materials(&mut self, parameters: &MaterialParameters) {
        for material in &mut self.materials {
            if let Some(albedo) = parameters.albedo {
                material.a = Colour::Flat(albedo);
                material.b = Colour::Flat(albedo);
            }
            if let Some(emission) = parameters.emission {
                material.emission = emission;
            }
        }
    }
}
