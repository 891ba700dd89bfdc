//! A half space.

use std::sync::Arc;

use glam::DVec3;

use crate::world::noise::NoiseBank;
use crate::world::sdf::keys::{Direction, Length, keys};
use crate::world::sdf::wgsl::{Body, number, vector};
use crate::world::sdf::{Bounds, Form, Node, Tree};

keys! {
    /// Solid where dot(p, normal) < offset.
    pub struct Plane {
        /// Points out of the solid; its length scales the offset.
        pub normal: Direction,
        /// Distance of the surface from the origin along the normal, in voxels times the length of the
        /// normal.
        pub offset: Length,
    }
}

impl Form for Plane {
    fn prepare(&self, _bank: &Arc<NoiseBank>) -> Tree {
        let length = self.normal.length();
        Arc::new(HalfSpace {
            normal: self.normal / length,
            offset: self.offset / length,
        })
    }
}

#[derive(Debug)]
struct HalfSpace {
    /// Of length 1.
    normal: DVec3,
    offset: f64,
}

impl Node for HalfSpace {
    fn eval(&self, p: DVec3) -> f64 {
        p.dot(self.normal) - self.offset
    }

    fn bounds(&self, level: f64) -> Bounds {
        Bounds::half_space(self.normal, self.offset + level)
    }

    fn emit(&self, body: &mut Body<'_>, p: &str) -> String {
        let (normal, offset) = (vector(self.normal), number(self.offset));
        body.variable("d", format_args!("dot({p}, {normal}) - {offset}"))
    }
}
