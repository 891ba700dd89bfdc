//! How much the buffers of bodies hold, and where its parts lie.

use glam::UVec3;

use super::{
    body_models::{LIT_FACES, vectors_of},
    body_records::{GpuBody, GpuBodyNode},
};
use crate::{lights::lists, world::bodies::Bodies};

crate::shared! {
    in scene;

    /// Vectors of the head.
    pub const HEAD_VECTORS as HEAD_VECTORS: usize = 2;
}

/// What the buffers of bodies hold at most.
#[derive(Clone, Copy)]
pub struct Room {
    pub bodies: usize,
    /// Vectors of all models.
    pub models: usize,
}

impl Room {
    pub fn of(bodies: &Bodies) -> Self {
        Self {
            bodies: bodies.bodies.len(),
            models: bodies.models.iter().map(vectors_of).sum(),
        }
    }
}

/// The cells of the world that have facts about lamps: those that have lists of lamps.
#[derive(Clone, Copy)]
pub struct Cells {
    /// Along each axis.
    pub count: UVec3,
    /// log2 of the voxels along a cell.
    pub shift: u32,
}

impl Cells {
    /// Of a world of `size` voxels.
    pub fn of(size: UVec3) -> Self {
        Self {
            count: lists::cells(size),
            shift: lists::cell_shift(size),
        }
    }
}

/// The parts of the buffer, in vectors, in their order: head, nodes and bodies; facts; models.
impl Room {
    pub fn first_fact(&self) -> usize {
        let nodes = (2 * self.bodies).saturating_sub(1);
        let bytes = nodes * size_of::<GpuBodyNode>() + self.bodies * size_of::<GpuBody>();
        HEAD_VECTORS + bytes / size_of::<[u32; 4]>()
    }

    /// Eight bytes for each face and each cell; one vector where there are no bodies.
    pub fn facts(&self, cells: Cells) -> usize {
        let cells = cells.count.element_product() as usize * self.bodies.min(1);
        (self.bodies * LIT_FACES as usize + cells)
            .div_ceil(2)
            .max(1)
    }

    pub fn bytes(&self, cells: Cells) -> u64 {
        bytes(self.first_fact() + self.facts(cells) + self.models)
    }
}

/// Bytes of this many vectors.
pub fn bytes(vectors: usize) -> u64 {
    (vectors * size_of::<[u32; 4]>()) as u64
}
