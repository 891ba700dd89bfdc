//! A noise field within a tree.

use std::sync::Arc;

use glam::DVec3;

use super::NoiseId;
use super::wgsl::Body;
use crate::world::noise::{NoiseBank, NoiseField};

/// A noise field of the world with its tables.
#[derive(Clone, Debug)]
pub struct Noise {
    id: NoiseId,
    bank: Arc<NoiseBank>,
}

impl Noise {
    pub fn new(id: NoiseId, bank: &Arc<NoiseBank>) -> Self {
        Self {
            id,
            bank: bank.clone(),
        }
    }

    /// Value at a point, in ±[`NoiseField::amplitude`].
    pub fn value(&self, p: DVec3) -> f64 {
        self.bank.value(self.id, p)
    }

    /// The field's definition, with its range and variation.
    pub fn field(&self) -> &NoiseField {
        self.bank.field(self.id)
    }

    /// A WGSL expression of the value at the point given by the expression `p`.
    pub fn emit(&self, body: &mut Body<'_>, p: &str) -> String {
        body.call_noise(self.id, p)
    }
}
