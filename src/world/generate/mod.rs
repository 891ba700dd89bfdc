//! Voxels from a world, on the CPU: the reference for the pass `scene/voxelise`.
//!
//! - A voxel is solid if the shape is negative at its centre; the first rule that holds names its
//!   material.
//! - Features fill air: later parts override earlier ones, solid voxels of the shape override all.
//! - A buried cell, which is solid and has only solid neighbours (the six cells around it; outside the world
//!   counts as solid), takes the material of its voxel (4, 4, 4) throughout: it is invisible before digging,
//!   and needs no brick.

mod bins;
mod compare;

use glam::{DVec3, UVec3};
use rayon::prelude::*;

pub use bins::FeatureBins;
pub use compare::differing;

use super::World;
use super::rules::RuleSet;
use super::sdf::Shape;
use super::voxels::{BRICK_VOXELS, CELL, NewCell, Voxels, brick_index};

/// Edge in voxels of the blocks that are tested before single voxels.
pub const BLOCK: u32 = 2;

/// Distance from the centre of a block of `edge`³ voxels to its farthest voxel centre.
pub fn block_radius(edge: u32) -> f64 {
    f64::from(edge - 1) / 2.0 * 3.0_f64.sqrt()
}

/// Generates the whole world, in parallel, with what a save changed about it.
pub fn generate(world: &World) -> Voxels {
    let mut voxels = Generator::new(world).voxels();
    voxels.apply(&world.restored.overlay);
    voxels
}

/// Which voxels of one cell the shape makes solid. Voxels outside the world do not count.
#[derive(Clone, Debug, PartialEq)]
enum Solid {
    None,
    All,
    /// Bit x | y << 3 of word z.
    Some(Box<[u64; 8]>),
}

struct Generator<'a> {
    world: &'a World,
    shape: Shape,
    rules: RuleSet,
    features: FeatureBins,
    /// Extent in cells that the world touches.
    cells: UVec3,
    cell_variation: f64,
    block_variation: f64,
}

impl<'a> Generator<'a> {
    fn new(world: &'a World) -> Self {
        let shape = Shape::new(&world.shape, &world.noises);
        Self {
            rules: RuleSet::new(&world.rules, &shape),
            features: FeatureBins::new(&world.features, world.origin, world.size),
            cells: world.size.map(|n| n.div_ceil(CELL)),
            cell_variation: shape.variation(block_radius(CELL)),
            block_variation: shape.variation(block_radius(BLOCK)),
            shape,
            world,
        }
    }

    fn voxels(&self) -> Voxels {
        let solidities: Vec<Solid> = (0..self.cells.element_product())
            .into_par_iter()
            .map(|index| self.solidity(self.cell_at(index)))
            .collect();
        Voxels::from_cells(self.world.size, |cell| self.fill(cell, &solidities))
    }

    fn cell_at(&self, index: u32) -> UVec3 {
        let rest = index / self.cells.x;
        UVec3::new(
            index % self.cells.x,
            rest % self.cells.y,
            rest / self.cells.y,
        )
    }

    fn index_of(&self, cell: UVec3) -> usize {
        (cell.x + self.cells.x * (cell.y + self.cells.y * cell.z)) as usize
    }

    /// World-space centre of a voxel of grid space, offset by (edge − 1)/2 to the centre of a block.
    fn centre_ws(&self, voxel: UVec3, edge: u32) -> DVec3 {
        (self.world.origin.as_dvec3() + voxel.as_dvec3()) + f64::from(edge) / 2.0
    }

    fn solidity(&self, cell: UVec3) -> Solid {
        let corner = cell * CELL;
        let value = self.shape.eval(self.centre_ws(corner, CELL));
        if value.abs() > self.cell_variation {
            return if value < 0.0 { Solid::All } else { Solid::None };
        }
        let mut bits = Box::new([0; 8]);
        let (mut inside, mut solid) = (0, 0);
        for block in 0..(CELL / BLOCK).pow(3) {
            let block = UVec3::new(block & 3, block >> 2 & 3, block >> 4) * BLOCK;
            let value = self.shape.eval(self.centre_ws(corner + block, BLOCK));
            let decided = (value.abs() > self.block_variation).then_some(value < 0.0);
            for z in block.z..block.z + BLOCK {
                for y in block.y..block.y + BLOCK {
                    for x in block.x..block.x + BLOCK {
                        let voxel = corner + UVec3::new(x, y, z);
                        if voxel.cmpge(self.world.size).any() {
                            continue;
                        }
                        inside += 1;
                        let is_solid = decided
                            .unwrap_or_else(|| self.shape.eval(self.centre_ws(voxel, 1)) < 0.0);
                        if is_solid {
                            bits[z as usize] |= 1 << (x | y << 3);
                            solid += 1;
                        }
                    }
                }
            }
        }
        match solid {
            0 => Solid::None,
            _ if solid == inside => Solid::All,
            _ => Solid::Some(bits),
        }
    }

    fn fill(&self, cell: UVec3, solidities: &[Solid]) -> NewCell {
        let corner = cell * CELL;
        let solidity = &solidities[self.index_of(cell)];
        let parts = self.features.of(cell);
        if *solidity == Solid::None && parts.is_empty() {
            return NewCell::Empty;
        }
        let whole = (corner + CELL).cmple(self.world.size).all();
        if *solidity == Solid::All && whole && self.surrounded(cell, solidities) {
            return NewCell::Uniform(self.material(corner + CELL / 2));
        }
        let mut brick = Box::new([0; BRICK_VOXELS]);
        for z in 0..CELL {
            for y in 0..CELL {
                for x in 0..CELL {
                    let local = UVec3::new(x, y, z);
                    let voxel = corner + local;
                    if voxel.cmpge(self.world.size).any() {
                        continue;
                    }
                    let solid = match solidity {
                        Solid::None => false,
                        Solid::All => true,
                        Solid::Some(bits) => bits[z as usize] >> (x | y << 3) & 1 == 1,
                    };
                    brick[brick_index(local)] = if solid {
                        self.material(voxel)
                    } else {
                        let voxel_ws = self.world.origin + voxel.as_ivec3();
                        let parts = parts
                            .iter()
                            .rev()
                            .map(|part| self.world.features[*part as usize]);
                        let found = { parts }.find(|part| part.contains(voxel_ws));
                        found.map_or(0, |part| part.material)
                    };
                }
            }
        }
        NewCell::Voxels(brick)
    }

    fn surrounded(&self, cell: UVec3, solidities: &[Solid]) -> bool {
        [UVec3::X, UVec3::Y, UVec3::Z].into_iter().all(|axis| {
            // Below 0 the subtraction wraps to outside the world.
            let [before, after] = [cell.wrapping_sub(axis), cell + axis];
            [before, after].into_iter().all(|neighbour| {
                neighbour.cmpge(self.cells).any()
                    || solidities[self.index_of(neighbour)] == Solid::All
            })
        })
    }

    fn material(&self, voxel: UVec3) -> u8 {
        let centre_ws = self.centre_ws(voxel, 1);
        self.rules
            .material(centre_ws, self.shape.eval(centre_ws), &self.shape)
    }
}
