//! A line segment with a radius.

use std::sync::Arc;

use glam::DVec3;

use crate::world::noise::NoiseBank;
use crate::world::sdf::keys::{Point, Positive, keys};
use crate::world::sdf::wgsl::{Body, number, vector};
use crate::world::sdf::{Bounds, Form, Node, Tree};

keys! {
    /// Every point within a distance of a line segment; a ball if both ends are the same.
    pub struct Capsule {
        /// One end of the line, voxels.
        pub from: Point,
        /// The other end, voxels.
        pub to: Point,
        /// Distance from the line, voxels.
        pub radius: Positive,
    }
}

impl Form for Capsule {
    fn prepare(&self, _bank: &Arc<NoiseBank>) -> Tree {
        let along = self.to - self.from;
        let length_squared = along.length_squared();
        Arc::new(Line {
            from: self.from,
            along,
            inverse_length_squared: if length_squared > 0.0 {
                1.0 / length_squared
            } else {
                0.0
            },
            radius: self.radius,
        })
    }
}

#[derive(Debug)]
struct Line {
    from: DVec3,
    /// Vector from one end to the other.
    along: DVec3,
    /// 0 for a segment of length 0.
    inverse_length_squared: f64,
    radius: f64,
}

/// Quilez, "Distance functions": sdCapsule, with the squared length inverted beforehand.
const CAPSULE_DISTANCE: &str = "
fn capsule_distance(from_end: vec3f, along: vec3f, inverse_length_squared: f32) -> f32 {
    let t = clamp(dot(from_end, along) * inverse_length_squared, 0.0, 1.0);
    return length(from_end - along * t);
}
";

impl Node for Line {
    /// Quilez, "Distance functions": sdCapsule.
    fn eval(&self, p: DVec3) -> f64 {
        let from_end = p - self.from;
        let t = (from_end.dot(self.along) * self.inverse_length_squared).clamp(0.0, 1.0);
        (from_end - self.along * t).length() - self.radius
    }

    fn bounds(&self, level: f64) -> Bounds {
        let to = self.from + self.along;
        Bounds {
            min: self.from.min(to),
            max: self.from.max(to),
        }
        .grown(DVec3::splat(self.radius + level))
    }

    fn emit(&self, body: &mut Body<'_>, p: &str) -> String {
        body.helper(CAPSULE_DISTANCE);
        let (from, along) = (vector(self.from), vector(self.along));
        let (inverse, radius) = (number(self.inverse_length_squared), number(self.radius));
        body.variable(
            "d",
            format_args!("capsule_distance({p} - {from}, {along}, {inverse}) - {radius}"),
        )
    }
}
