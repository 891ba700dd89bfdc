//! A torus that lies flat.

use std::sync::Arc;

use glam::DVec3;

use crate::world::noise::NoiseBank;
use crate::world::sdf::keys::{Positive, keys};
use crate::world::sdf::wgsl::{Body, number};
use crate::world::sdf::{Bounds, Form, Node, Tree};

keys! {
    /// Every point within a distance of a circle in the xz plane around the origin.
    pub struct Torus {
        /// Radius of the circle, voxels.
        pub major: Positive,
        /// Distance from the circle, voxels.
        pub minor: Positive,
    }
}

impl Form for Torus {
    fn prepare(&self, _bank: &Arc<NoiseBank>) -> Tree {
        Arc::new(self.clone())
    }
}

/// Distance to a circle in the xz plane: Quilez, "Distance functions", sdTorus.
const CIRCLE_DISTANCE: &str = "
fn circle_distance(p: vec3f, radius: f32) -> f32 {
    return length(vec2f(length(p.xz) - radius, p.y));
}
";

impl Node for Torus {
    /// Quilez, "Distance functions": sdTorus.
    fn eval(&self, p: DVec3) -> f64 {
        (p.x.hypot(p.z) - self.major).hypot(p.y) - self.minor
    }

    fn bounds(&self, level: f64) -> Bounds {
        let reach = self.major + self.minor;
        Bounds::centred(DVec3::new(reach, self.minor, reach) + level)
    }

    fn emit(&self, body: &mut Body<'_>, p: &str) -> String {
        body.helper(CIRCLE_DISTANCE);
        let (major, minor) = (number(self.major), number(self.minor));
        body.variable("d", format_args!("circle_distance({p}, {major}) - {minor}"))
    }
}
