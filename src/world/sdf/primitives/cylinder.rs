//! An upright cylinder.

use std::sync::Arc;

use glam::DVec3;

use crate::world::noise::NoiseBank;
use crate::world::sdf::keys::{Positive, keys};
use crate::world::sdf::wgsl::{Body, number};
use crate::world::sdf::{Bounds, Form, Node, Tree};

keys! {
    /// A cylinder along y, around the origin.
    pub struct Cylinder {
        /// Voxels.
        pub radius: Positive,
        /// Half of its height, voxels.
        pub half_height: Positive,
    }
}

impl Form for Cylinder {
    fn prepare(&self, _bank: &Arc<NoiseBank>) -> Tree {
        Arc::new(self.clone())
    }
}

/// Quilez, "Distance functions": sdCappedCylinder.
const CYLINDER_DISTANCE: &str = "
fn cylinder_distance(p: vec3f, radius: f32, half_height: f32) -> f32 {
    let q = vec2f(length(p.xz) - radius, abs(p.y) - half_height);
    return length(max(q, vec2f(0.0))) + min(max(q.x, q.y), 0.0);
}
";

impl Node for Cylinder {
    /// Quilez, "Distance functions": sdCappedCylinder.
    fn eval(&self, p: DVec3) -> f64 {
        let side = p.x.hypot(p.z) - self.radius;
        let top = p.y.abs() - self.half_height;
        side.max(0.0).hypot(top.max(0.0)) + side.max(top).min(0.0)
    }

    fn bounds(&self, level: f64) -> Bounds {
        Bounds::centred(DVec3::new(self.radius, self.half_height, self.radius) + level)
    }

    fn emit(&self, body: &mut Body<'_>, p: &str) -> String {
        body.helper(CYLINDER_DISTANCE);
        let (radius, half_height) = (number(self.radius), number(self.half_height));
        body.variable(
            "d",
            format_args!("cylinder_distance({p}, {radius}, {half_height})"),
        )
    }
}
