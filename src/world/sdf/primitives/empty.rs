//! Nothing.

use std::sync::Arc;

use glam::DVec3;

use crate::world::noise::NoiseBank;
use crate::world::sdf::keys::keys;
use crate::world::sdf::wgsl::{Body, FAR};
use crate::world::sdf::{Bounds, Form, Node, Tree};

keys! {
    /// Nothing: +∞ everywhere.
    pub struct Empty;
}

impl Form for Empty {
    fn prepare(&self, _bank: &Arc<NoiseBank>) -> Tree {
        Arc::new(Self)
    }
}

impl Node for Empty {
    fn eval(&self, _p: DVec3) -> f64 {
        f64::INFINITY
    }

    fn variation(&self, _radius: f64) -> f64 {
        0.0
    }

    fn bounds(&self, _level: f64) -> Bounds {
        Bounds::EMPTY
    }

    fn emit(&self, _body: &mut Body<'_>, _p: &str) -> String {
        FAR.to_owned()
    }
}
