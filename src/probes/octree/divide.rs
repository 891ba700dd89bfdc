//! Which cells of an octree are divided, and where a cell's neighbours are coarser.

use glam::{BVec3, IVec3, UVec3};

use super::cells::CellSet;
use crate::world::scenery::MAX_PROBES;

/// The divided cells of each level. Cells are counted from the lattice's first point, in their own size.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Division {
    depth: u32,
    divided: Vec<CellSet>,
}

impl Division {
    /// Asks which cells of a level are divided, from the roots down. `None` for a tree of too many cells.
    pub fn new(
        roots: UVec3,
        depth: u32,
        mut is_divided: impl FnMut(u32, &[IVec3]) -> Vec<bool>,
    ) -> Option<Self> {
        let empty = |level| CellSet::empty(roots << (depth - level));
        let mut divided: Vec<CellSet> = (0..=depth).map(empty).collect();
        let mut candidates = all(roots);
        for level in (1..=depth).rev() {
            let answers = is_divided(level, &candidates);
            let chosen = candidates.iter().zip(answers).filter(|(_, answer)| *answer);
            let chosen: Vec<IVec3> = chosen.map(|(cell, _)| *cell).collect();
            if 8 * chosen.len() > MAX_PROBES as usize {
                return None;
            }
            candidates = chosen.iter().flat_map(|cell| children(*cell)).collect();
            for cell in chosen {
                divided[level as usize].insert(cell);
            }
        }
        Some(Self { depth, divided })
    }

    /// The same with more divided cells, so that the sizes of any two cells that touch differ by a factor of 2 at most. All cells
    /// around a divided one exist, so all their parents are divided. From fine to coarse, because a division asks for
    /// coarser ones alone.
    pub fn balanced(&self, roots: UVec3) -> Self {
        let mut all = self.clone();
        for level in 1..self.depth as usize {
            let last = (roots << (self.depth - level as u32)).as_ivec3() - 1;
            let (fine, coarse) = all.divided.split_at_mut(level + 1);
            for cell in fine[level].iter() {
                // The parents of all cells around one are those of the corners of these 3³ cells.
                let (low, high) = ((cell - 1).max(IVec3::ZERO), (cell + 1).min(last));
                for corner in 0..8 {
                    coarse[0].insert(IVec3::select(is_high(corner), high, low) >> 1);
                }
            }
        }
        all
    }

    pub fn is_divided(&self, level: u32, cell: IVec3) -> bool {
        self.divided[level as usize].contains(cell)
    }

    /// Number of cells, at most `u32::MAX`.
    pub fn cells(&self, roots: UVec3) -> u32 {
        let divided: u64 = self.divided.iter().map(|cells| cells.len() as u64).sum();
        let roots = roots.to_array().map(u64::from).iter().product::<u64>();
        u32::try_from(roots + 8 * divided).unwrap_or(u32::MAX)
    }

    /// All cells of each level, the coarsest level first, in an order that depends on their places alone: the eight
    /// children of a cell follow each other.
    pub fn by_level(&self, roots: UVec3) -> Vec<(u32, Vec<IVec3>)> {
        let mut levels = vec![(self.depth, all(roots))];
        for level in (0..self.depth).rev() {
            let parents = self.divided[level as usize + 1].iter();
            levels.push((level, parents.flat_map(children).collect()));
        }
        levels
    }

    /// A bit for each of the 27 places around a cell where there is no cell of its size. The world beyond the roots
    /// has no cells that could be coarser.
    pub fn borders(&self, roots: UVec3, level: u32, cell: IVec3) -> u32 {
        if level == self.depth {
            return 0;
        }
        let counts = (roots << (self.depth - level)).as_ivec3();
        let is_border = |number: &u32| {
            let beside = cell + step(*number);
            is_within(beside, counts) && !self.is_divided(level + 1, beside >> 1)
        };
        (0..27).filter(is_border).map(|number| 1 << number).sum()
    }
}

fn all(counts: UVec3) -> Vec<IVec3> {
    let row = |z, y| (0..counts.x).map(move |x| UVec3::new(x, y, z).as_ivec3());
    let layer = |z| (0..counts.y).flat_map(move |y| row(z, y));
    (0..counts.z).flat_map(layer).collect()
}

fn children(cell: IVec3) -> impl Iterator<Item = IVec3> {
    (0..8).map(move |corner| cell * 2 + corner_offset(corner))
}

/// Number of a child among its siblings; `bits` are 0 or 1.
pub(super) fn child(bits: UVec3) -> u32 {
    bits.x + 2 * bits.y + 4 * bits.z
}

/// 0 or 1 along each axis: where a corner is, or a child.
pub(super) fn corner_offset(corner: u32) -> IVec3 {
    UVec3::new(corner & 1, corner >> 1 & 1, corner >> 2).as_ivec3()
}

/// Along which axes a corner is the higher one.
fn is_high(corner: u32) -> BVec3 {
    corner_offset(corner).cmpeq(IVec3::ONE)
}

/// One of 27 steps to the places around a cell, itself included.
fn step(number: u32) -> IVec3 {
    UVec3::new(number % 3, number / 3 % 3, number / 9).as_ivec3() - 1
}

fn is_within(cell: IVec3, counts: IVec3) -> bool {
    cell.cmpge(IVec3::ZERO).all() && cell.cmplt(counts).all()
}
