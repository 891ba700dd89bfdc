//! The first sub-tree minus all the others.

use std::sync::Arc;

use glam::DVec3;

use super::fold::{Combine, Fold};
use crate::world::noise::NoiseBank;
use crate::world::sdf::keys::{NotNegative, SubTrees, keys};
use crate::world::sdf::wgsl::Body;
use crate::world::sdf::{Bounds, Form, Node, Sdf, Side, Tree};

keys! {
    /// Solid where the first sub-tree is solid and none of the others is.
    pub struct Subtraction(pub SubTrees);
}

keys! {
    /// The same with rounded edges: shrunk where two surfaces come closer than `k`.
    pub struct SmoothSubtraction {
        /// Width of the blend, voxels.
        pub k: NotNegative,
        pub of: SubTrees,
    }
}

impl Form for Subtraction {
    fn prepare(&self, bank: &Arc<NoiseBank>) -> Tree {
        prepare(&self.0, 0.0, bank)
    }
}

impl Form for SmoothSubtraction {
    fn prepare(&self, bank: &Arc<NoiseBank>) -> Tree {
        prepare(&self.of, self.k, bank)
    }
}

fn prepare(of: &[Sdf], k: f64, bank: &Arc<NoiseBank>) -> Tree {
    Arc::new(Fold {
        combine: Combine { largest: true, k },
        of: first_without_rest(of, bank),
    })
}

/// The other sub-trees enter the maximum as their complements.
fn first_without_rest(of: &[Sdf], bank: &Arc<NoiseBank>) -> Vec<Tree> {
    let mut nodes: Vec<Tree> = of.iter().map(|of| of.prepare(bank)).collect();
    for node in nodes.iter_mut().skip(1) {
        *node = Arc::new(Complement { of: node.clone() });
    }
    nodes
}

/// Solid where the sub-tree is not solid.
#[derive(Debug)]
struct Complement {
    of: Tree,
}

impl Node for Complement {
    fn eval(&self, p: DVec3) -> f64 {
        -self.of.eval(p)
    }

    fn variation(&self, radius: f64) -> f64 {
        self.of.variation(radius)
    }

    fn bounds(&self, _level: f64) -> Bounds {
        Bounds::EVERYTHING
    }

    fn is_costly(&self) -> bool {
        self.of.is_costly()
    }

    fn emit(&self, body: &mut Body<'_>, p: &str) -> String {
        let of = self.of.emit(body, p);
        body.variable("d", format_args!("-{of}"))
    }

    fn emit_bound(&self, body: &mut Body<'_>, p: &str, side: Side) -> Option<String> {
        let of = body.bound(&self.of, p, side.opposite())?;
        Some(body.variable("b", format_args!("-{of}")))
    }
}
