//! The extent of a tree.

use glam::{DMat3, DVec3};

/// An axis-aligned box; empty if min > max on any axis, infinite where a side is unbounded.
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

    /// From −half to half.
    pub(super) fn centred(half: DVec3) -> Self {
        Self {
            min: -half,
            max: half,
        }
    }

    pub fn is_empty(&self) -> bool {
        self.min.cmpgt(self.max).any()
    }

    pub(super) fn union(self, other: Self) -> Self {
        match (self.is_empty(), other.is_empty()) {
            (true, _) => other,
            (_, true) => self,
            _ => Self {
                min: self.min.min(other.min),
                max: self.max.max(other.max),
            },
        }
    }

    pub(super) fn intersection(self, other: Self) -> Self {
        Self {
            min: self.min.max(other.min),
            max: self.max.min(other.max),
        }
    }

    /// Extended outwards by this much along each axis.
    pub(super) fn grown(self, by: DVec3) -> Self {
        if self.is_empty() {
            self
        } else {
            Self {
                min: self.min - by,
                max: self.max + by,
            }
        }
    }

    /// Bounds of dot(p, normal) < offset: finite on one side where the normal follows an axis.
    pub(super) fn half_space(normal: DVec3, offset: f64) -> Self {
        let mut bounds = Self::EVERYTHING;
        for axis in 0..3 {
            if normal[axis] == 1.0 {
                bounds.max[axis] = offset;
            } else if normal[axis] == -1.0 {
                bounds.min[axis] = -offset;
            }
        }
        bounds
    }

    /// A box around this one after rotation; infinite if this one is.
    pub(super) fn rotated(self, rotation: DMat3) -> Self {
        if self.is_empty() {
            return self;
        }
        if !(self.min.is_finite() && self.max.is_finite()) {
            return Self::EVERYTHING;
        }
        let centre = (self.min + self.max) / 2.0;
        let half = (self.max - self.min) / 2.0;
        let turned = rotation.x_axis.abs() * half.x
            + rotation.y_axis.abs() * half.y
            + rotation.z_axis.abs() * half.z;
        let centre = rotation * centre;
        Self {
            min: centre - turned,
            max: centre + turned,
        }
    }
}
