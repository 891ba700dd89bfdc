//! The prepared form of a tree: evaluated in f64, with bounds on how fast and how far it reaches.

use std::sync::Arc;

use glam::{DMat3, DVec3};

use super::bounds::Bounds;
use super::repeat::Repeat;
use super::scatter::Scatter;
use super::{NoiseId, Sdf};
use crate::world::noise::{NoiseBank, NoiseField};

/// A tree ready for evaluation on any thread: constants in f64, noise tables built.
#[derive(Clone, Debug)]
pub struct Shape {
    pub(super) root: Node,
    bank: Arc<NoiseBank>,
}

impl Shape {
    /// Prepares a checked tree ([`Sdf::check`]) over the world's noise fields.
    pub fn new(sdf: &Sdf, noises: &[NoiseField]) -> Self {
        Self::with_bank(sdf, Arc::new(NoiseBank::new(noises)))
    }

    /// The same, sharing tables that are built already.
    pub fn with_bank(sdf: &Sdf, bank: Arc<NoiseBank>) -> Self {
        Self {
            root: Node::new(sdf, &bank),
            bank,
        }
    }

    /// Value at a point of world space: negative inside stone. At most the distance to the surface
    /// times [`Self::lipschitz`] (jumps aside), and +∞ where there is nothing at all.
    pub fn eval(&self, p_ws: DVec3) -> f64 {
        self.root.eval(p_ws, &self.bank)
    }

    /// Upper bound of |eval(p) − eval(q)| over all p, q at most `radius` apart. Where
    /// |eval(centre)| exceeds it, a block of this half diagonal is all stone or all air.
    ///
    /// Not proportional to the radius: noise cannot exceed its amplitude however far one goes, and a
    /// stepped height field jumps however near one stays.
    pub fn variation(&self, radius: f64) -> f64 {
        self.root.variation(radius, &self.bank)
    }

    /// Lipschitz constant between jumps: the slope of [`Self::variation`] at 0.
    pub fn lipschitz(&self) -> f64 {
        let radius = 1e-9;
        (self.variation(2.0 * radius) - self.variation(radius)) / radius
    }

    /// A box that holds all stone; infinite where none is known.
    pub fn bounds(&self) -> Bounds {
        self.root.bounds(0.0, &self.bank)
    }

    /// The noise fields behind the tree.
    pub fn bank(&self) -> &Arc<NoiseBank> {
        &self.bank
    }
}

/// A node with everything that does not depend on the point worked out. Subtraction becomes an
/// intersection with complements.
#[derive(Clone, Debug)]
pub(super) enum Node {
    Empty,
    Sphere {
        radius: f64,
    },
    /// A box of this half extent, grown by `radius`.
    Box {
        half: DVec3,
        radius: f64,
    },
    Capsule {
        from: DVec3,
        along: DVec3,
        inverse_length_squared: f64,
        radius: f64,
    },
    Cylinder {
        radius: f64,
        half_height: f64,
    },
    Torus {
        major: f64,
        minor: f64,
    },
    /// The normal has length 1.
    Plane {
        normal: DVec3,
        offset: f64,
    },
    HeightField {
        noise: NoiseId,
        base: f64,
        amplitude: f64,
        step: f64,
        slope: f64,
    },
    Complement(Box<Node>),
    Union(Vec<Node>),
    Intersection(Vec<Node>),
    SmoothUnion {
        k: f64,
        of: Vec<Node>,
    },
    SmoothIntersection {
        k: f64,
        of: Vec<Node>,
    },
    Translate {
        by: DVec3,
        of: Box<Node>,
    },
    /// Rotates points of the outer space into the sub-tree's.
    Rotate {
        inverse: DMat3,
        of: Box<Node>,
    },
    Scale {
        by: f64,
        of: Box<Node>,
    },
    Repeat(Box<Repeat>),
    Displace {
        noise: NoiseId,
        amplitude: f64,
        of: Box<Node>,
    },
    Warp {
        noise: NoiseId,
        amplitude: f64,
        of: Box<Node>,
    },
    Scatter(Box<Scatter>),
}

/// Where the second and third component of a [`Sdf::Warp`] read the noise, relative to the first.
pub(super) const WARP_SHIFTS: [DVec3; 2] = [
    DVec3::new(113.5, 27.25, 71.75),
    DVec3::new(-59.25, 167.5, -23.125),
];

impl Node {
    /// Distance functions of the primitives: Quilez, "Distance functions".
    pub(super) fn eval(&self, p: DVec3, bank: &NoiseBank) -> f64 {
        match self {
            Self::Empty => f64::INFINITY,
            Self::Sphere { radius } => p.length() - radius,
            Self::Box { half, radius } => {
                let q = p.abs() - *half;
                q.max(DVec3::ZERO).length() + q.max_element().min(0.0) - radius
            }
            Self::Capsule {
                from,
                along,
                inverse_length_squared,
                radius,
            } => {
                let from_end = p - *from;
                let t = (from_end.dot(*along) * inverse_length_squared).clamp(0.0, 1.0);
                (from_end - *along * t).length() - radius
            }
            Self::Cylinder {
                radius,
                half_height,
            } => {
                let side = p.x.hypot(p.z) - radius;
                let top = p.y.abs() - half_height;
                side.max(0.0).hypot(top.max(0.0)) + side.max(top).min(0.0)
            }
            Self::Torus { major, minor } => (p.x.hypot(p.z) - major).hypot(p.y) - minor,
            Self::Plane { normal, offset } => p.dot(*normal) - offset,
            Self::HeightField {
                noise,
                base,
                amplitude,
                step,
                slope,
            } => {
                let mut rise = amplitude * bank.value(*noise, p.with_y(0.0));
                if *step > 0.0 {
                    rise = (rise / step).floor() * step;
                }
                (p.y - base - rise) / slope
            }
            Self::Complement(of) => -of.eval(p, bank),
            Self::Union(of) => of
                .iter()
                .map(|of| of.eval(p, bank))
                .fold(f64::INFINITY, f64::min),
            Self::Intersection(of) => of
                .iter()
                .map(|of| of.eval(p, bank))
                .reduce(f64::max)
                .unwrap_or(f64::INFINITY),
            Self::SmoothUnion { k, of } => of
                .iter()
                .map(|of| of.eval(p, bank))
                .reduce(|a, b| smooth_min(a, b, *k))
                .unwrap_or(f64::INFINITY),
            Self::SmoothIntersection { k, of } => of
                .iter()
                .map(|of| of.eval(p, bank))
                .reduce(|a, b| -smooth_min(-a, -b, *k))
                .unwrap_or(f64::INFINITY),
            Self::Translate { by, of } => of.eval(p - *by, bank),
            Self::Rotate { inverse, of } => of.eval(*inverse * p, bank),
            Self::Scale { by, of } => of.eval(p / by, bank) * by,
            Self::Repeat(repeat) => repeat.eval(p, bank),
            Self::Displace {
                noise,
                amplitude,
                of,
            } => of.eval(p, bank) + amplitude * bank.value(*noise, p),
            Self::Warp {
                noise,
                amplitude,
                of,
            } => {
                let offset = DVec3::new(
                    bank.value(*noise, p),
                    bank.value(*noise, p + WARP_SHIFTS[0]),
                    bank.value(*noise, p + WARP_SHIFTS[1]),
                );
                of.eval(p + *amplitude * offset, bank)
            }
            Self::Scatter(scatter) => scatter.eval(p, bank),
        }
    }
}

/// Quilez, "Smooth minimum", the quadratic one: lower than min(a, b) by at most k/4.
fn smooth_min(a: f64, b: f64, k: f64) -> f64 {
    // The difference of two infinities is NaN, which max() passes over: they do not blend.
    let blend = (k - (a - b).abs()).max(0.0);
    if k > 0.0 {
        a.min(b) - blend * blend / (4.0 * k)
    } else {
        a.min(b)
    }
}
