//! How far a tree reaches, and how fast its value can change.

use glam::{DMat3, DVec3};

use super::shape::Node;
use crate::world::noise::NoiseBank;

/// An axis-aligned box; empty when min > max on any axis, infinite where a side is unbounded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    pub min: DVec3,
    pub max: DVec3,
}

impl Bounds {
    pub const EMPTY: Self = Self {
        min: DVec3::INFINITY,
        max: DVec3::NEG_INFINITY,
    };
    pub const EVERYTHING: Self = Self {
        min: DVec3::NEG_INFINITY,
        max: DVec3::INFINITY,
    };

    fn centred(half: DVec3) -> Self {
        Self {
            min: -half,
            max: half,
        }
    }

    pub fn is_empty(&self) -> bool {
        self.min.cmpgt(self.max).any()
    }

    fn union(self, other: Self) -> Self {
        match (self.is_empty(), other.is_empty()) {
            (true, _) => other,
            (_, true) => self,
            _ => Self {
                min: self.min.min(other.min),
                max: self.max.max(other.max),
            },
        }
    }

    fn intersection(self, other: Self) -> Self {
        Self {
            min: self.min.max(other.min),
            max: self.max.min(other.max),
        }
    }

    fn grown(self, by: DVec3) -> Self {
        if self.is_empty() {
            self
        } else {
            Self {
                min: self.min - by,
                max: self.max + by,
            }
        }
    }
}

impl Node {
    /// See [`Shape::variation`].
    pub(super) fn variation(&self, radius: f64, bank: &NoiseBank) -> f64 {
        let greatest = |of: &[Self]| {
            of.iter()
                .map(|of| of.variation(radius, bank))
                .fold(0.0, f64::max)
        };
        match self {
            Self::Empty => 0.0,
            Self::Sphere { .. }
            | Self::Box { .. }
            | Self::Capsule { .. }
            | Self::Cylinder { .. }
            | Self::Torus { .. }
            | Self::Plane { .. } => radius,
            Self::HeightField {
                noise,
                amplitude,
                step,
                slope,
                ..
            } => {
                let rise = amplitude.abs() * bank.field(*noise).variation_xz(radius);
                // Rounding down moves each height by less than one step.
                let jump = if *step > 0.0 { *step } else { 0.0 };
                ((radius * slope).min(radius + rise) + jump) / slope
            }
            Self::Complement(of) | Self::Translate { of, .. } | Self::Rotate { of, .. } => {
                of.variation(radius, bank)
            }
            // A smooth minimum is a weighted mean of its arguments plus a bump that does not vary
            // faster: its gradient lies between theirs.
            Self::Union(of)
            | Self::Intersection(of)
            | Self::SmoothUnion { of, .. }
            | Self::SmoothIntersection { of, .. } => greatest(of),
            Self::Scale { by, of } => of.variation(radius / by, bank) * by,
            Self::Repeat(repeat) => repeat.of.variation(radius, bank).max(radius),
            Self::Displace {
                noise,
                amplitude,
                of,
            } => {
                of.variation(radius, bank) + amplitude.abs() * bank.field(*noise).variation(radius)
            }
            Self::Warp {
                noise,
                amplitude,
                of,
            } => {
                let moved = 3.0_f64.sqrt() * amplitude.abs() * bank.field(*noise).variation(radius);
                of.variation(radius + moved, bank)
            }
            Self::Scatter(scatter) => {
                // s·v(r/s) grows with s when v is concave with v(0) ≥ 0.
                let scale = f64::from(scatter.scale_low + scatter.scale_span);
                (scatter.of.variation(radius / scale, bank) * scale).max(radius)
            }
        }
    }

    /// A box that holds every point whose value lies below `level` (≥ 0).
    pub(super) fn bounds(&self, level: f64, bank: &NoiseBank) -> Bounds {
        let union = |of: &[Self], level: f64| {
            of.iter()
                .map(|of| of.bounds(level, bank))
                .fold(Bounds::EMPTY, Bounds::union)
        };
        let intersection = |of: &[Self]| {
            let boxes = of.iter().map(|of| of.bounds(level, bank));
            boxes.reduce(Bounds::intersection).unwrap_or(Bounds::EMPTY)
        };
        match self {
            Self::Empty => Bounds::EMPTY,
            Self::Sphere { radius } => Bounds::centred(DVec3::splat(radius + level)),
            Self::Box { half, radius } => Bounds::centred(*half + (radius + level)),
            Self::Capsule {
                from,
                along,
                radius,
                ..
            } => {
                let to = *from + *along;
                Bounds {
                    min: from.min(to),
                    max: from.max(to),
                }
                .grown(DVec3::splat(radius + level))
            }
            Self::Cylinder {
                radius,
                half_height,
            } => Bounds::centred(DVec3::new(*radius, *half_height, *radius) + level),
            Self::Torus { major, minor } => {
                Bounds::centred(DVec3::new(major + minor, *minor, major + minor) + level)
            }
            Self::Plane { normal, offset } => plane_bounds(*normal, offset + level),
            Self::HeightField {
                noise,
                base,
                amplitude,
                slope,
                ..
            } => {
                let highest = base + amplitude.abs() * bank.field(*noise).amplitude();
                plane_bounds(DVec3::Y, highest + level * slope)
            }
            Self::Complement(_) => Bounds::EVERYTHING,
            Self::Union(of) => union(of, level),
            // Each of the pairwise blends lowers the value by k/4 at most.
            Self::SmoothUnion { k, of } => {
                union(of, level + k / 4.0 * of.len().saturating_sub(1) as f64)
            }
            Self::Intersection(of) | Self::SmoothIntersection { of, .. } => intersection(of),
            Self::Translate { by, of } => {
                let bounds = of.bounds(level, bank);
                Bounds {
                    min: bounds.min + *by,
                    max: bounds.max + *by,
                }
            }
            Self::Rotate { inverse, of } => rotated(of.bounds(level, bank), inverse.transpose()),
            Self::Scale { by, of } => {
                let bounds = of.bounds(level / by, bank);
                Bounds {
                    min: bounds.min * *by,
                    max: bounds.max * *by,
                }
            }
            Self::Repeat(repeat) => {
                let one = repeat.of.bounds(level, bank);
                let repeats = repeat.period.cmpgt(DVec3::ZERO);
                Bounds {
                    min: DVec3::select(repeats, DVec3::NEG_INFINITY, one.min),
                    max: DVec3::select(repeats, DVec3::INFINITY, one.max),
                }
            }
            Self::Displace {
                noise,
                amplitude,
                of,
            } => of.bounds(
                level + amplitude.abs() * bank.field(*noise).amplitude(),
                bank,
            ),
            Self::Warp {
                noise,
                amplitude,
                of,
            } => {
                let moved = amplitude.abs() * bank.field(*noise).amplitude();
                of.bounds(level, bank).grown(DVec3::splat(moved))
            }
            Self::Scatter(scatter) => {
                let (centre, half) = scatter.content();
                Bounds {
                    min: centre - half,
                    max: centre + half,
                }
                .grown(DVec3::splat(level))
            }
        }
    }
}

/// Bounds of dot(p, normal) < offset: finite on one side where the normal follows an axis.
fn plane_bounds(normal: DVec3, offset: f64) -> Bounds {
    let mut bounds = Bounds::EVERYTHING;
    for axis in 0..3 {
        if normal[axis] == 1.0 {
            bounds.max[axis] = offset;
        } else if normal[axis] == -1.0 {
            bounds.min[axis] = -offset;
        }
    }
    bounds
}

fn rotated(bounds: Bounds, rotation: DMat3) -> Bounds {
    if bounds.is_empty() {
        return bounds;
    }
    if !(bounds.min.is_finite() && bounds.max.is_finite()) {
        return Bounds::EVERYTHING;
    }
    let centre = (bounds.min + bounds.max) / 2.0;
    let half = (bounds.max - bounds.min) / 2.0;
    let turned = rotation.x_axis.abs() * half.x
        + rotation.y_axis.abs() * half.y
        + rotation.z_axis.abs() * half.z;
    let centre = rotation * centre;
    Bounds {
        min: centre - turned,
        max: centre + turned,
    }
}
