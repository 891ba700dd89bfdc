//! Octant distances of empty cells: how many whole cells a ray may cross at once.
//!
//! For octant o, the distance of a cell is the largest n ≤ 8 such that the n³ cells from it in the
//! direction of the octant are all empty (beyond the grid counts as empty). With the seven
//! neighbours towards the octant it obeys d = min(8, 1 + min d(neighbour)), non-empty cells having 0.

use glam::{IVec3, UVec3};
use rayon::prelude::*;

use super::{FARTHEST, SOLID, Voxels};

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
        let reach = UVec3::splat(FARTHEST - 1);
        let low = min.saturating_sub(reach);
        let high = (max + reach).min(self.cells - UVec3::ONE);
        let octants: Vec<Vec<u8>> = (0..8u32)
            .into_par_iter()
            .map(|octant| self.octant_distances(octant, low, high))
            .collect();
        let extent = high - low + UVec3::ONE;
        for z in 0..extent.z {
            for y in 0..extent.y {
                for x in 0..extent.x {
                    let index = self.cell_index(low + UVec3::new(x, y, z));
                    if self.grid[index] & SOLID != 0 {
                        continue;
                    }
                    let local = (x + extent.x * (y + extent.y * z)) as usize;
                    let word = octants
                        .iter()
                        .enumerate()
                        .map(|(octant, distances)| u32::from(distances[local] - 1) << (3 * octant))
                        .sum();
                    if self.grid[index] != word {
                        self.grid[index] = word;
                        changed(index);
                    }
                }
            }
        }
    }

    /// Distances of one octant inside the box, x fastest. Distances of cells outside the box, towards
    /// the octant, are read from the grid, where they are still valid.
    fn octant_distances(&self, octant: u32, low: UVec3, high: UVec3) -> Vec<u8> {
        let extent = high - low + UVec3::ONE;
        let backwards = UVec3::new(octant & 1, octant >> 1 & 1, octant >> 2 & 1);
        let towards = IVec3::ONE - 2 * backwards.as_ivec3();
        let mut found = vec![0u8; extent.element_product() as usize];
        let local = |cell: UVec3| (cell.x + extent.x * (cell.y + extent.y * cell.z)) as usize;
        // From the far end of the octant backwards, so that the neighbours are known.
        let order = |n: u32, back: u32| (0..n).map(move |i| if back == 1 { i } else { n - 1 - i });
        for z in order(extent.z, backwards.z) {
            for y in order(extent.y, backwards.y) {
                for x in order(extent.x, backwards.x) {
                    let cell = UVec3::new(x, y, z);
                    if self.grid[self.cell_index(low + cell)] & SOLID != 0 {
                        continue;
                    }
                    let nearest = (1..8)
                        .map(|step| {
                            let offset = IVec3::new(step & 1, step >> 1 & 1, step >> 2 & 1);
                            let neighbour = cell.as_ivec3() + offset * towards;
                            let in_box = neighbour.cmpge(IVec3::ZERO).all()
                                && neighbour.cmplt(extent.as_ivec3()).all();
                            if in_box {
                                u32::from(found[local(neighbour.as_uvec3())])
                            } else {
                                self.stored_distance(octant, low.as_ivec3() + neighbour)
                            }
                        })
                        .min()
                        .unwrap_or(FARTHEST);
                    found[local(cell)] = (nearest + 1).min(FARTHEST) as u8;
                }
            }
        }
        found
    }

    /// The distance stored in the grid: 0 for a cell that is not empty, the maximum outside.
    fn stored_distance(&self, octant: u32, cell: IVec3) -> u32 {
        if cell.cmplt(IVec3::ZERO).any() || cell.cmpge(self.cells.as_ivec3()).any() {
            return FARTHEST;
        }
        let word = self.grid[self.cell_index(cell.as_uvec3())];
        if word & SOLID != 0 {
            0
        } else {
            (word >> (3 * octant) & 7) + 1
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::voxels::NewCell;

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
                voxels.stored_distance(0, cell + offset) > 0
            })
        };
        (1..=FARTHEST)
            .take_while(|n| empty(*n as i32))
            .last()
            .unwrap_or(0)
    }

    #[test]
    fn distances_are_the_largest_empty_cubes() {
        let voxels = Voxels::from_cells(UVec3::new(128, 64, 128), |cell| {
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
            for i in (0..cells.element_product()).step_by(7) {
                let cell = IVec3::new(i % cells.x, i / cells.x % cells.y, i / cells.x / cells.y);
                assert_eq!(
                    voxels.stored_distance(octant, cell),
                    by_definition(&voxels, octant, cell),
                    "octant {octant}, cell {cell}"
                );
            }
        }
    }
}
