//! The motions that lamps and bodies share.

use super::diagnostics::Source;
use super::leaf::Leaf;
use super::schema::Vector;
use super::values::{Read, or};
use crate::world::Travel;

impl Source {
    /// How fast a motion repeats.
    pub fn rate(&self, leaf: &Leaf) -> Read<f32> {
        Ok(self.number_in(leaf, "rate", -1000.0..=1000.0)? as f32)
    }

    /// Where in its cycle a motion begins; 0 if nothing is written.
    pub fn phase(&self, phase: &Option<Leaf>) -> Read<f32> {
        or(phase, 0.0, |leaf| self.length(leaf, "phase"))
    }

    pub fn orbit(&self, radius: &Vector, rate: &Leaf, phase: &Option<Leaf>) -> Read<Travel> {
        Ok(Travel::Orbit {
            radius: self.point(radius, "radius")?,
            rate: self.rate(rate)?,
            phase: self.phase(phase)?,
        })
    }

    pub fn bob(&self, amplitude: &Vector, rate: &Leaf, phase: &Option<Leaf>) -> Read<Travel> {
        Ok(Travel::Bob {
            amplitude: self.point(amplitude, "amplitude")?,
            rate: self.rate(rate)?,
            phase: self.phase(phase)?,
        })
    }

    pub fn path(&self, points: &[Vector], speed: &Leaf) -> Read<Travel> {
        let speed_read = self.not_negative(speed, "speed")?;
        if points.len() < 2 {
            return Err(self.at(
                speed,
                format!("this path has {} points", points.len()),
                "a path goes round through at least 2 points",
            ));
        }
        let points = points.iter().map(|point| self.point(point, "points"));
        Ok(Travel::Path {
            points: points.collect::<Read<_>>()?,
            speed: speed_read,
        })
    }
}
