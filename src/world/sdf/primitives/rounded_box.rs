//! A box with round edges.

use std::sync::Arc;

use super::cuboid::Grown;
use crate::world::noise::NoiseBank;
use crate::world::sdf::keys::{NotNegative, Three, keys};
use crate::world::sdf::{Form, Tree};

keys! {
    /// A box along the axes, around the origin, grown by a radius: the volume that a ball sweeps when
    /// its centre moves through the box.
    pub struct RoundedBox {
        /// Half of the box's extent before it is grown, voxels.
        pub half: Three<NotNegative>,
        /// Voxels.
        pub radius: NotNegative,
    }
}

impl Form for RoundedBox {
    fn prepare(&self, _bank: &Arc<NoiseBank>) -> Tree {
        Arc::new(Grown {
            half: self.half,
            radius: self.radius,
        })
    }
}
