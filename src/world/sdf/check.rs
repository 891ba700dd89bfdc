//! Checks of a tree before its evaluation.

use thiserror::Error;

use super::{Fault, Sdf};
use crate::world::noise::NoiseField;

/// Why a tree cannot be evaluated. The message names the node and what it must be.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SdfError {
    #[error("{node}: {fault}")]
    Rule { node: &'static str, fault: Fault },
    #[error("the tree is nested deeper than {0} levels")]
    TooDeep(usize),
}

/// Deeper trees are refused: evaluation recurses.
const MAX_DEPTH: usize = 128;

impl Sdf {
    /// Checks every number and every reference of the tree, so that [`Shape::new`](super::Shape::new)
    /// and evaluation cannot fail and the bounds of [`Shape::variation`](super::Shape::variation) hold.
    ///
    /// # Errors
    /// A node that breaks a rule: values are checked from the root down, rules that depend on sub-trees
    /// after the sub-trees.
    pub fn check(&self, noises: &[NoiseField]) -> Result<(), SdfError> {
        self.check_at(noises, 0)
    }

    fn check_at(&self, noises: &[NoiseField], depth: usize) -> Result<(), SdfError> {
        if depth > MAX_DEPTH {
            return Err(SdfError::TooDeep(MAX_DEPTH));
        }
        let node = self.name();
        let of_node = |fault| SdfError::Rule { node, fault };
        self.check_keys(noises).map_err(of_node)?;
        for child in self.children() {
            child.check_at(noises, depth + 1)?;
        }
        self.form().check(noises).map_err(of_node)
    }
}
