//! The brick map: a coarse grid of 8³ cells, each empty, uniform, or an index to a brick.
//!
//! Layout, shared with `shaders/scene/voxels.wesl`:
//! - `grid`: one u32 per cell, index x | y << log2(cells.x) | z << log2(cells.x·cells.y). Bit 31
//!   clear: empty, and bits 3·o … 3·o+2 hold (whole cells that a ray of octant o may cross) − 1,
//!   where octant o = (dir.x < 0) | (dir.y < 0) << 1 | (dir.z < 0) << 2. Bits 31 and 30 set:
//!   uniform solid, material in bits 0–7. Bit 31 alone: brick index in bits 0–29.
//! - `masks`: sixteen u32 per brick: eight 4³ masks (index (x≥4) | (y≥4) << 1 | (z≥4) << 2), two
//!   words each, bit (x&3) | (y&3) << 2 | (z&3) << 4 of the 64.
//! - `materials`: 512 bytes per brick, index x | y << 3 | z << 6; 0 is air. Read only at a hit.
//!
//! Invariants: a brick is neither empty nor uniform; the distances of empty cells are exact; voxels
//! between `size` and the grid's end are air.

mod distances;
mod edit;
mod overlay;
mod solid;

use glam::{IVec3, UVec3};
use rayon::prelude::*;

pub use edit::Edit;
pub use overlay::{ChangedBrick, MASK_WORDS, Originals, Overlay};
pub use solid::SolidVoxels;

/// Edge of a grid cell in voxels.
pub const CELL: u32 = 8;
/// Voxels in a brick.
pub const BRICK_VOXELS: usize = 512;
/// Most cells that one step of a ray may cross.
pub const FARTHEST: u32 = 8;

crate::shared! {
    in world;

    /// Bit of a cell's word: the cell contains solid voxels.
    pub const SOLID as CELL_SOLID: u32 = 1 << 31;

    /// Bit of the word of a cell with solid voxels: it is full of the material in the word's lowest
    /// byte.
    pub const UNIFORM as CELL_UNIFORM: u32 = 1 << 30;

    /// Mask for the word of any other cell with solid voxels: the number of its brick.
    pub const BRICK as CELL_BRICK: u32 = UNIFORM - 1;

    /// The word of an empty cell surrounded by empty cells: three bits for each octant, its distance −
    /// 1.
    pub const ALL_FARTHEST: u32 = (1 << 24) - 1;
}

/// The materials of one cell, index x | y << 3 | z << 6; 0 is air.
pub type Brick = [u8; BRICK_VOXELS];

/// A sparse array of materials with the structure that the marcher needs.
#[derive(Clone, Debug)]
pub struct Voxels {
    size: UVec3,
    cells: UVec3,
    grid: Vec<u32>,
    masks: Vec<[u32; 16]>,
    materials: Vec<Brick>,
    free_bricks: Vec<u32>,
    /// What edited cells contained, if that is to be remembered.
    originals: Option<Originals>,
}

/// Content of one grid cell of 8³ voxels.
#[derive(Clone, Copy, Debug)]
pub enum Cell<'a> {
    /// Air throughout.
    Empty,
    /// Solid voxels of one material throughout.
    Uniform(u8),
    /// Materials, index x | y << 3 | z << 6 of the voxel within the cell; 0 is air.
    Brick(&'a Brick),
}

/// The contents of a cell that is being built.
#[derive(Clone, Debug)]
pub enum NewCell {
    Empty,
    /// Solid voxels of one material (not 0) throughout.
    Uniform(u8),
    /// Any materials; stored in the smallest form that holds them.
    Voxels(Box<Brick>),
}

impl Voxels {
    /// A world of air.
    pub fn empty(size: UVec3) -> Self {
        let cells = grid_cells(size);
        let mut voxels = Self {
            size,
            cells,
            grid: vec![0; cells.element_product() as usize],
            masks: Vec::new(),
            materials: Vec::new(),
            free_bricks: Vec::new(),
            originals: None,
        };
        voxels.rebuild_distances();
        voxels
    }

    /// Builds every cell that the world touches in parallel. Voxels beyond `size` must be air.
    pub fn from_cells(size: UVec3, content: impl Fn(UVec3) -> NewCell + Sync) -> Self {
        let mut voxels = Self::empty(size);
        let used = size.map(|n| n.div_ceil(CELL));
        let built: Vec<(UVec3, NewCell)> = (0..used.y * used.z)
            .into_par_iter()
            .flat_map_iter(|row| {
                let content = &content;
                (0..used.x).filter_map(move |x| {
                    let cell = UVec3::new(x, row % used.y, row / used.y);
                    match content(cell) {
                        NewCell::Empty => None,
                        found => Some((cell, found)),
                    }
                })
            })
            .collect();
        for (cell, found) in built {
            match found {
                NewCell::Empty => {}
                NewCell::Uniform(material) => {
                    let index = voxels.cell_index(cell);
                    voxels.grid[index] = SOLID | UNIFORM | u32::from(material);
                }
                NewCell::Voxels(brick) => {
                    voxels.store(cell, &brick);
                }
            }
        }
        voxels.rebuild_distances();
        voxels
    }

    /// The structure as the GPU built it. `masks` and `materials` may be longer than the grid needs:
    /// bricks that no cell names are free.
    ///
    /// # Panics
    /// If the grid's length does not fit `size`.
    pub fn from_raw(
        size: UVec3,
        grid: Vec<u32>,
        masks: Vec<[u32; 16]>,
        materials: Vec<Brick>,
    ) -> Self {
        let cells = grid_cells(size);
        assert_eq!(grid.len(), cells.element_product() as usize, "grid length");
        let mut used = vec![false; masks.len()];
        for word in grid.iter().filter(|word| **word >> 30 == 2) {
            used[(word & BRICK) as usize] = true;
        }
        let free = |brick: &u32| !used[*brick as usize];
        let free_bricks = (0..masks.len() as u32).rev().filter(free).collect();
        Self {
            size,
            cells,
            grid,
            masks,
            materials,
            free_bricks,
            originals: None,
        }
    }

    /// Extent in voxels.
    pub fn size(&self) -> UVec3 {
        self.size
    }

    /// Extent of the grid in cells, each a power of two.
    pub fn cells(&self) -> UVec3 {
        self.cells
    }

    /// The words of the grid, the masks and the materials, as the GPU reads them.
    pub fn raw(&self) -> (&[u32], &[[u32; 16]], &[Brick]) {
        (&self.grid, &self.masks, &self.materials)
    }

    /// Number of bricks in use.
    pub fn bricks(&self) -> usize {
        self.masks.len() - self.free_bricks.len()
    }

    /// Content of a grid cell. `cell` is the voxel / [`CELL`] of a voxel inside [`Self::size`].
    pub fn cell(&self, cell: UVec3) -> Cell<'_> {
        let word = self.grid[self.cell_index(cell)];
        if word & SOLID == 0 {
            Cell::Empty
        } else if word & UNIFORM != 0 {
            Cell::Uniform(word as u8)
        } else {
            Cell::Brick(&self.materials[(word & BRICK) as usize])
        }
    }

    /// Material of a voxel in grid space; 0 (air) outside the world.
    pub fn material(&self, voxel: IVec3) -> u8 {
        if voxel.cmplt(IVec3::ZERO).any() || voxel.cmpge(self.size.as_ivec3()).any() {
            return 0;
        }
        let voxel = voxel.as_uvec3();
        match self.cell(voxel / CELL) {
            Cell::Empty => 0,
            Cell::Uniform(material) => material,
            Cell::Brick(materials) => materials[brick_index(voxel % CELL)],
        }
    }

    /// CRC-32 of what the voxels are, whatever bricks hold them.
    pub fn crc32(&self) -> u32 {
        let mut hasher = crc32fast::Hasher::new();
        let used = self.size.map(|n| n.div_ceil(CELL));
        for index in 0..used.element_product() {
            let (x, rest) = (index % used.x, index / used.x);
            match self.cell(UVec3::new(x, rest % used.y, rest / used.y)) {
                Cell::Empty => hasher.update(&[0, 0]),
                Cell::Uniform(material) => hasher.update(&[0, material]),
                Cell::Brick(materials) => {
                    hasher.update(&[1]);
                    hasher.update(materials);
                }
            }
        }
        hasher.finalize()
    }

    fn cell_index(&self, cell: UVec3) -> usize {
        let bits = self.cells.map(|n| n.trailing_zeros());
        (cell.x | cell.y << bits.x | cell.z << (bits.x + bits.y)) as usize
    }

    /// Stores these materials in a cell, allocating or freeing its brick. Returns the brick that was
    /// written, if any. The caller must update the distances.
    fn store(&mut self, cell: UVec3, content: &Brick) -> Option<u32> {
        let index = self.cell_index(cell);
        let old = self.grid[index];
        let had_brick = old >> 30 == 2;
        let first = content[0];
        if *content == [first; BRICK_VOXELS] {
            if had_brick {
                self.free_bricks.push(old & BRICK);
            }
            let solid = SOLID | UNIFORM | u32::from(first);
            self.grid[index] = if first == 0 { 0 } else { solid };
            return None;
        }
        let brick = if had_brick {
            old & BRICK
        } else {
            self.free_bricks.pop().unwrap_or_else(|| {
                self.masks.push([0; 16]);
                self.materials.push([0; BRICK_VOXELS]);
                self.masks.len() as u32 - 1
            })
        };
        self.grid[index] = SOLID | brick;
        self.masks[brick as usize] = masks_of(content);
        self.materials[brick as usize] = *content;
        Some(brick)
    }
}

/// Extent in cells of the grid for a world of `size` voxels.
pub fn grid_cells(size: UVec3) -> UVec3 {
    size.map(|n| n.div_ceil(CELL).max(1).next_power_of_two())
}

/// Index of a voxel within its brick.
pub fn brick_index(local: UVec3) -> usize {
    (local.x | local.y << 3 | local.z << 6) as usize
}

/// The eight 4³ masks of a brick, two words each.
fn masks_of(content: &Brick) -> [u32; 16] {
    let mut masks = [0; 16];
    for (row, materials) in content.as_chunks().0.iter().enumerate() {
        let (y, z) = (row & 7, row >> 3);
        let mask = 2 * ((y >> 2) << 1 | (z >> 2) << 2);
        let bit = (y & 3) << 2 | (z & 3) << 4;
        let solid = solid_of(*materials);
        for (x, bits) in [(0, solid & 15), (2, solid >> 4)] {
            masks[mask + x + (bit >> 5)] |= bits << (bit & 31);
        }
    }
    masks
}

/// Bit i: material i is not air.
fn solid_of(materials: [u8; 8]) -> u32 {
    /// The lowest bit of each byte.
    const LOWEST: u64 = u64::MAX / 255;
    const ALL_BUT_HIGHEST: u64 = 127 * LOWEST;
    /// Shifts the lowest bit of byte i to bit 56 + i.
    const GATHER: u64 = 0x0102_0408_1020_4080;
    let bytes = u64::from_le_bytes(materials);
    // Adding carries into the highest bit of every byte that has another bit set.
    let carried = (bytes & ALL_BUT_HIGHEST) + ALL_BUT_HIGHEST;
    let solid = ((carried | bytes) >> 7) & LOWEST;
    (solid.wrapping_mul(GATHER) >> 56) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_of_one_material_needs_no_brick() {
        let voxels = Voxels::from_cells(UVec3::splat(16), |cell| {
            if cell.x == 0 {
                NewCell::Voxels(Box::new([3; BRICK_VOXELS]))
            } else {
                NewCell::Empty
            }
        });
        assert_eq!(voxels.bricks(), 0);
        assert_eq!(voxels.material(IVec3::new(7, 15, 15)), 3);
        assert_eq!(voxels.material(IVec3::new(8, 0, 0)), 0);
        assert_eq!(voxels.material(IVec3::new(-1, 0, 0)), 0);
    }

    #[test]
    fn the_checksum_is_that_of_the_voxels_however_they_came_about() {
        let mut once = Voxels::empty(UVec3::new(20, 8, 33));
        let empty = once.crc32();
        let mut twice = once.clone();
        let (a, b) = (IVec3::new(3, 4, 5), IVec3::new(19, 7, 32));
        once.set(a, 1);
        once.set(b, 2);
        twice.set(b, 2);
        twice.set(IVec3::ZERO, 3);
        twice.set(a, 1);
        assert_ne!(once.crc32(), twice.crc32());
        twice.set(IVec3::ZERO, 0);
        assert_eq!(once.crc32(), twice.crc32());
        once.set(a, 0);
        once.set(b, 0);
        assert_eq!(once.crc32(), empty);
    }

    #[test]
    fn the_grid_is_padded_to_powers_of_two() {
        assert_eq!(grid_cells(UVec3::new(1, 100, 512)), UVec3::new(1, 16, 64));
    }

    #[test]
    fn masks_mark_exactly_the_solid_voxels() {
        let mut content = [0; BRICK_VOXELS];
        content[brick_index(UVec3::new(5, 2, 3))] = 9;
        let mut expected = [0; 16];
        // Mask 1 (x ≥ 4), bit 1 | 2 << 2 | 3 << 4 = 57: bit 25 of its second word.
        expected[3] = 1 << 25;
        assert_eq!(masks_of(&content), expected);
    }

    #[test]
    fn masks_of_all_materials_follow_their_definition() {
        for seed in 0..64u32 {
            let content: Brick = std::array::from_fn(|voxel| {
                let hash = (voxel as u32 * 64 + seed).wrapping_mul(0x9e37_79b9);
                if hash >> 30 == 0 {
                    0
                } else {
                    (hash >> 8) as u8
                }
            });
            let mut expected = [0u32; 16];
            for (index, _) in content.iter().enumerate().filter(|(_, m)| **m != 0) {
                let (x, y, z) = (index & 7, index >> 3 & 7, index >> 6);
                let mask = x >> 2 | (y >> 2) << 1 | (z >> 2) << 2;
                let bit = x & 3 | (y & 3) << 2 | (z & 3) << 4;
                expected[mask * 2 + (bit >> 5)] |= 1 << (bit & 31);
            }
            assert_eq!(masks_of(&content), expected, "{seed}");
        }
    }
}
