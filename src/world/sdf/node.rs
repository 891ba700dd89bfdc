//! The traits of a shape: a description that can be checked, and a prepared node that can be evaluated.

use std::fmt;
use std::sync::Arc;

use glam::DVec3;

use super::Bounds;
use super::wgsl::Body;
use crate::world::noise::{NoiseBank, NoiseField};

/// A prepared tree, shared by all its users.
pub type Tree = Arc<dyn Node>;

/// A shape as a world file describes it. [`keys!`](super::keys::keys) declares its keys; one file in
/// `primitives/` or `operators/` contains the rest of the shape.
pub trait Form {
    /// Checks rules that concern several keys or the sub-trees, which have already been checked. The
    /// rules of each single key follow from its type.
    fn check(&self, _noises: &[NoiseField]) -> Result<(), Fault> {
        Ok(())
    }

    /// The node of a checked description. Everything that does not depend on the point is computed
    /// here.
    fn prepare(&self, bank: &Arc<NoiseBank>) -> Tree;
}

/// A node that is ready for evaluation on any thread. Points and lengths are in voxels, in the node's
/// own space; values are negative inside the solid.
pub trait Node: fmt::Debug + Send + Sync {
    /// Value at a point: at most the distance to the surface times the Lipschitz constant (jumps
    /// aside), and +∞ where there is no solid at all.
    fn eval(&self, p: DVec3) -> f64;

    /// Upper bound of |eval(p) − eval(q)| over all p, q at most `radius` apart; the slope at 0 is the
    /// Lipschitz constant. By default that of a distance, whose constant is 1.
    fn variation(&self, radius: f64) -> f64 {
        radius
    }

    /// A box that contains every point with a value below `level` (≥ 0).
    fn bounds(&self, level: f64) -> Bounds;

    /// Whether the value needs noise or a search for copies. Such a node should provide a bound in
    /// [`Self::emit_bound`].
    fn is_costly(&self) -> bool {
        false
    }

    /// Appends the WGSL statements that evaluate the node at the point named `p`; returns an expression
    /// for the value (f32).
    fn emit(&self, body: &mut Body<'_>, p: &str) -> String;

    /// Appends the WGSL statements of a bound on the value of a costly node at the point named `p`,
    /// without noise or copies; returns an expression, or `None` if no bound is known.
    fn emit_bound(&self, _body: &mut Body<'_>, _p: &str, _side: Side) -> Option<String> {
        None
    }
}

/// The side on which a bound limits a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The value is at least the bound.
    Lower,
    /// The value is at most the bound.
    Upper,
}

impl Side {
    /// The side of the bound after the value's sign is changed.
    pub fn opposite(self) -> Self {
        match self {
            Self::Lower => Self::Upper,
            Self::Upper => Self::Lower,
        }
    }

    /// The amount to add to the bound of a value that may move by up to `amount`.
    pub fn margin(self, amount: f64) -> f64 {
        match self {
            Self::Lower => -amount,
            Self::Upper => amount,
        }
    }
}

/// A rule that a description breaks.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// The keys concerned; a message points at the first one that the file has.
    pub keys: &'static [&'static str],
    /// What is wrong.
    pub message: String,
    /// What to do about it; empty if the message already says it.
    pub remedy: String,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)?;
        if self.remedy.is_empty() {
            return Ok(());
        }
        write!(f, "; {}", self.remedy)
    }
}
