//! From a description to nodes with their constants worked out.

use glam::{DMat3, EulerRot, Vec3};

use super::Sdf;
use super::repeat::Repeat;
use super::scatter::Scatter;
use super::shape::Node;
use crate::world::noise::NoiseBank;

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
}
