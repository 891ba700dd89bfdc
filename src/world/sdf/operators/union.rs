//! The solid of any of the sub-trees.

use std::sync::Arc;

use super::fold::{Combine, Fold};
use crate::world::noise::NoiseBank;
use crate::world::sdf::keys::{NotNegative, SubTrees, keys};
use crate::world::sdf::{Form, Sdf, Tree};

keys! {
    /// Solid where any of the sub-trees is solid; nowhere without any.
    pub struct Union(pub SubTrees);
}

keys! {
    /// The same with fillets: grown where two surfaces come closer than `k`.
    pub struct SmoothUnion {
        /// Width of the blend, voxels.
        pub k: NotNegative,
        pub of: SubTrees,
    }
}

impl Form for Union {
    fn prepare(&self, bank: &Arc<NoiseBank>) -> Tree {
        prepare(&self.0, 0.0, bank)
    }
}

impl Form for SmoothUnion {
    fn prepare(&self, bank: &Arc<NoiseBank>) -> Tree {
        prepare(&self.of, self.k, bank)
    }
}

fn prepare(of: &[Sdf], k: f64, bank: &Arc<NoiseBank>) -> Tree {
    Arc::new(Fold {
        combine: Combine { largest: false, k },
        of: of.iter().map(|of| of.prepare(bank)).collect(),
    })
}
