//! A scaled sub-tree.

use std::sync::Arc;

use glam::DVec3;

use crate::world::file::{GREATEST_SCALE, Leaf, Read, Reader};
use crate::world::noise::NoiseBank;
use crate::world::sdf::keys::{Scalar, SubTree, keys};
use crate::world::sdf::wgsl::{Body, number};
use crate::world::sdf::{Bounds, Form, Node, Side, Tree};

keys! {
    /// Scales a sub-tree around the origin by the same factor on every axis, so that distances stay
    /// distances.
    pub struct Scale {
        pub by: Factor,
        pub of: SubTree,
    }
}

/// A scale factor, limited so that an f32 can still hold the coordinates.
pub struct Factor;

impl Scalar for Factor {
    const WANTED: &'static str = "from 0.0001 to 10000";

    fn read(leaf: &Leaf, key: &str, reader: &Reader<'_>) -> Read<f32> {
        reader.source.scale(leaf, key)
    }

    fn holds(value: f64) -> bool {
        (1.0 / GREATEST_SCALE..=GREATEST_SCALE).contains(&value)
    }
}

impl Form for Scale {
    fn prepare(&self, bank: &Arc<NoiseBank>) -> Tree {
        Arc::new(Scaled {
            by: self.by,
            of: self.of.prepare(bank),
        })
    }
}

#[derive(Debug)]
struct Scaled {
    by: f64,
    of: Tree,
}

impl Scaled {
    /// Appends the point in the sub-tree's space; returns its name.
    fn emit_point(&self, body: &mut Body<'_>, p: &str) -> String {
        let by = number(self.by);
        body.variable("p", format_args!("{p} / {by}"))
    }
}

impl Node for Scaled {
    fn eval(&self, p: DVec3) -> f64 {
        self.of.eval(p / self.by) * self.by
    }

    fn variation(&self, radius: f64) -> f64 {
        self.of.variation(radius / self.by) * self.by
    }

    fn bounds(&self, level: f64) -> Bounds {
        let bounds = self.of.bounds(level / self.by);
        Bounds {
            min: bounds.min * self.by,
            max: bounds.max * self.by,
        }
    }

    fn is_costly(&self) -> bool {
        self.of.is_costly()
    }

    fn emit(&self, body: &mut Body<'_>, p: &str) -> String {
        let q = self.emit_point(body, p);
        let (of, by) = (self.of.emit(body, &q), number(self.by));
        body.variable("d", format_args!("{of} * {by}"))
    }

    fn emit_bound(&self, body: &mut Body<'_>, p: &str, side: Side) -> Option<String> {
        let q = self.emit_point(body, p);
        let (of, by) = (body.bound(&self.of, &q, side)?, number(self.by));
        Some(body.variable("b", format_args!("{of} * {by}")))
    }
}
