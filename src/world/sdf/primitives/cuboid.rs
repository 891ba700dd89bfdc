//! A box. World files call it `Box`, which has another meaning in Rust.

use std::sync::Arc;

use glam::DVec3;

use crate::world::noise::NoiseBank;
use crate::world::sdf::keys::{Positive, Three, keys};
use crate::world::sdf::wgsl::{Body, number, vector};
use crate::world::sdf::{Bounds, Form, Node, Tree};

keys! {
    /// A box along the axes, around the origin.
    pub struct Cuboid {
        /// Half of its extent, voxels.
        pub half: Three<Positive>,
    }
}

impl Form for Cuboid {
    fn prepare(&self, _bank: &Arc<NoiseBank>) -> Tree {
        Arc::new(Grown {
            half: self.half,
            radius: 0.0,
        })
    }
}

/// A box of this half extent, grown by `radius` on all sides.
#[derive(Debug)]
pub struct Grown {
    pub half: DVec3,
    pub radius: f64,
}

/// Quilez, "Distance functions": sdBox.
pub const BOX_DISTANCE: &str = "
fn box_distance(p: vec3f, half: vec3f) -> f32 {
    let q = abs(p) - half;
    return length(max(q, vec3f(0.0))) + min(max(q.x, max(q.y, q.z)), 0.0);
}
";

impl Node for Grown {
    /// Quilez, "Distance functions": sdBox.
    fn eval(&self, p: DVec3) -> f64 {
        let q = p.abs() - self.half;
        q.max(DVec3::ZERO).length() + q.max_element().min(0.0) - self.radius
    }

    fn bounds(&self, level: f64) -> Bounds {
        Bounds::centred(self.half + (self.radius + level))
    }

    fn emit(&self, body: &mut Body<'_>, p: &str) -> String {
        body.helper(BOX_DISTANCE);
        let (half, radius) = (vector(self.half), number(self.radius));
        body.variable("d", format_args!("box_distance({p}, {half}) - {radius}"))
    }
}
