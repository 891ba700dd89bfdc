//! Where the probes of an octree are.

use glam::IVec3;

use super::Octree;
use super::cells::Lattice;
use super::divide::{Division, corner_offset};
use crate::world::voxels::Voxels;

impl Octree {
    /// Every probe's place (voxels from the first lattice point), its level, and the level of the finest cell at it; in
    /// the order of levels and places.
    pub(super) fn homes(&self, division: &Division, voxels: &Voxels) -> Vec<(IVec3, u32, u32)> {
        let mut homes = match self.spec.source {
            true => self.middles(division, voxels),
            false => self.corners(division),
        };
        homes.sort_by_key(|(home, level, _)| (*level, home.z, home.y, home.x));
        homes
    }

    /// The middles of leaves that see enough: the published way.
    fn middles(&self, division: &Division, voxels: &Voxels) -> Vec<(IVec3, u32, u32)> {
        let mut homes = Vec::new();
        for (level, cells) in division.by_level(self.roots) {
            let size = self.step << level;
            let leaves = cells
                .into_iter()
                .filter(|cell| !division.is_divided(level, *cell));
            let kept = leaves.filter(|cell| self.geometry.is_kept(voxels, level, *cell));
            homes.extend(kept.map(|cell| (cell * size + size / 2, level, level)));
        }
        homes
    }

    /// The corners of all cells.
    fn corners(&self, division: &Division) -> Vec<(IVec3, u32, u32)> {
        let points = self.points();
        // One more than the level of the finest cell; 0: no cell has this corner.
        let mut finest = vec![0u8; points.count()];
        for (level, cells) in division.by_level(self.roots) {
            for cell in cells {
                for corner in 0..8 {
                    // Finer levels come later.
                    let point = (cell + corner_offset(corner)) << level;
                    finest[points.number(point)] = level as u8 + 1;
                }
            }
        }
        let found = (0..).zip(&finest).filter(|(_, finest)| **finest > 0);
        let home = |(number, finest): (usize, &u8)| {
            let point = points.place(number);
            let natural = natural_level(point, self.spec.depth);
            (point * self.step, natural, u32::from(*finest) - 1)
        };
        found.map(home).collect()
    }

    /// Of the finest lattice.
    pub(super) fn points(&self) -> Lattice {
        Lattice((self.roots << self.spec.depth) + 1)
    }
}

/// The coarsest level whose lattice has this point of the finest one.
fn natural_level(point: IVec3, coarsest: u32) -> u32 {
    (point.x | point.y | point.z).trailing_zeros().min(coarsest)
}
