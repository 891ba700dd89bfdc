//! Minima and maxima over sub-trees, passing over those that cannot count.
//!
//! A sub-tree with noise or copies costs much more than bounds on its value: noise cannot exceed its
//! amplitude, copies cannot leave their box. Where the bound shows that the sub-tree would lose
//! against what is known already, it is not evaluated. The result is the same.

use super::super::shape::Node;
use super::{Writer, number, push, vector};

/// How the values of sub-trees combine: their minimum or maximum, blended over the width k.
#[derive(Clone, Copy)]
pub(super) struct Combine {
    pub largest: bool,
    pub k: f64,
}

impl Combine {
    fn of(self, a: &str, b: &str) -> String {
        let k = number(self.k);
        match (self.largest, self.k > 0.0) {
            (false, false) => format!("min({a}, {b})"),
            (true, false) => format!("max({a}, {b})"),
            (false, true) => format!("smooth_min({a}, {b}, {k})"),
            (true, true) => format!("-smooth_min(-{a}, -{b}, {k})"),
        }
    }
}

impl Writer<'_> {
    /// Appends the statements of a fold over sub-trees at point `p`; returns the name of its value.
    pub(super) fn fold(
        &mut self,
        body: &mut String,
        of: &[Node],
        p: &str,
        combine: Combine,
    ) -> String {
        let mut order: Vec<&Node> = of.iter().collect();
        if combine.k == 0.0 {
            // Sharp ones do not depend on the order: what is cheap decides first.
            order.sort_by_key(|node| is_costly(node));
        }
        let mut known: Option<String> = None;
        for node in order {
            known = Some(match known {
                None => self.node(body, node, p),
                Some(known) => self.fold_one(body, &known, node, p, combine),
            });
        }
        known.unwrap_or_else(|| "FAR".to_owned())
    }

    fn fold_one(
        &mut self,
        body: &mut String,
        known: &str,
        node: &Node,
        p: &str,
        combine: Combine,
    ) -> String {
        let bound = match is_costly(node) {
            true => self.bound(body, node, p, !combine.largest),
            false => None,
        };
        let Some(bound) = bound else {
            let value = self.node(body, node, p);
            return self.variable(body, "d", format_args!("{}", combine.of(known, &value)));
        };
        let name = self.name("d");
        let k = number(combine.k);
        let counts = match combine.largest {
            false => format!("{bound} < {known} + {k}"),
            true => format!("{bound} > {known} - {k}"),
        };
        push(
            body,
            format_args!("    var {name} = {known};\n    if {counts} {{\n"),
        );
        let value = self.node(body, node, p);
        push(
            body,
            format_args!("    {name} = {};\n    }}\n", combine.of(known, &value)),
        );
        name
    }

    /// Appends the statements of a bound (lower or upper) on the node's value at point `p`, without
    /// noise or copies; returns its name, or nothing where none is known.
    fn bound(&mut self, body: &mut String, node: &Node, p: &str, lower: bool) -> Option<String> {
        // What moves a value by up to this much moves a bound by it.
        let spread = |amount: f64| number(if lower { -amount } else { amount });
        if !is_costly(node) {
            return Some(self.node(body, node, p));
        }
        match node {
            Node::HeightField {
                noise,
                base,
                amplitude,
                step,
                slope,
            } => {
                let rise = amplitude.abs() * self.bank.field(*noise).amplitude();
                // Steps round down.
                let height = if lower {
                    base + rise
                } else {
                    base - rise - step
                };
                let (height, slope) = (number(height), number(*slope));
                Some(self.variable(body, "b", format_args!("({p}.y - {height}) / {slope}")))
            }
            Node::Complement(of) => {
                let of = self.bound(body, of, p, !lower)?;
                Some(self.variable(body, "b", format_args!("-{of}")))
            }
            Node::Union(of) => self.bound_of_fold(body, of, p, lower, false, 0.0),
            Node::Intersection(of) => self.bound_of_fold(body, of, p, lower, true, 0.0),
            Node::SmoothUnion { k, of } => self.bound_of_fold(body, of, p, lower, false, *k),
            Node::SmoothIntersection { k, of } => self.bound_of_fold(body, of, p, lower, true, *k),
            Node::Translate { by, of } => {
                let q = self.variable(body, "p", format_args!("{p} - {}", vector(*by)));
                self.bound(body, of, &q, lower)
            }
            Node::Rotate { inverse, of } => {
                let q = self.rotated(body, *inverse, p);
                self.bound(body, of, &q, lower)
            }
            Node::Scale { by, of } => {
                let by = number(*by);
                let q = self.variable(body, "p", format_args!("{p} / {by}"));
                let of = self.bound(body, of, &q, lower)?;
                Some(self.variable(body, "b", format_args!("{of} * {by}")))
            }
            Node::Displace {
                noise,
                amplitude,
                of,
            } => {
                let most = amplitude.abs() * self.bank.field(*noise).amplitude();
                let of = self.bound(body, of, p, lower)?;
                Some(self.variable(body, "b", format_args!("{of} + {}", spread(most))))
            }
            Node::Warp {
                noise,
                amplitude,
                of,
            } => {
                let moved = 3.0_f64.sqrt() * amplitude.abs() * self.bank.field(*noise).amplitude();
                let most = of.variation(moved, self.bank);
                let of = self.bound(body, of, p, lower)?;
                Some(self.variable(body, "b", format_args!("{of} + {}", spread(most))))
            }
            Node::Scatter(scatter) if lower => {
                let (centre, half) = scatter.content();
                let (centre, half) = (vector(centre), vector(half));
                let outside = self.variable(
                    body,
                    "b",
                    format_args!("box_distance({p} - {centre}, {half})"),
                );
                // Among the copies nothing is known.
                Some(self.variable(
                    body,
                    "b",
                    format_args!("select(-FAR, {outside}, {outside} > 0.0)"),
                ))
            }
            _ => None,
        }
    }

    fn bound_of_fold(
        &mut self,
        body: &mut String,
        of: &[Node],
        p: &str,
        lower: bool,
        largest: bool,
        k: f64,
    ) -> Option<String> {
        let bounds: Vec<Option<String>> = of
            .iter()
            .map(|node| self.bound(body, node, p, lower))
            .collect();
        // One sub-tree alone bounds a minimum from above and a maximum from below.
        let one_is_enough = lower == largest;
        if !one_is_enough && bounds.iter().any(Option::is_none) {
            return None;
        }
        let sharp = Combine { largest, k: 0.0 };
        let combined = bounds
            .into_iter()
            .flatten()
            .reduce(|a, b| sharp.of(&a, &b))?;
        // Each blend moves the value by up to k/4, away from the sub-trees'.
        let blends = k / 4.0 * of.len().saturating_sub(1) as f64;
        let margin = number(match (one_is_enough, lower) {
            (true, _) => 0.0,
            (false, true) => -blends,
            (false, false) => blends,
        });
        Some(self.variable(body, "b", format_args!("{combined} + {margin}")))
    }
}

/// Whether a node's value takes noise or a search for copies.
fn is_costly(node: &Node) -> bool {
    match node {
        Node::HeightField { .. }
        | Node::Displace { .. }
        | Node::Warp { .. }
        | Node::Repeat(_)
        | Node::Scatter(_) => true,
        Node::Complement(of)
        | Node::Translate { of, .. }
        | Node::Rotate { of, .. }
        | Node::Scale { of, .. } => is_costly(of),
        Node::Union(of)
        | Node::Intersection(of)
        | Node::SmoothUnion { of, .. }
        | Node::SmoothIntersection { of, .. } => of.iter().any(is_costly),
        _ => false,
    }
}
