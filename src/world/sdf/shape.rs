//! A tree that is ready for evaluation.

use std::sync::Arc;

use glam::DVec3;

use super::{Bounds, Sdf, Tree};
use crate::world::noise::{NoiseBank, NoiseField};

/// A tree ready for evaluation on any thread: constants in f64, noise tables built.
#[derive(Clone, Debug)]
pub struct Shape {
    pub(super) root: Tree,
    bank: Arc<NoiseBank>,
}

impl Shape {
    /// Prepares a checked tree ([`Sdf::check`]) over the world's noise fields.
    pub fn new(sdf: &Sdf, noises: &[NoiseField]) -> Self {
        Self::with_bank(sdf, Arc::new(NoiseBank::new(noises)))
    }

    /// The same, with existing noise tables.
    pub fn with_bank(sdf: &Sdf, bank: Arc<NoiseBank>) -> Self {
        Self {
            root: sdf.prepare(&bank),
            bank,
        }
    }

    /// Value at a point of world space: negative inside the solid. At most the distance to the surface
    /// times [`Self::lipschitz`] (jumps aside), and +∞ where there is no solid at all.
    pub fn eval(&self, p_ws: DVec3) -> f64 {
        self.root.eval(p_ws)
    }

    /// Upper bound of |eval(p) − eval(q)| over all p, q at most `radius` apart. Where
    /// eval(centre)| exceeds it, a block with this half diagonal is entirely solid or entirely air.
    ///
    /// Not proportional to the radius: noise cannot exceed its amplitude at any distance, and a stepped
    /// height field jumps even between very close points.
    pub fn variation(&self, radius: f64) -> f64 {
        self.root.variation(radius)
    }

    /// Lipschitz constant between jumps: the slope of [`Self::variation`] at 0.
    pub fn lipschitz(&self) -> f64 {
        let radius = 1e-9;
        (self.variation(2.0 * radius) - self.variation(radius)) / radius
    }

    /// A box that contains all solid voxels; infinite if none is known.
    pub fn bounds(&self) -> Bounds {
        self.root.bounds(0.0)
    }

    /// The noise fields that the tree uses.
    pub fn bank(&self) -> &Arc<NoiseBank> {
        &self.bank
    }
}

impl Sdf {
    pub(super) fn prepare(&self, bank: &Arc<NoiseBank>) -> Tree {
        self.form().prepare(bank)
    }
}
