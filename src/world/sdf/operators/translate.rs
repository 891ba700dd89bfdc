//! A translated sub-tree.

use std::sync::Arc;

use glam::DVec3;

use crate::world::noise::NoiseBank;
use crate::world::sdf::keys::{Point, SubTree, keys};
use crate::world::sdf::wgsl::{Body, vector};
use crate::world::sdf::{Bounds, Form, Node, Side, Tree};

keys! {
    /// Translates a sub-tree.
    pub struct Translate {
        /// Voxels.
        pub by: Point,
        pub of: SubTree,
    }
}

impl Form for Translate {
    fn prepare(&self, bank: &Arc<NoiseBank>) -> Tree {
        Arc::new(Moved {
            by: self.by,
            of: self.of.prepare(bank),
        })
    }
}

#[derive(Debug)]
struct Moved {
    by: DVec3,
    of: Tree,
}

impl Moved {
    /// Appends the point in the sub-tree's space; returns its name.
    fn emit_point(&self, body: &mut Body<'_>, p: &str) -> String {
        let by = vector(self.by);
        body.variable("p", format_args!("{p} - {by}"))
    }
}

impl Node for Moved {
    fn eval(&self, p: DVec3) -> f64 {
        self.of.eval(p - self.by)
    }

    fn variation(&self, radius: f64) -> f64 {
        self.of.variation(radius)
    }

    fn bounds(&self, level: f64) -> Bounds {
        let bounds = self.of.bounds(level);
        Bounds {
            min: bounds.min + self.by,
            max: bounds.max + self.by,
        }
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
