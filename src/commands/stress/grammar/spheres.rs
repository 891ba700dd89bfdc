//! Lamps that are spheres: a radius for some lamps of some worlds.

use super::{dice::Dice, term::Term};

/// Share of the worlds that have such lamps, and share of their lamps.
const WORLDS: f64 = 0.25;
const LAMPS: f64 = 0.6;
/// Share of the spheres that are larger than most rooms.
const HUGE: f64 = 0.1;

/// Draws the radii of a world's lamps, from numbers of their own.
pub struct Spheres {
    dice: Dice,
    exist: bool,
}

impl Spheres {
    pub fn new(mut dice: Dice) -> Self {
        let exist = dice.chance(WORLDS);
        Self { dice, exist }
    }

    /// The key of the next lamp, if that is a sphere.
    pub fn soft_radius(&mut self) -> Option<(&'static str, Term)> {
        if !self.exist || !self.dice.chance(LAMPS) {
            return None;
        }
        let radius = match self.dice.chance(HUGE) {
            true => self.dice.magnitude(4.0, 60.0),
            false => self.dice.magnitude(0.02, 4.0),
        };
        Some(("soft_radius", Term::Number(radius)))
    }
}
