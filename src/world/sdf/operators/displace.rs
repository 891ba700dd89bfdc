//! A sub-tree with a noise added to its value.

use std::sync::Arc;

use glam::DVec3;

use crate::world::noise::NoiseBank;
use crate::world::sdf::keys::{Length, NoiseName, SubTree, keys};
use crate::world::sdf::noise::Noise;
use crate::world::sdf::wgsl::{Body, number};
use crate::world::sdf::{Bounds, Form, Node, Side, Tree};

keys! {
    /// Adds amplitude · noise(p) to the value: moves the surface along its normal.
    pub struct Displace {
        pub noise: NoiseName,
        /// Voxels for a noise of 1.
        pub amplitude: Length,
        pub of: SubTree,
    }
}

impl Form for Displace {
    fn prepare(&self, bank: &Arc<NoiseBank>) -> Tree {
        Arc::new(Displaced {
            noise: Noise::new(self.noise, bank),
            amplitude: self.amplitude,
            of: self.of.prepare(bank),
        })
    }
}

#[derive(Debug)]
struct Displaced {
    noise: Noise,
    amplitude: f64,
    of: Tree,
}

impl Displaced {
    /// The most that the noise adds, in voxels.
    fn most(&self) -> f64 {
        self.amplitude.abs() * self.noise.field().amplitude()
    }
}

impl Node for Displaced {
    fn eval(&self, p: DVec3) -> f64 {
        self.of.eval(p) + self.amplitude * self.noise.value(p)
    }

    fn variation(&self, radius: f64) -> f64 {
        let of_noise = self.noise.field().variation(radius);
        self.of.variation(radius) + self.amplitude.abs() * of_noise
    }

    fn bounds(&self, level: f64) -> Bounds {
        self.of.bounds(level + self.most())
    }

    fn is_costly(&self) -> bool {
        true
    }

    fn emit(&self, body: &mut Body<'_>, p: &str) -> String {
        let of = self.of.emit(body, p);
        let noise = self.noise.emit(body, p);
        let amplitude = number(self.amplitude);
        body.variable("d", format_args!("{of} + {amplitude} * {noise}"))
    }

    fn emit_bound(&self, body: &mut Body<'_>, p: &str, side: Side) -> Option<String> {
        let of = body.bound(&self.of, p, side)?;
        let margin = number(side.margin(self.most()));
        Some(body.variable("b", format_args!("{of} + {margin}")))
    }
}
