//! Octant distances of empty cells: how many whole cells a ray may cross at once.
//!
//! For octant o, the distance of a cell is the largest n ≤ 8 such that the n³ cells from it in the
//! direction of the octant are all empty (beyond the grid counts as empty).
//!
//! They are found for a row of cells at once, one bit for each cell. A cube of n + 1 cells is empty if the
//! eight cubes of n cells at its corners are, so seven rounds of shifts find all empty cubes of up to eight. A
//! cube serves eight octants: it lies at the distance of the cell at each of its corners.

use glam::{IVec3, UVec3};
use rayon::prelude::*;

use super::{FARTHEST, SOLID, Voxels};

/// Cells beyond a block that its distances depend on.
const REACH: u32 = FARTHEST - 1;
/// Most cells of a block: together with what lies beyond it, a row is one word.
const BLOCK: UVec3 = UVec3::new(u64::BITS - 2 * REACH, 64, 32);
const OCTANTS: usize = 8;
/// Bits of a distance less one.
const BITS: usize = 3;

impl Voxels {
    /// Recomputes the distances of every empty cell.
    pub(super) fn rebuild_distances(&mut self) {
        self.rebuild_distances_within(UVec3::ZERO, self.cells - UVec3::ONE, |_| ());
    }

    /// Recomputes the distances that depend on the cells in the box `min..=max`: those of the cells up
    /// to seven farther out. Tells the indices of the grid's words that change.
    pub(super) fn rebuild_distances_within(
        &mut self,
        min: UVec3,
        max: UVec3,
        mut changed: impl FnMut(usize),
    ) {
        let low = min.saturating_sub(UVec3::splat(REACH));
        let high = (max + REACH).min(self.cells - UVec3::ONE);
        let counts = (high - low) / BLOCK + 1;
        let blocks = 0..counts.element_product();
        let block = |i: u32| {
            let at = UVec3::new(
                i % counts.x,
                i / counts.x % counts.y,
                i / counts.x / counts.y,
            );
            let first = low + at * BLOCK;
            (first, high.min(first + BLOCK - 1))
        };
        let words = |i: u32| {
            let (first, last) = block(i);
            self.block_of_words(first, last)
        };
        // To wake another thread takes longer than a block of an edit.
        let found: Vec<Vec<u32>> = if blocks.len() == 1 {
            blocks.clone().map(words).collect()
        } else {
            blocks.clone().into_par_iter().map(words).collect()
        };
        for (i, words) in blocks.zip(found) {
            let (first, last) = block(i);
            let extent = last - first + 1;
            for (row, words) in words.chunks_exact(extent.x as usize).enumerate() {
                let row = row as u32;
                let start = self.cell_index(first + UVec3::new(0, row % extent.y, row / extent.y));
                for (index, word) in (start..).zip(words) {
                    let old = self.grid[index];
                    if old & SOLID == 0 && old != *word {
                        self.grid[index] = *word;
                        changed(index);
                    }
                }
            }
        }
    }

    /// The words of a block of cells (both ends inclusive) with the distances of those that are empty: x, then y, then z.
    fn block_of_words(&self, low: UVec3, high: UVec3) -> Vec<u32> {
        const HALF: usize = u32::BITS as usize;
        let extent = high - low + 1;
        let cubes = EmptyCubes::find(self, low, high);
        let mut words = Vec::with_capacity(extent.element_product() as usize);
        for z in 0..extent.z as usize {
            for y in 0..extent.y as usize {
                if cubes.none_is_empty(y, z) {
                    words.extend(std::iter::repeat_n(0, extent.x as usize));
                    continue;
                }
                let bits = cubes.distances(y, z);
                for first in (0..extent.x as usize).step_by(HALF) {
                    let mut half = [0; HALF];
                    for (word, bits) in half.iter_mut().zip(bits) {
                        *word = (bits >> first) as u32;
                    }
                    transpose(&mut half);
                    words.extend(&half[..HALF.min(extent.x as usize - first)]);
                }
            }
        }
        words
    }

    /// Bit i: the cell i places along x is empty, or lies beyond the grid.
    fn empty_row(&self, first: IVec3, length: u32) -> u64 {
        let cells = self.cells.as_ivec3();
        let is_inside = |at: i32, end: i32| (0..end).contains(&at);
        if !is_inside(first.y, cells.y) || !is_inside(first.z, cells.z) {
            return u64::MAX;
        }
        let start = first.x.max(0);
        let end = (first.x + length as i32).min(cells.x);
        let index = self.cell_index(first.with_x(start).as_uvec3());
        let row = &self.grid[index..index + (end - start) as usize];
        let solid = (row.iter().enumerate()).fold(0, |bits, (x, word)| {
            bits | u64::from(word >> SOLID.trailing_zeros()) << x
        });
        !(solid << (start - first.x))
    }
}

/// Which cubes of cells in and around a block are empty. Bits and rows stand for their lowest corners, from
/// [`REACH`] before the block.
struct EmptyCubes {
    /// Rows along y.
    height: usize,
    /// Rows of cubes by their edge, from 1 to [`FARTHEST`] cells.
    by_edge: Vec<Vec<u64>>,
}

impl EmptyCubes {
    fn find(voxels: &Voxels, low: UVec3, high: UVec3) -> Self {
        let first = low.as_ivec3() - REACH as i32;
        let extent = high - low + (1 + 2 * REACH);
        let height = extent.y as usize;
        let rows = (0..extent.y * extent.z).map(|row| {
            let at = UVec3::new(0, row % extent.y, row / extent.y);
            voxels.empty_row(first + at.as_ivec3(), extent.x)
        });
        let mut by_edge = vec![rows.collect::<Vec<u64>>()];
        for edge in 1..FARTHEST as usize {
            let smaller = &by_edge[edge - 1];
            // The last rows have no neighbours, or wrong ones. Cubes there would reach out of what was looked at, and nobody asks for them.
            let mut rows = vec![0; smaller.len()];
            for (at, row) in rows.iter_mut().take(smaller.len() - height - 1).enumerate() {
                let four =
                    smaller[at] & smaller[at + 1] & smaller[at + height] & smaller[at + height + 1];
                *row = four & four >> 1;
            }
            by_edge.push(rows);
        }
        Self { height, by_edge }
    }

    /// Whether all cells of a row of the block, and those beside it, are solid.
    fn none_is_empty(&self, y: usize, z: usize) -> bool {
        let before = REACH as usize;
        self.by_edge[0][y + before + self.height * (z + before)] == 0
    }

    /// The distances of a row of the block's cells, each less one: bit b of that of octant o in word 3 o + b.
    fn distances(&self, y: usize, z: usize) -> [u64; BITS * OCTANTS] {
        let mut distances = [0; BITS * OCTANTS];
        for (octant, bits) in distances.as_chunks_mut::<BITS>().0.iter_mut().enumerate() {
            let [x_back, y_back, z_back] = [octant & 1, octant >> 1 & 1, octant >> 2 & 1];
            let is_empty = |edge: usize| {
                // Where the octant looks backwards, the cell is the cube's last.
                let to_corner = |is_back: usize| REACH as usize - is_back * (edge - 1);
                let row = y + to_corner(y_back) + self.height * (z + to_corner(z_back));
                self.by_edge[edge - 1][row] >> to_corner(x_back)
            };
            // A cube is empty only if the smaller ones are, so the distance is the number of sizes that are empty.
            let [two, three, four, five, six, seven, eight] = [2, 3, 4, 5, 6, 7, 8].map(is_empty);
            *bits = [
                two & !three | four & !five | six & !seven | eight,
                three & !five | seven,
                five,
            ];
        }
        distances
    }
}

/// Exchanges rows and columns: bit c of word r becomes bit r of word c (Warren, *Hacker's Delight*, section 7-3).
fn transpose(words: &mut [u32; 32]) {
    let mut low_half = u32::MAX;
    for width in [16, 8, 4, 2, 1] {
        low_half ^= low_half << width;
        for low in (0..words.len()).filter(|row| row & width == 0) {
            let high = low + width;
            let exchanged = (words[low] >> width ^ words[high]) & low_half;
            words[low] ^= exchanged << width;
            words[high] ^= exchanged;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::voxels::NewCell;

    /// The distance stored in the grid: 0 for a cell that is not empty, the maximum outside.
    fn stored_distance(voxels: &Voxels, octant: u32, cell: IVec3) -> u32 {
        if cell.cmplt(IVec3::ZERO).any() || cell.cmpge(voxels.cells.as_ivec3()).any() {
            return FARTHEST;
        }
        let word = voxels.grid[voxels.cell_index(cell.as_uvec3())];
        if word & SOLID != 0 {
            0
        } else {
            (word >> (3 * octant) & 7) + 1
        }
    }

    /// From the definition: the largest empty cube.
    fn by_definition(voxels: &Voxels, octant: u32, cell: IVec3) -> u32 {
        let towards = IVec3::new(
            octant as i32 & 1,
            octant as i32 >> 1 & 1,
            octant as i32 >> 2,
        );
        let towards = IVec3::ONE - 2 * towards;
        let empty = |n: i32| {
            (0..n * n * n).all(|i| {
                let offset = IVec3::new(i % n, i / n % n, i / n / n) * towards;
                stored_distance(voxels, 0, cell + offset) > 0
            })
        };
        (1..=FARTHEST)
            .take_while(|n| empty(*n as i32))
            .last()
            .unwrap_or(0)
    }

    #[test]
    fn rows_and_columns_are_exchanged() {
        let words: [u32; 32] =
            std::array::from_fn(|row| (row as u32 + 1).wrapping_mul(0x9e37_79b9));
        let mut exchanged = words;
        transpose(&mut exchanged);
        for (row, word) in words.iter().enumerate() {
            for (column, other) in exchanged.iter().enumerate() {
                assert_eq!(word >> column & 1, other >> row & 1, "{row}, {column}");
            }
        }
    }

    /// A grid larger than a block along each axis.
    #[test]
    fn distances_are_the_largest_empty_cubes() {
        let voxels = Voxels::from_cells(UVec3::new(1000, 520, 290), |cell| {
            let hash =
                (cell.x * 73 + cell.y * 179 + cell.z * 283).wrapping_mul(2_654_435_761) >> 24;
            if hash < 3 {
                NewCell::Uniform(1)
            } else {
                NewCell::Empty
            }
        });
        let cells = voxels.cells().as_ivec3();
        for octant in 0..8 {
            for i in (0..cells.element_product()).step_by(61) {
                let cell = IVec3::new(i % cells.x, i / cells.x % cells.y, i / cells.x / cells.y);
                assert_eq!(
                    stored_distance(&voxels, octant, cell),
                    by_definition(&voxels, octant, cell),
                    "octant {octant}, cell {cell}"
                );
            }
        }
    }
}
