//! How much the buffers of bodies hold, and where its parts lie.

use super::{
    body_emitters::GpuGlowingBody,
    body_models::GpuModel,
    body_records::{GpuBody, GpuBodyNode},
    hierarchy::{Bounds, OCTANTS},
};
use crate::{lights::Cells, world::bodies::Bodies};

crate::shared! {
    in scene;

    /// Vectors of the head.
    pub const HEAD_VECTORS as HEAD_VECTORS: usize = 3;
    /// A face with stored light has light for each of its columns of voxels, and its columns belong to quadrants.
    pub const LIT_COLUMNS as LIT_COLUMNS: usize = 16;
    pub const LIT_QUADRANTS as LIT_QUADRANTS: usize = 4;
    /// Facts about such a face: half a one for each quadrant, one for each column.
    pub const LIT_FACTS as LIT_FACTS: usize = LIT_QUADRANTS / 2 + LIT_COLUMNS;
    /// Facts about one of the cells around a body.
    pub const NEAR_FACTS as NEAR_FACTS: usize = 4;
    /// log2 of the most cells along an axis around a body.
    pub const MOST_NEAR_BITS as MOST_NEAR_BITS: u32 = 4;
}

/// log2 of the voxels along the smallest and the largest cells around bodies. A cell of the world that has a list of lamps
/// is never smaller than these, so all of a cell has one list.
const LEAST_NEAR_SHIFT: u32 = 2;
const MOST_NEAR_SHIFT: u32 = 4;
/// Most cells around all bodies: 16 MiB of facts.
const MOST_NEAR_CELLS: usize = 1 << 19;

/// The cells around a body, in which the world's cells take turns as the body moves: the cell at a place has the number
/// of its coordinates modulo the number of cells along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NearCells {
    /// log2 of the voxels along a cell.
    pub shift: u32,
    /// log2 of the cells along each axis.
    pub bits: u32,
}

impl NearCells {
    /// As many as a body with these solid voxels may touch, however it is turned, if there is room for as many around each
    /// of `bodies` bodies. Otherwise it has fewer, and nothing is known of its farther parts.
    pub fn of(solid: &Bounds, bodies: usize) -> Self {
        let reach = (solid.high - solid.low).length();
        let bits = |shift: u32| {
            let touched = (reach / (1 << shift) as f32) as u32 + 2;
            touched.next_power_of_two().ilog2()
        };
        let has_room = |bits: &u32| bodies << (3 * bits) <= MOST_NEAR_CELLS;
        let most_bits = (0..=MOST_NEAR_BITS).rev().find(has_room).unwrap_or(0);
        let fits = |shift: &u32| bits(*shift) <= most_bits;
        let shift = (LEAST_NEAR_SHIFT..MOST_NEAR_SHIFT).find(fits);
        let shift = shift.unwrap_or(MOST_NEAR_SHIFT);
        Self {
            shift,
            bits: bits(shift).min(most_bits),
        }
    }

    pub fn count(self) -> usize {
        1 << (3 * self.bits)
    }
}

/// What the buffers of bodies hold at most.
#[derive(Clone, Copy)]
pub struct Room {
    pub bodies: usize,
    /// Vectors of all models.
    pub models: usize,
    /// Faces with stored light of all bodies.
    pub lit_faces: usize,
    /// Cells around all bodies.
    pub near_cells: usize,
}

impl Room {
    /// `models` are those of the bodies.
    pub fn of(bodies: &Bodies, models: &[GpuModel]) -> Self {
        let of_bodies = || bodies.bodies.iter().map(|body| &models[body.model]);
        let count = bodies.bodies.len();
        Self {
            bodies: count,
            models: models.iter().map(|model| model.vectors.len()).sum(),
            lit_faces: of_bodies().map(|model| model.lit_faces).sum(),
            near_cells: of_bodies()
                .map(|model| NearCells::of(&model.solid, count).count())
                .sum(),
        }
    }

    /// Half as much again, and some more.
    pub fn ample(self) -> Self {
        Self {
            bodies: self.bodies * 3 / 2 + 16,
            models: self.models * 3 / 2 + (1 << 14),
            lit_faces: self.lit_faces * 3 / 2 + (1 << 12),
            near_cells: self.near_cells * 3 / 2 + (1 << 13),
        }
    }

    /// Whether nothing needs more.
    pub fn holds(self, needed: Self) -> bool {
        needed.bodies <= self.bodies
            && needed.models <= self.models
            && needed.lit_faces <= self.lit_faces
            && needed.near_cells <= self.near_cells
    }
}

/// The parts of the buffer, in vectors, in their order: head, nodes, bodies and those that glow; facts; models.
impl Room {
    pub fn first_fact(&self) -> usize {
        let nodes = OCTANTS * (2 * self.bodies).saturating_sub(1);
        let of_body = size_of::<GpuBody>() + size_of::<GpuGlowingBody>();
        let bytes = nodes * size_of::<GpuBodyNode>() + self.bodies * of_body;
        HEAD_VECTORS + bytes / size_of::<[u32; 4]>()
    }

    /// Number of the first fact about the cells around bodies; those about stored light come before.
    pub fn first_near_fact(&self) -> usize {
        LIT_FACTS * self.lit_faces.max(1)
    }

    /// Number of the first fact about the cells of the world; those about bodies follow.
    pub fn first_cell_fact(&self) -> usize {
        self.first_near_fact() + (self.near_cells * NEAR_FACTS).max(2)
    }

    /// Vectors of the facts of each kind, of eight bytes each; one where there are none.
    pub fn facts(&self, cells: Cells) -> [usize; 3] {
        let cells = cells.count.element_product() as usize * self.bodies.min(1);
        let near = self.near_cells * NEAR_FACTS;
        let lit = LIT_FACTS * self.lit_faces;
        [lit, near, cells + self.bodies].map(|facts| facts.div_ceil(2).max(1))
    }

    pub fn first_model(&self, cells: Cells) -> usize {
        self.first_fact() + self.facts(cells).iter().sum::<usize>()
    }

    pub fn bytes(&self, cells: Cells) -> u64 {
        bytes(self.first_model(cells) + self.models)
    }
}

/// Bytes of this many vectors.
pub fn bytes(vectors: usize) -> u64 {
    (vectors * size_of::<[u32; 4]>()) as u64
}

#[cfg(test)]
mod tests {
    use glam::{UVec3, Vec3};

    use super::*;
    use crate::lights::lists;

    fn of(edge: u32, bodies: usize) -> NearCells {
        let solid = Bounds {
            low: Vec3::ZERO,
            high: Vec3::splat(edge as f32),
        };
        NearCells::of(&solid, bodies)
    }

    #[test]
    fn cells_hold_a_body_however_it_is_turned() {
        assert_eq!(of(16, 100), NearCells { shift: 2, bits: 3 });
        for edge in 1..=64 {
            let cells = of(edge, 100);
            let longest = ((edge * edge * 3) as f32).sqrt();
            // However a line of that length lies, it touches one cell more than its own length has, rounded up.
            let touched = (longest / (1 << cells.shift) as f32).ceil() as u32 + 1;
            assert!(touched <= 1 << cells.bits, "{edge}");
            assert!(cells.bits <= MOST_NEAR_BITS, "{edge}");
        }
    }

    #[test]
    fn facts_about_cells_stay_few_whatever_there_is() {
        for bodies in [1, 50, 1000, 16_384, 1_000_000] {
            for edge in [1, 16, 64] {
                let cells = of(edge, bodies);
                let all = bodies * cells.count();
                assert!(
                    all <= MOST_NEAR_CELLS.max(bodies),
                    "{bodies} of {edge}: {all}"
                );
                assert!((LEAST_NEAR_SHIFT..=MOST_NEAR_SHIFT).contains(&cells.shift));
            }
        }
        let smallest_list = lists::cells(UVec3::ONE).shift;
        assert!(
            MOST_NEAR_SHIFT <= smallest_list,
            "all of a cell has one list"
        );
    }
}
