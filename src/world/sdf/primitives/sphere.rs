//! A ball.

use std::sync::Arc;

use glam::DVec3;

use crate::world::noise::NoiseBank;
use crate::world::sdf::keys::{Positive, keys};
use crate::world::sdf::wgsl::{Body, number};
use crate::world::sdf::{Bounds, Form, Node, Tree};

keys! {
    /// A ball around the origin.
    pub struct Sphere {
        /// Voxels.
        pub radius: Positive,
    }
}

impl Form for Sphere {
    fn prepare(&self, _bank: &Arc<NoiseBank>) -> Tree {
        Arc::new(self.clone())
    }
}

impl Node for Sphere {
    fn eval(&self, p: DVec3) -> f64 {
        p.length() - self.radius
    }

    fn bounds(&self, level: f64) -> Bounds {
        Bounds::centred(DVec3::splat(self.radius + level))
    }

    fn emit(&self, body: &mut Body<'_>, p: &str) -> String {
        let radius = number(self.radius);
        body.variable("d", format_args!("length({p}) - {radius}"))
    }
}
