//! A sub-tree evaluated at points that a noise moves.

use std::sync::Arc;

use glam::DVec3;

use crate::world::noise::NoiseBank;
use crate::world::sdf::keys::{Length, NoiseName, SubTree, keys};
use crate::world::sdf::noise::Noise;
use crate::world::sdf::wgsl::{Body, number, vector};
use crate::world::sdf::{Bounds, Form, Node, Side, Tree};

keys! {
    /// Evaluates a sub-tree at p + amplitude · (noise(p), noise(p + shift₁), noise(p + shift₂)).
    pub struct Warp {
        pub noise: NoiseName,
        /// Voxels along each axis for a noise of 1.
        pub amplitude: Length,
        pub of: SubTree,
    }
}

/// Offsets (voxels) at which the second and third component read the noise, relative to the first.
const SHIFTS: [DVec3; 2] = [
    DVec3::new(113.5, 27.25, 71.75),
    DVec3::new(-59.25, 167.5, -23.125),
];

impl Form for Warp {
    fn prepare(&self, bank: &Arc<NoiseBank>) -> Tree {
        Arc::new(Warped {
            noise: Noise::new(self.noise, bank),
            amplitude: self.amplitude,
            of: self.of.prepare(bank),
        })
    }
}

#[derive(Debug)]
struct Warped {
    noise: Noise,
    amplitude: f64,
    of: Tree,
}

impl Warped {
    /// The most that a point moves, or the most that two points move apart, if the noise on one axis
    /// changes by `noise`.
    fn moved(&self, noise: f64) -> f64 {
        3.0_f64.sqrt() * self.amplitude.abs() * noise
    }
}

impl Node for Warped {
    fn eval(&self, p: DVec3) -> f64 {
        let offset = DVec3::new(
            self.noise.value(p),
            self.noise.value(p + SHIFTS[0]),
            self.noise.value(p + SHIFTS[1]),
        );
        self.of.eval(p + self.amplitude * offset)
    }

    fn variation(&self, radius: f64) -> f64 {
        let moved = self.moved(self.noise.field().variation(radius));
        self.of.variation(radius + moved)
    }

    fn bounds(&self, level: f64) -> Bounds {
        let moved = self.amplitude.abs() * self.noise.field().amplitude();
        self.of.bounds(level).grown(DVec3::splat(moved))
    }

    fn is_costly(&self) -> bool {
        true
    }

    fn emit(&self, body: &mut Body<'_>, p: &str) -> String {
        let x = self.noise.emit(body, p);
        let [y, z] = SHIFTS.map(|shift| self.noise.emit(body, &format!("{p} + {}", vector(shift))));
        let amplitude = number(self.amplitude);
        let q = body.variable(
            "p",
            format_args!("{p} + {amplitude} * vec3f({x}, {y}, {z})"),
        );
        self.of.emit(body, &q)
    }

    fn emit_bound(&self, body: &mut Body<'_>, p: &str, side: Side) -> Option<String> {
        let most = self
            .of
            .variation(self.moved(self.noise.field().amplitude()));
        let of = body.bound(&self.of, p, side)?;
        let margin = number(side.margin(most));
        Some(body.variable("b", format_args!("{of} + {margin}")))
    }
}
