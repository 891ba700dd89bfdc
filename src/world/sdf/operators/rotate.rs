//! A rotated sub-tree.

use std::sync::Arc;

use glam::{DMat3, DVec3, EulerRot};

use crate::world::noise::NoiseBank;
use crate::world::sdf::keys::{Point, SubTree, keys};
use crate::world::sdf::wgsl::{Body, vector};
use crate::world::sdf::{Bounds, Form, Node, Side, Tree};

keys! {
    /// Rotates a sub-tree around the origin.
    pub struct Rotate {
        /// Euler angles in degrees, applied about x, then y, then z.
        pub degrees: Point,
        pub of: SubTree,
    }
}

impl Form for Rotate {
    fn prepare(&self, bank: &Arc<NoiseBank>) -> Tree {
        let [x, y, z] = self.degrees.to_array().map(f64::to_radians);
        // x first, then y, then z: the matrices multiply from the left.
        let rotation = DMat3::from_euler(EulerRot::ZYX, z, y, x);
        Arc::new(Turned {
            inverse: rotation.transpose(),
            of: self.of.prepare(bank),
        })
    }
}

#[derive(Debug)]
struct Turned {
    /// Rotates points of the outer space into the sub-tree's space.
    inverse: DMat3,
    of: Tree,
}

impl Turned {
    /// Appends the point in the sub-tree's space; returns its name.
    fn emit_point(&self, body: &mut Body<'_>, p: &str) -> String {
        let columns = [
            self.inverse.x_axis,
            self.inverse.y_axis,
            self.inverse.z_axis,
        ];
        let columns = columns.map(vector).join(", ");
        body.variable("p", format_args!("mat3x3f({columns}) * {p}"))
    }
}

impl Node for Turned {
    fn eval(&self, p: DVec3) -> f64 {
        self.of.eval(self.inverse * p)
    }

    fn variation(&self, radius: f64) -> f64 {
        self.of.variation(radius)
    }

    fn bounds(&self, level: f64) -> Bounds {
        self.of.bounds(level).rotated(self.inverse.transpose())
    }

    fn is_costly(&self) -> bool {
        self.of.is_costly()
    }

    fn emit(&self, body: &mut Body<'_>, p: &str) -> String {
        let q = self.emit_point(body, p);
        self.of.emit(body, &q)
    }

    fn emit_bound(&self, body: &mut Body<'_>, p: &str, side: Side) -> Option<String> {
        let q = self.emit_point(body, p);
        body.bound(&self.of, &q, side)
    }
}
