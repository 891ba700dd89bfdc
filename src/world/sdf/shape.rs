//! The prepared form of a tree: evaluated in f64, with bounds on how fast and how far it reaches.

use std::sync::Arc;

use glam::{DMat3, DVec3, EulerRot, Vec3};

use super::bounds::Bounds;
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

/// A sub-tree in every tile; the copy of the nearest neighbour tile counts too, so that the distance
/// is continuous across tiles and the sub-tree may lean over its tile's edge.
#[derive(Clone, Debug)]
pub(super) struct Repeat {
    /// 0 on the axes that do not repeat.
    pub period: DVec3,
    /// The sub-tree's bounds: the distance to them is what a copy is at least away.
    pub bounds: Bounds,
    /// No copy beyond the nearest two along each axis is nearer than this.
    pub clearance: f64,
    pub of: Node,
}

/// Where the second and third component of a [`Sdf::Warp`] read the noise, relative to the first.
pub(super) const WARP_SHIFTS: [DVec3; 2] = [
    DVec3::new(113.5, 27.25, 71.75),
    DVec3::new(-59.25, 167.5, -23.125),
];

impl Node {
    pub(super) fn new(sdf: &Sdf, bank: &NoiseBank) -> Self {
        let boxed = |of: &Sdf| Box::new(Self::new(of, bank));
        let all = |of: &[Sdf]| of.iter().map(|of| Self::new(of, bank)).collect::<Vec<_>>();
        let first_without_rest = |of: &[Sdf]| {
            let mut nodes = all(of);
            for node in nodes.iter_mut().skip(1) {
                let cut = std::mem::replace(node, Self::Empty);
                *node = Self::Complement(Box::new(cut));
            }
            nodes
        };
        match *sdf {
            Sdf::Empty => Self::Empty,
            Sdf::Sphere { radius } => Self::Sphere {
                radius: radius.into(),
            },
            Sdf::Box { half } => Self::Box {
                half: half.as_dvec3(),
                radius: 0.0,
            },
            Sdf::RoundedBox { half, radius } => Self::Box {
                half: half.as_dvec3(),
                radius: radius.into(),
            },
            Sdf::Capsule { from, to, radius } => {
                let along = to.as_dvec3() - from.as_dvec3();
                let length_squared = along.length_squared();
                Self::Capsule {
                    from: from.as_dvec3(),
                    along,
                    // A capsule of no length is a sphere.
                    inverse_length_squared: if length_squared > 0.0 {
                        1.0 / length_squared
                    } else {
                        0.0
                    },
                    radius: radius.into(),
                }
            }
            Sdf::Cylinder {
                radius,
                half_height,
            } => Self::Cylinder {
                radius: radius.into(),
                half_height: half_height.into(),
            },
            Sdf::Torus { major, minor } => Self::Torus {
                major: major.into(),
                minor: minor.into(),
            },
            Sdf::Plane { normal, offset } => {
                let normal = normal.as_dvec3();
                let length = normal.length();
                Self::Plane {
                    normal: normal / length,
                    offset: f64::from(offset) / length,
                }
            }
            Sdf::HeightField {
                noise,
                base,
                amplitude,
                step,
            } => {
                let amplitude = f64::from(amplitude);
                let slope = amplitude * bank.field(noise).lipschitz_xz();
                Self::HeightField {
                    noise,
                    base: base.into(),
                    amplitude,
                    step: step.into(),
                    slope: slope.hypot(1.0),
                }
            }
            Sdf::Union(ref of) => Self::Union(all(of)),
            Sdf::Intersection(ref of) => Self::Intersection(all(of)),
            Sdf::Subtraction(ref of) => Self::Intersection(first_without_rest(of)),
            Sdf::SmoothUnion { k, ref of } => Self::SmoothUnion {
                k: k.into(),
                of: all(of),
            },
            Sdf::SmoothIntersection { k, ref of } => Self::SmoothIntersection {
                k: k.into(),
                of: all(of),
            },
            Sdf::SmoothSubtraction { k, ref of } => Self::SmoothIntersection {
                k: k.into(),
                of: first_without_rest(of),
            },
            Sdf::Translate { by, ref of } => Self::Translate {
                by: by.as_dvec3(),
                of: boxed(of),
            },
            Sdf::Rotate { degrees, ref of } => {
                let [x, y, z] = degrees.as_dvec3().to_array().map(f64::to_radians);
                // x first, then y, then z: the matrices multiply from the left.
                let rotation = DMat3::from_euler(EulerRot::ZYX, z, y, x);
                Self::Rotate {
                    inverse: rotation.transpose(),
                    of: boxed(of),
                }
            }
            Sdf::Scale { by, ref of } => Self::Scale {
                by: by.into(),
                of: boxed(of),
            },
            Sdf::Repeat { period, ref of } => Self::Repeat(Box::new(Repeat::new(
                period.as_dvec3(),
                Self::new(of, bank),
                bank,
            ))),
            Sdf::Displace {
                noise,
                amplitude,
                ref of,
            } => Self::Displace {
                noise,
                amplitude: amplitude.into(),
                of: boxed(of),
            },
            Sdf::Warp {
                noise,
                amplitude,
                ref of,
            } => Self::Warp {
                noise,
                amplitude: amplitude.into(),
                of: boxed(of),
            },
            Sdf::Scatter {
                min,
                max,
                cell,
                probability,
                jitter,
                scale,
                reach,
                seed,
                ref of,
            } => {
                let cells = ((max - min) / cell).round().max(Vec3::ONE);
                Self::Scatter(Box::new(Scatter {
                    start: (min + max) / 2.0 - cells * cell / 2.0,
                    cells: cells.as_uvec3(),
                    cell,
                    threshold: (f64::from(probability) * 16_777_216.0).round() as u32,
                    jitter: jitter * cell,
                    scale_low: scale.0,
                    scale_span: scale.1 - scale.0,
                    reach,
                    seed_bits: seed.wrapping_mul(0x9e37_79b9),
                    of: Self::new(of, bank),
                }))
            }
        }
    }

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

impl Repeat {
    fn new(period: DVec3, of: Node, bank: &NoiseBank) -> Self {
        let bounds = of.bounds(0.0, bank);
        let clearance = (0..3)
            .filter(|&axis| period[axis] > 0.0)
            .map(|axis| period[axis] - bounds.max[axis].max(-bounds.min[axis]))
            .fold(f64::INFINITY, f64::min);
        Self {
            period,
            bounds,
            clearance,
            of,
        }
    }

    fn eval(&self, p: DVec3, bank: &NoiseBank) -> f64 {
        let repeats = self.period.cmpgt(DVec3::ZERO);
        let period = DVec3::select(repeats, self.period, DVec3::ONE);
        let tile = DVec3::select(repeats, (p / period).round(), DVec3::ZERO);
        let local = p - tile * self.period;
        // Towards the neighbour that the point leans to.
        let lean = DVec3::select(local.cmplt(DVec3::ZERO), -self.period, self.period);
        let mut nearest = self.clearance;
        for corner in 0..8 {
            let towards = DVec3::new(
                (corner & 1) as f64,
                (corner >> 1 & 1) as f64,
                (corner >> 2) as f64,
            );
            if (towards.cmpgt(DVec3::ZERO) & !repeats).any() {
                continue;
            }
            let q = local - towards * lean;
            let to_bounds = (self.bounds.min - q)
                .max(q - self.bounds.max)
                .max(DVec3::ZERO)
                .length();
            if to_bounds < nearest {
                let value = self.of.eval(q, bank);
                // Outside of its bounds a copy is at least as far as they are, whatever its own
                // function says: without this the cut-off would not be continuous.
                let value = if to_bounds > 0.0 {
                    value.max(to_bounds)
                } else {
                    value
                };
                nearest = nearest.min(value);
            }
        }
        nearest
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
