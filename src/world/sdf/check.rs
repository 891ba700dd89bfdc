//! What a tree must fulfil before it is evaluated.

use glam::Vec3;
use thiserror::Error;

use super::{Bounds, NoiseId, Sdf, Shape};
use crate::world::noise::NoiseField;

/// Why a tree cannot be evaluated. The message names the node and the remedy.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SdfError {
    #[error("{node}: {what} must be {wanted}, not {found}")]
    Value {
        node: &'static str,
        what: &'static str,
        wanted: &'static str,
        found: String,
    },
    #[error("{node} refers to noise field {found}, but there are only {count}")]
    Noise {
        node: &'static str,
        found: NoiseId,
        count: usize,
    },
    #[error(
        "Scatter: reach × greatest scale + jitter × cell is {found}, more than the cell of {cell}; \
         make the cell larger or the copies smaller"
    )]
    ScatterReach { found: f32, cell: f32 },
    #[error(
        "Repeat: the sub-tree spans {low} … {high} along {axis}, farther than the period of \
         {period} from its origin; make the period larger or bound the sub-tree"
    )]
    RepeatBounds {
        axis: char,
        low: f64,
        high: f64,
        period: f32,
    },
    #[error("the tree is nested deeper than {0} levels")]
    TooDeep(usize),
}

/// Deeper trees are refused: evaluation recurses.
const MAX_DEPTH: usize = 128;

impl Sdf {
    /// Checks every number and every reference of the tree, so that [`Shape::new`] and evaluation
    /// cannot fail and the bounds of [`Shape::variation`] hold.
    ///
    /// # Errors
    /// The first node, from the root down, that breaks a rule.
    pub fn check(&self, noises: &[NoiseField]) -> Result<(), SdfError> {
        self.check_at(noises, 0)
    }

    fn check_at(&self, noises: &[NoiseField], depth: usize) -> Result<(), SdfError> {
        if depth > MAX_DEPTH {
            return Err(SdfError::TooDeep(MAX_DEPTH));
        }
        let node = self.name();
        let noise = |id: NoiseId| match noises.get(id) {
            Some(_) => Ok(()),
            None => Err(SdfError::Noise {
                node,
                found: id,
                count: noises.len(),
            }),
        };
        let positive = |what, value: f32| {
            require(
                value.is_finite() && value > 0.0,
                node,
                what,
                "finite and above 0",
                value,
            )
        };
        let not_negative = |what, value: f32| {
            require(
                value.is_finite() && value >= 0.0,
                node,
                what,
                "finite and at least 0",
                value,
            )
        };
        let finite = |what, value: f32| require(value.is_finite(), node, what, "finite", value);
        let finite3 = |what, value: Vec3| require(value.is_finite(), node, what, "finite", value);
        match self {
            Self::Empty => {}
            Self::Sphere { radius } => positive("radius", *radius)?,
            Self::Box { half } => {
                require(
                    half.is_finite() && half.cmpgt(Vec3::ZERO).all(),
                    node,
                    "half",
                    "finite and above 0",
                    half,
                )?;
            }
            Self::RoundedBox { half, radius } => {
                require(
                    half.is_finite() && half.cmpge(Vec3::ZERO).all(),
                    node,
                    "half",
                    "finite and at least 0",
                    half,
                )?;
                not_negative("radius", *radius)?;
            }
            Self::Capsule { from, to, radius } => {
                finite3("from", *from)?;
                finite3("to", *to)?;
                positive("radius", *radius)?;
            }
            Self::Cylinder {
                radius,
                half_height,
            } => {
                positive("radius", *radius)?;
                positive("half_height", *half_height)?;
            }
            Self::Torus { major, minor } => {
                positive("major", *major)?;
                positive("minor", *minor)?;
            }
            Self::Plane { normal, offset } => {
                let long_enough = normal.is_finite() && normal.length() > 1e-6;
                require(
                    long_enough,
                    node,
                    "normal",
                    "finite and longer than 0",
                    normal,
                )?;
                finite("offset", *offset)?;
            }
            Self::HeightField {
                noise: id,
                base,
                amplitude,
                step,
            } => {
                noise(*id)?;
                finite("base", *base)?;
                finite("amplitude", *amplitude)?;
                not_negative("step", *step)?;
            }
            Self::Union(_) | Self::Intersection(_) | Self::Subtraction(_) => {}
            Self::SmoothUnion { k, .. }
            | Self::SmoothIntersection { k, .. }
            | Self::SmoothSubtraction { k, .. } => not_negative("k", *k)?,
            Self::Translate { by, .. } => finite3("by", *by)?,
            Self::Rotate { degrees, .. } => finite3("degrees", *degrees)?,
            Self::Scale { by, .. } => positive("by", *by)?,
            Self::Repeat { period, .. } => {
                require(
                    period.is_finite() && period.cmpge(Vec3::ZERO).all(),
                    node,
                    "period",
                    "finite and at least 0",
                    period,
                )?;
            }
            Self::Displace {
                noise: id,
                amplitude,
                ..
            }
            | Self::Warp {
                noise: id,
                amplitude,
                ..
            } => {
                noise(*id)?;
                finite("amplitude", *amplitude)?;
            }
            Self::Scatter {
                min,
                max,
                cell,
                probability,
                jitter,
                scale,
                reach,
                ..
            } => {
                finite3("min", *min)?;
                finite3("max", *max)?;
                require(
                    min.cmple(*max).all(),
                    node,
                    "max",
                    "at least min on every axis",
                    max,
                )?;
                positive("cell", *cell)?;
                require(
                    ((*max - *min) / *cell).max_element() < 1e6,
                    node,
                    "cell",
                    "more than a millionth of the box",
                    cell,
                )?;
                require(
                    (0.0..=1.0).contains(probability),
                    node,
                    "probability",
                    "in 0 … 1",
                    probability,
                )?;
                not_negative("jitter", *jitter)?;
                positive("scale", scale.0)?;
                require(
                    scale.1.is_finite() && scale.1 >= scale.0,
                    node,
                    "scale",
                    "an increasing pair",
                    format!("{scale:?}"),
                )?;
                positive("reach", *reach)?;
                let found = reach * scale.1 + jitter * cell;
                if found > cell * (1.0 + 1e-6) {
                    return Err(SdfError::ScatterReach { found, cell: *cell });
                }
            }
        }
        for child in self.children() {
            child.check_at(noises, depth + 1)?;
        }
        if let Self::Repeat { period, of } = self {
            check_repeat(*period, Shape::new(of, noises).bounds())?;
        }
        Ok(())
    }

    /// The sub-trees of this node.
    pub fn children(&self) -> &[Self] {
        match self {
            Self::Union(of) | Self::Intersection(of) | Self::Subtraction(of) => of,
            Self::SmoothUnion { of, .. }
            | Self::SmoothIntersection { of, .. }
            | Self::SmoothSubtraction { of, .. } => of,
            Self::Translate { of, .. }
            | Self::Rotate { of, .. }
            | Self::Scale { of, .. }
            | Self::Repeat { of, .. }
            | Self::Displace { of, .. }
            | Self::Warp { of, .. }
            | Self::Scatter { of, .. } => std::slice::from_ref(of),
            _ => &[],
        }
    }

    fn name(&self) -> &'static str {
        match self {
            Self::Empty => "Empty",
            Self::Sphere { .. } => "Sphere",
            Self::Box { .. } => "Box",
            Self::RoundedBox { .. } => "RoundedBox",
            Self::Capsule { .. } => "Capsule",
            Self::Cylinder { .. } => "Cylinder",
            Self::Torus { .. } => "Torus",
            Self::Plane { .. } => "Plane",
            Self::HeightField { .. } => "HeightField",
            Self::Union(_) => "Union",
            Self::Intersection(_) => "Intersection",
            Self::Subtraction(_) => "Subtraction",
            Self::SmoothUnion { .. } => "SmoothUnion",
            Self::SmoothIntersection { .. } => "SmoothIntersection",
            Self::SmoothSubtraction { .. } => "SmoothSubtraction",
            Self::Translate { .. } => "Translate",
            Self::Rotate { .. } => "Rotate",
            Self::Scale { .. } => "Scale",
            Self::Repeat { .. } => "Repeat",
            Self::Displace { .. } => "Displace",
            Self::Warp { .. } => "Warp",
            Self::Scatter { .. } => "Scatter",
        }
    }
}

fn require(
    holds: bool,
    node: &'static str,
    what: &'static str,
    wanted: &'static str,
    found: impl std::fmt::Display,
) -> Result<(), SdfError> {
    if holds {
        Ok(())
    } else {
        Err(SdfError::Value {
            node,
            what,
            wanted,
            found: found.to_string(),
        })
    }
}

fn check_repeat(period: Vec3, bounds: Bounds) -> Result<(), SdfError> {
    for (axis, name) in ['x', 'y', 'z'].into_iter().enumerate() {
        let (low, high) = (bounds.min[axis], bounds.max[axis]);
        let farthest = high.max(-low);
        if period[axis] > 0.0 && !bounds.is_empty() && farthest >= f64::from(period[axis]) {
            return Err(SdfError::RepeatBounds {
                axis: name,
                low,
                high,
                period: period[axis],
            });
        }
    }
    Ok(())
}
