//! Which cells of an octree are divided, and where a cell's neighbours are coarser.

use std::collections::HashSet;

use glam::{IVec3, UVec3};

use crate::world::scenery::MAX_PROBES;

/// The divided cells of each level. Cells are counted from the lattice's first point, in their own size.
#[derive(Debug)]
pub(super) struct Division {
    depth: u32,
    divided: Vec<HashSet<IVec3>>,
}

impl Division {
    /// Asks which cells of a level are divided, from the roots down. If `balanced`, divides more cells until the sizes of
    /// any two cells that touch differ by a factor of 2 at most. `None` for a tree of too many cells.
    pub fn new(
        roots: UVec3,
        depth: u32,
        balanced: bool,
        mut is_divided: impl FnMut(u32, &[IVec3]) -> Vec<bool>,
    ) -> Option<Self> {
        let mut divided = vec![HashSet::new(); depth as usize + 1];
        let mut candidates = all(roots);
        for level in (1..=depth).rev() {
            let answers = is_divided(level, &candidates);
            let chosen = candidates.iter().zip(answers).filter(|(_, answer)| *answer);
            let chosen: Vec<IVec3> = chosen.map(|(cell, _)| *cell).collect();
            if 8 * chosen.len() > MAX_PROBES as usize {
                return None;
            }
            candidates = chosen.iter().flat_map(|cell| children(*cell)).collect();
            divided[level as usize].extend(chosen);
        }
        let mut division = Self { depth, divided };
        if balanced {
            division.balance(roots);
        }
        (division.cells(roots) <= MAX_PROBES).then_some(division)
    }

    /// All cells around a divided one exist, so all their parents are divided. From fine to coarse, because a division
    /// asks for coarser ones alone.
    fn balance(&mut self, roots: UVec3) {
        for level in 1..self.depth as usize {
            let counts = (roots << (self.depth - level as u32)).as_ivec3();
            let around = |cell: &IVec3| {
                let cell = *cell;
                (0..27).map(move |number| cell + step(number))
            };
            let parents: Vec<IVec3> = self.divided[level]
                .iter()
                .flat_map(around)
                .filter(|cell| is_within(*cell, counts))
                .map(|cell| cell >> 1)
                .collect();
            self.divided[level + 1].extend(parents);
        }
    }

    pub fn is_divided(&self, level: u32, cell: IVec3) -> bool {
        self.divided[level as usize].contains(&cell)
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
            let mut parents: Vec<IVec3> =
                self.divided[level as usize + 1].iter().copied().collect();
            parents.sort_by_key(|cell| (cell.z, cell.y, cell.x));
            levels.push((level, parents.into_iter().flat_map(children).collect()));
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

/// One of 27 steps to the places around a cell, itself included.
fn step(number: u32) -> IVec3 {
    UVec3::new(number % 3, number / 3 % 3, number / 9).as_ivec3() - 1
}

fn is_within(cell: IVec3, counts: IVec3) -> bool {
    cell.cmpge(IVec3::ZERO).all() && cell.cmplt(counts).all()
}
