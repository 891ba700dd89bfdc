//! The solid common to all sub-trees.

use std::sync::Arc;

use super::fold::{Combine, Fold};
use crate::world::noise::NoiseBank;
use crate::world::sdf::keys::{NotNegative, SubTrees, keys};
use crate::world::sdf::{Form, Sdf, Tree};

keys! {
    /// Solid where all of the sub-trees are solid; nowhere without any.
    pub struct Intersection(pub SubTrees);
}

keys! {
    /// The same with rounded edges: shrunk where two surfaces come closer than `k`.
    pub struct SmoothIntersection {
        /// Width of the blend, voxels.
        pub k: NotNegative,
        pub of: SubTrees,
    }
}

impl Form for Intersection {
    fn prepare(&self, bank: &Arc<NoiseBank>) -> Tree {
        prepare(&self.0, 0.0, bank)
    }
}

impl Form for SmoothIntersection {
    fn prepare(&self, bank: &Arc<NoiseBank>) -> Tree {
        prepare(&self.of, self.k, bank)
    }
}

fn prepare(of: &[Sdf], k: f64, bank: &Arc<NoiseBank>) -> Tree {
    Arc::new(Fold {
        combine: Combine { largest: true, k },
        of: of.iter().map(|of| of.prepare(bank)).collect(),
    })
}
