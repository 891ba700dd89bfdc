//! Which feature parts overlap which grid cell.

use glam::{IVec3, UVec3};

use crate::world::FeaturePart;
use crate::world::voxels::CELL;

/// For every cell that the world touches, the parts that overlap it, in the world's order, as
/// compressed rows: those of cell i are `parts[offsets[i] .. offsets[i + 1]]`.
#[derive(Clone, Debug)]
pub struct FeatureBins {
    cells: UVec3,
    offsets: Vec<u32>,
    parts: Vec<u32>,
}

impl FeatureBins {
    /// Most part numbers in all rows together: 128 MB.
    pub const MOST: u64 = 1 << 25;

    /// Number of part numbers in all rows: for each part, the cells that it overlaps. A valid world has
    /// at most [`Self::MOST`].
    pub fn count(parts: &[FeaturePart], origin: IVec3, size: UVec3) -> u64 {
        let cells = parts.iter().filter_map(|part| cells_of(part, origin, size));
        cells
            .map(|(first, last)| (last - first + 1).as_u64vec3().element_product())
            .sum()
    }

    /// Sorts the parts of a world of `size` voxels at `origin` into its cells.
    pub fn new(parts: &[FeaturePart], origin: IVec3, size: UVec3) -> Self {
        let cells = size.map(|n| n.div_ceil(CELL));
        let index = |cell: UVec3| (cell.x + cells.x * (cell.y + cells.y * cell.z)) as usize;
        let mut counts = vec![0; cells.element_product() as usize + 1];
        for part in parts {
            for_each_cell(part, origin, size, |cell| counts[index(cell) + 1] += 1);
        }
        for i in 1..counts.len() {
            counts[i] += counts[i - 1];
        }
        let offsets = counts;
        let mut next = offsets.clone();
        let mut sorted = vec![0; offsets[offsets.len() - 1] as usize];
        for (number, part) in parts.iter().enumerate() {
            for_each_cell(part, origin, size, |cell| {
                let slot = &mut next[index(cell)];
                sorted[*slot as usize] = number as u32;
                *slot += 1;
            });
        }
        Self {
            cells,
            offsets,
            parts: sorted,
        }
    }

    /// Indices of the parts that overlap a cell.
    pub fn of(&self, cell: UVec3) -> &[u32] {
        let index = (cell.x + self.cells.x * (cell.y + self.cells.y * cell.z)) as usize;
        &self.parts[self.offsets[index] as usize..self.offsets[index + 1] as usize]
    }

    /// Extent in cells: rows are ordered with x fastest, then y.
    pub fn cells(&self) -> UVec3 {
        self.cells
    }

    /// The rows' offsets and the part indices.
    pub fn rows(&self) -> (&[u32], &[u32]) {
        (&self.offsets, &self.parts)
    }
}

/// First and last cell that a part overlaps; `None` if it lies outside the world.
fn cells_of(part: &FeaturePart, origin: IVec3, size: UVec3) -> Option<(UVec3, UVec3)> {
    let last = size.as_ivec3() - 1;
    let (min, max) = (part.min - origin, part.max - origin);
    if max.cmplt(IVec3::ZERO).any() || min.cmpgt(last).any() || min.cmpgt(max).any() {
        return None;
    }
    let first = min.max(IVec3::ZERO).as_uvec3() / CELL;
    Some((first, max.min(last).as_uvec3() / CELL))
}

fn for_each_cell(part: &FeaturePart, origin: IVec3, size: UVec3, mut visit: impl FnMut(UVec3)) {
    let Some((first, last)) = cells_of(part, origin, size) else {
        return;
    };
    for z in first.z..=last.z {
        for y in first.y..=last.y {
            for x in first.x..=last.x {
                visit(UVec3::new(x, y, z));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_listed_in_order_in_every_cell_that_they_overlap() {
        let part = |min: [i32; 3], max: [i32; 3]| FeaturePart {
            min: min.into(),
            max: max.into(),
            material: 1,
            without_corners: false,
        };
        let parts = [
            part([-3, -3, -3], [8, 8, 8]),
            part([100, 0, 0], [101, 1, 1]),
            part([12, 0, 0], [12, 0, 20]),
            part([-9, -9, -9], [-5, 20, 20]),
        ];
        let bins = FeatureBins::new(&parts, IVec3::new(-4, 0, 0), UVec3::new(20, 12, 20));
        assert_eq!(bins.cells(), UVec3::new(3, 2, 3));
        assert_eq!(bins.of(UVec3::new(0, 0, 0)), [0]);
        assert_eq!(bins.of(UVec3::new(1, 1, 1)), [0]);
        // World x = 12 is grid x = 16: the third cell.
        assert_eq!(bins.of(UVec3::new(2, 0, 2)), [2]);
        assert_eq!(bins.of(UVec3::new(2, 1, 2)), [] as [u32; 0]);
        assert_eq!(bins.rows().0.len(), 3 * 2 * 3 + 1);
        let count = FeatureBins::count(&parts, IVec3::new(-4, 0, 0), UVec3::new(20, 12, 20));
        assert_eq!(bins.rows().1.len() as u64, count);
    }
}
