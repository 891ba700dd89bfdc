//! Which cells contain solid voxels, one bit for each.

use glam::{IVec3, UVec3};

use super::SOLID;

/// The words of the grid say the same, but an edit looks at some 36 000 cells around it for distances, and as words
/// these fill more memory than a cache still holds from the last edit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct SolidCells {
    /// Extent in cells, each a power of two.
    cells: UVec3,
    /// Rows along x in whole words: y, then z.
    words: Vec<u64>,
}

impl SolidCells {
    /// Those of a grid of `cells` cells.
    pub(super) fn of(grid: &[u32], cells: UVec3) -> Self {
        let is_solid = |word: &u32| u64::from(word & SOLID != 0);
        let packed = |cells: &[u32]| {
            let bits = cells.iter().enumerate();
            bits.fold(0, |bits, (at, word)| bits | is_solid(word) << at)
        };
        let rows = grid.chunks(cells.x as usize);
        Self {
            cells,
            words: rows
                .flat_map(|row| row.chunks(u64::BITS as usize).map(packed))
                .collect(),
        }
    }

    pub(super) fn set(&mut self, cell: UVec3, is_solid: bool) {
        let word = self.first_word(cell.y, cell.z) + (cell.x / u64::BITS) as usize;
        let bit = 1 << (cell.x % u64::BITS);
        if is_solid {
            self.words[word] |= bit;
        } else {
            self.words[word] &= !bit;
        }
    }

    /// Bit i: the cell i places along x is solid. Cells beyond the grid are not.
    pub(super) fn along_x(&self, first: IVec3) -> u64 {
        let is_inside = |at: i32, end: u32| u32::try_from(at).is_ok_and(|at| at < end);
        if !is_inside(first.y, self.cells.y) || !is_inside(first.z, self.cells.z) {
            return 0;
        }
        let row = self.first_word(first.y as u32, first.z as u32);
        let row = &self.words[row..row + self.words_of_row()];
        let word = |at: i32| usize::try_from(at).ok().and_then(|at| row.get(at));
        let width = u64::BITS as i32;
        let (at, shift) = (first.x.div_euclid(width), first.x.rem_euclid(width));
        let low = word(at).map_or(0, |word| word >> shift);
        let high = word(at + 1).map_or(0, |word| word.unbounded_shl((width - shift) as u32));
        low | high
    }

    fn words_of_row(&self) -> usize {
        self.cells.x.div_ceil(u64::BITS) as usize
    }

    fn first_word(&self, y: u32, z: u32) -> usize {
        (y + self.cells.y * z) as usize * self.words_of_row()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_those_of_the_grid_wherever_they_begin() {
        for cells in [UVec3::new(128, 2, 4), UVec3::new(8, 4, 2)] {
            let hash = |at: u32| at.wrapping_mul(0x9e37_79b9) >> 29;
            let count = cells.element_product();
            let grid: Vec<u32> = (0..count)
                .map(|at| if hash(at) < 3 { SOLID | 1 } else { 77 })
                .collect();
            let mut solid = SolidCells::of(&grid, cells);
            let mut set = SolidCells::of(&vec![SOLID; grid.len()], cells);
            for at in 0..count {
                let cell = UVec3::new(at % cells.x, at / cells.x % cells.y, at / cells.x / cells.y);
                set.set(cell, grid[at as usize] & SOLID != 0);
            }
            assert_eq!(solid, set);
            let expected = |at: IVec3| {
                let is_inside = at.cmpge(IVec3::ZERO).all() && at.cmplt(cells.as_ivec3()).all();
                let at = at.as_uvec3();
                is_inside && hash(at.x + cells.x * (at.y + cells.y * at.z)) < 3
            };
            for z in -1..=cells.z as i32 {
                for y in -1..=cells.y as i32 {
                    for x in -70..=cells.x as i32 {
                        let row = solid.along_x(IVec3::new(x, y, z));
                        for i in 0..64 {
                            let at = IVec3::new(x + i, y, z);
                            assert_eq!(row >> i & 1 == 1, expected(at), "{at} from {x}");
                        }
                    }
                }
            }
            solid.set(UVec3::new(7, 1, 1), true);
            assert_eq!(solid.along_x(IVec3::new(7, 1, 1)) & 1, 1);
        }
    }
}
