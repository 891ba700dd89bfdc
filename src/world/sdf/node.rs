//! What a shape is: a description that can be checked, and a prepared node that can be evaluated.

use std::fmt;
use std::sync::Arc;

use glam::DVec3;

use super::Bounds;
use super::wgsl::Body;
use crate::world::noise::{NoiseBank, NoiseField};

/// A prepared tree, shared by everyone who evaluates it.
pub type Tree = Arc<dyn Node>;

/// A shape as a world file describes it. [`keys!`](super::keys::keys) declares its keys; one file in
/// `primitives/` or `operators/` holds everything else that there is to say about it.
pub trait Form {
    /// A rule that concerns several keys or the sub-trees, which are checked already. What each key
    /// alone may be follows from its type.
    fn check(&self, _noises: &[NoiseField]) -> Result<(), Fault> {
        Ok(())
    }

    /// The node of a checked description: everything that does not depend on the point is worked out.
    fn prepare(&self, bank: &Arc<NoiseBank>) -> Tree;
}

/// A node that is ready for evaluation on any thread. Points and lengths in voxels, in the node's own
/// space; values are negative inside stone.
pub trait Node: fmt::Debug + Send + Sync {
    /// Value at a point: at most the distance to the surface times the Lipschitz constant (jumps
    /// aside), and +∞ where there is nothing at all.
    fn eval(&self, p: DVec3) -> f64;

    /// Upper bound of |eval(p) − eval(q)| over all p, q at most `radius` apart; the slope at 0 is the
    /// Lipschitz constant. By default that of a distance, whose constant is 1.
    fn variation(&self, radius: f64) -> f64 {
        radius
    }

    /// A box that holds every point whose value lies below `level` (≥ 0).
    fn bounds(&self, level: f64) -> Bounds;

    /// Whether the value takes noise or a search for copies. Such a node should bound itself in
    /// [`Self::emit_bound`].
    fn is_costly(&self) -> bool {
        false
    }

    /// Appends the WGSL statements that evaluate the node at the point named `p`; returns an
    /// expression of the value (f32).
    fn emit(&self, body: &mut Body<'_>, p: &str) -> String;

    /// Appends the WGSL statements of a bound on the value of a costly node at the point named `p`,
    /// without noise or copies; returns an expression, or nothing where no bound is known.
    fn emit_bound(&self, _body: &mut Body<'_>, _p: &str, _side: Side) -> Option<String> {
        None
    }
}

/// From which side a bound holds a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The value is not less.
    Lower,
    /// The value is not more.
    Upper,
}

impl Side {
    /// The bound of a value whose sign is changed.
    pub fn opposite(self) -> Self {
        match self {
            Self::Lower => Self::Upper,
            Self::Upper => Self::Lower,
        }
    }

    /// What a value that moves by up to this much adds to its bound.
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
    /// The keys that it concerns; a message points at the first of them that the file has.
    pub keys: &'static [&'static str],
    /// What is wrong.
    pub message: String,
    /// What to do about it; empty where the message says it.
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
