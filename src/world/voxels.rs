//! The brick map: a coarse grid of 8³ cells, each empty, uniform, or an index to a brick.
//!
//! Layout, shared with `shaders/march/` (see ARCHITECTURE.md):
//! - `grid`: one u32 a cell, index x | y << log2(cells.x) | z << log2(cells.x·cells.y). Bit 31 clear: empty, and bits
//!   3·o … 3·o+2 hold (whole cells that a ray of octant o may cross) − 1, where octant
//!   o = (dir.x < 0) | (dir.y < 0) << 1 | (dir.z < 0) << 2. Bits 31 and 30 set: uniform solid, material in bits 0–7. Bit 31 alone: brick index in
//!   bits 0–29.
//! - `masks`: sixteen u32 a brick: eight 4³ masks (index (x≥4) | (y≥4) << 1 | (z≥4) << 2), two words each,
//!   bit (x&3) | (y&3) << 2 | (z&3) << 4 of the 64.
//! - `materials`: 512 bytes a brick, index x | y << 3 | z << 6; 0 is air. Read only at a hit.

use glam::{IVec3, UVec3};

/// Edge of a grid cell in voxels.
pub const CELL: u32 = 8;
/// Voxels in a brick.
pub const BRICK_VOXELS: usize = 512;

const SOLID: u32 = 1 << 31;
const UNIFORM: u32 = 1 << 30;

/// A sparse array of materials with the structure that the marcher needs.
#[derive(Clone, Debug)]
pub struct Voxels {
    /// Extent of the world in voxels.
    size: UVec3,
    /// Extent of the grid in cells, each a power of two; what lies beyond `size` is air.
    cells: UVec3,
    grid: Vec<u32>,
    masks: Vec<[u32; 16]>,
    materials: Vec<[u8; BRICK_VOXELS]>,
    free_bricks: Vec<u32>,
}

impl Voxels {
    /// Material of a voxel in grid space; 0 (air) outside the grid.
    pub fn material(&self, voxel: IVec3) -> u8 {
        if voxel.cmplt(IVec3::ZERO).any() || voxel.cmpge(self.size.as_ivec3()).any() {
            return 0;
        }
        let voxel = voxel.as_uvec3();
        let word = self.grid[self.cell_index(voxel / CELL)];
        if word & SOLID == 0 {
            0
        } else if word & UNIFORM != 0 {
            word as u8
        } else {
            let local = voxel % CELL;
            self.materials[(word & !SOLID) as usize]
                [(local.x | local.y << 3 | local.z << 6) as usize]
        }
    }

    fn cell_index(&self, cell: UVec3) -> usize {
        let bits = self.cells.map(|n| n.trailing_zeros());
        (cell.x | cell.y << bits.x | cell.z << (bits.x + bits.y)) as usize
    }
}
