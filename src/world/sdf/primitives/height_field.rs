//! Ground whose height follows a noise.

use std::sync::Arc;

use glam::DVec3;

use crate::world::noise::NoiseBank;
use crate::world::sdf::keys::{Length, NoiseName, NotNegative, Or, keys};
use crate::world::sdf::noise::Noise;
use crate::world::sdf::wgsl::{Body, number};
use crate::world::sdf::{Bounds, Form, Node, Side, Tree};

/// Steps that a rise may lack to count as a whole number of them. A lattice noise is exactly 0 along whole lines of its
/// lattice; there rounding makes the rise of one device a little less than 0, and its ground would be a step lower than
/// that of another.
const ROUNDING: f64 = 1e-5;

keys! {
    /// Solid where y < base + amplitude · noise(x, 0, z); the rise above `base` is rounded down to
    /// whole multiples of `step`. Not a distance: the value is divided by its own Lipschitz constant.
    pub struct HeightField {
        pub noise: NoiseName,
        /// Height where the noise is 0, voxels.
        pub base: Length,
        /// Voxels for a noise of 1.
        pub amplitude: Length,
        /// Voxels; 0: smooth.
        pub step: Or<NotNegative, 0>,
    }
}

impl Form for HeightField {
    fn prepare(&self, bank: &Arc<NoiseBank>) -> Tree {
        let noise = Noise::new(self.noise, bank);
        let slope = self.amplitude * noise.field().lipschitz_xz();
        Arc::new(Ground {
            noise,
            base: self.base,
            amplitude: self.amplitude,
            step: self.step,
            slope: slope.hypot(1.0),
        })
    }
}

#[derive(Debug)]
struct Ground {
    noise: Noise,
    base: f64,
    amplitude: f64,
    step: f64,
    /// Lipschitz constant of y − height(x, z).
    slope: f64,
}

impl Ground {
    /// The most that the height differs from the base, before rounding.
    fn greatest_rise(&self) -> f64 {
        self.amplitude.abs() * self.noise.field().amplitude()
    }
}

impl Node for Ground {
    fn eval(&self, p: DVec3) -> f64 {
        let mut rise = self.amplitude * self.noise.value(p.with_y(0.0));
        if self.step > 0.0 {
            rise = (rise / self.step + ROUNDING).floor() * self.step;
        }
        (p.y - self.base - rise) / self.slope
    }

    fn variation(&self, radius: f64) -> f64 {
        let rise = self.amplitude.abs() * self.noise.field().variation_xz(radius);
        // Rounding down moves each height by less than one step.
        ((radius * self.slope).min(radius + rise) + self.step) / self.slope
    }

    fn bounds(&self, level: f64) -> Bounds {
        let highest = self.base + self.greatest_rise() + ROUNDING * self.step;
        Bounds::half_space(DVec3::Y, highest + level * self.slope)
    }

    fn is_costly(&self) -> bool {
        true
    }

    fn emit(&self, body: &mut Body<'_>, p: &str) -> String {
        let noise = self.noise.emit(body, &format!("vec3f({p}.x, 0.0, {p}.z)"));
        let amplitude = number(self.amplitude);
        let mut rise = body.variable("r", format_args!("{amplitude} * {noise}"));
        if self.step > 0.0 {
            let step = number(self.step);
            rise = body.variable(
                "r",
                format_args!("floor({rise} / {step} + {}) * {step}", number(ROUNDING)),
            );
        }
        let (base, slope) = (number(self.base), number(self.slope));
        body.variable("d", format_args!("({p}.y - {base} - {rise}) / {slope}"))
    }

    fn emit_bound(&self, body: &mut Body<'_>, p: &str, side: Side) -> Option<String> {
        let height = match side {
            Side::Lower => self.base + self.greatest_rise() + ROUNDING * self.step,
            // Steps round down.
            Side::Upper => self.base - self.greatest_rise() - self.step,
        };
        let (height, slope) = (number(height), number(self.slope));
        Some(body.variable("b", format_args!("({p}.y - {height}) / {slope}")))
    }
}
