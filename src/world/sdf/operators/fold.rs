//! Minima and maxima over sub-trees: the common part of union, intersection and subtraction.
//!
//! A sub-tree with noise or copies costs much more than bounds on its value: noise cannot exceed its
//! amplitude, copies cannot leave their box. If the bound shows that the sub-tree cannot change the
//! value known so far, the GPU does not evaluate it. The result is the same.

use glam::DVec3;

use crate::world::sdf::wgsl::{Body, FAR, number};
use crate::world::sdf::{Bounds, Node, Side, Tree};

/// The combined values of sub-trees; +∞ without any.
#[derive(Debug)]
pub struct Fold {
    pub combine: Combine,
    pub of: Vec<Tree>,
}

/// How the values of sub-trees combine: their minimum or maximum, blended over the width k (voxels).
#[derive(Clone, Copy, Debug)]
pub struct Combine {
    pub largest: bool,
    pub k: f64,
}

/// The quadratic form of Quilez, "Smooth minimum": lower than min(a, b) by k/4 at most; k > 0.
const SMOOTH_MIN: &str = "
fn smooth_min(a: f32, b: f32, k: f32) -> f32 {
    let blend = max(k - abs(a - b), 0.0);
    return min(a, b) - blend * blend / (4.0 * k);
}
";

/// Quilez, "Smooth minimum", the quadratic one: lower than min(a, b) by at most k/4.
fn smooth_min(a: f64, b: f64, k: f64) -> f64 {
    if k <= 0.0 {
        return a.min(b);
    }
    // The difference of two infinities is NaN, which max() ignores: they do not blend.
    let blend = (k - (a - b).abs()).max(0.0);
    a.min(b) - blend * blend / (4.0 * k)
}

impl Combine {
    fn values(self, a: f64, b: f64) -> f64 {
        if self.largest {
            -smooth_min(-a, -b, self.k)
        } else {
            smooth_min(a, b, self.k)
        }
    }

    /// The most by which the blends of `count` sub-trees move the value: each of the pairwise blends by
    /// k/4, away from the sub-trees' values.
    fn blends(self, count: usize) -> f64 {
        self.k / 4.0 * count.saturating_sub(1) as f64
    }

    /// A WGSL expression.
    fn emit(self, body: &mut Body<'_>, a: &str, b: &str) -> String {
        if self.k > 0.0 {
            body.helper(SMOOTH_MIN);
        }
        let k = number(self.k);
        match (self.largest, self.k > 0.0) {
            (false, false) => format!("min({a}, {b})"),
            (true, false) => format!("max({a}, {b})"),
            (false, true) => format!("smooth_min({a}, {b}, {k})"),
            (true, true) => format!("-smooth_min(-{a}, -{b}, {k})"),
        }
    }

    /// Appends the statements that combine the value known so far with one more sub-tree, and skip the
    /// sub-tree if its bound shows that it cannot change the value.
    fn emit_one(self, body: &mut Body<'_>, known: &str, node: &Tree, p: &str) -> String {
        let side = match self.largest {
            false => Side::Lower,
            true => Side::Upper,
        };
        let bound = match node.is_costly() {
            true => body.bound(node, p, side),
            false => None,
        };
        let Some(bound) = bound else {
            let value = node.emit(body, p);
            let combined = self.emit(body, known, &value);
            return body.variable("d", format_args!("{combined}"));
        };
        let name = body.name("d");
        let k = number(self.k);
        let counts = match self.largest {
            false => format!("{bound} < {known} + {k}"),
            true => format!("{bound} > {known} - {k}"),
        };
        body.push(format_args!(
            "    var {name} = {known};\n    if {counts} {{\n"
        ));
        let value = node.emit(body, p);
        let combined = self.emit(body, known, &value);
        body.push(format_args!("    {name} = {combined};\n    }}\n"));
        name
    }
}

impl Node for Fold {
    fn eval(&self, p: DVec3) -> f64 {
        let values = self.of.iter().map(|of| of.eval(p));
        let combined = values.reduce(|a, b| self.combine.values(a, b));
        combined.unwrap_or(f64::INFINITY)
    }

    /// A smooth minimum is a weighted mean of its arguments plus a bump that does not vary faster: its
    /// gradient lies between those of the arguments.
    fn variation(&self, radius: f64) -> f64 {
        let all = self.of.iter().map(|of| of.variation(radius));
        all.fold(0.0, f64::max)
    }

    fn bounds(&self, level: f64) -> Bounds {
        let combined = if self.combine.largest {
            let boxes = self.of.iter().map(|of| of.bounds(level));
            boxes.reduce(Bounds::intersection)
        } else {
            let level = level + self.combine.blends(self.of.len());
            let boxes = self.of.iter().map(|of| of.bounds(level));
            boxes.reduce(Bounds::union)
        };
        combined.unwrap_or(Bounds::EMPTY)
    }

    fn is_costly(&self) -> bool {
        self.of.iter().any(|of| of.is_costly())
    }

    fn emit(&self, body: &mut Body<'_>, p: &str) -> String {
        let mut order: Vec<&Tree> = self.of.iter().collect();
        if self.combine.k == 0.0 {
            // Sharp combinations do not depend on the order: cheap sub-trees come first.
            order.sort_by_key(|node| node.is_costly());
        }
        let mut known: Option<String> = None;
        for node in order {
            known = Some(match known {
                None => node.emit(body, p),
                Some(known) => self.combine.emit_one(body, &known, node, p),
            });
        }
        known.unwrap_or_else(|| FAR.to_owned())
    }

    fn emit_bound(&self, body: &mut Body<'_>, p: &str, side: Side) -> Option<String> {
        let all = self.of.iter().map(|of| body.bound(of, p, side));
        let bounds: Vec<Option<String>> = all.collect();
        // A single sub-tree bounds a minimum from above and a maximum from below.
        let one_is_enough = (side == Side::Lower) == self.combine.largest;
        if !one_is_enough && bounds.iter().any(Option::is_none) {
            return None;
        }
        let sharp = Combine {
            k: 0.0,
            ..self.combine
        };
        let bounds = bounds.into_iter().flatten();
        let combined = bounds.reduce(|a, b| sharp.emit(body, &a, &b))?;
        let margin = match one_is_enough {
            true => 0.0,
            false => side.margin(self.combine.blends(self.of.len())),
        };
        let margin = number(margin);
        Some(body.variable("b", format_args!("{combined} + {margin}")))
    }
}
