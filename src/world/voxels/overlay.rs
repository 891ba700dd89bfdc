//! What was changed about voxels, sparse by brick: what a save keeps over the world file.

use std::{collections::BTreeMap, fmt};

use glam::{IVec3, UVec3};

use super::{BRICK_VOXELS, Brick, CELL, Cell, Voxels, brick_index};

/// Words of 64 bits in the mask of a brick.
pub const MASK_WORDS: usize = BRICK_VOXELS / 64;

/// Voxels (grid space) that were set to a material; 0 is air.
#[derive(Clone, Default, PartialEq, Eq)]
pub struct Overlay {
    /// By cell, in the order of z, y, x. Never a brick without a changed voxel.
    bricks: BTreeMap<[u32; 3], ChangedBrick>,
}

/// The changed voxels of one cell.
#[derive(Clone, PartialEq, Eq)]
pub struct ChangedBrick {
    /// Bit i: voxel i of the brick was changed.
    mask: [u64; MASK_WORDS],
    /// Materials of the changed voxels; 0 elsewhere.
    materials: Box<Brick>,
}

impl ChangedBrick {
    fn unchanged() -> Self {
        Self {
            mask: [0; MASK_WORDS],
            materials: Box::new([0; BRICK_VOXELS]),
        }
    }

    fn set(&mut self, index: usize, material: u8) {
        self.mask[index / 64] |= 1 << (index % 64);
        self.materials[index] = material;
    }

    fn count(&self) -> u64 {
        let bits = self.mask.iter().map(|word| u64::from(word.count_ones()));
        bits.sum()
    }

    /// Bit i: voxel i of the brick was changed.
    pub fn mask(&self) -> &[u64; MASK_WORDS] {
        &self.mask
    }

    /// Index within the brick and material of each changed voxel, in the order of the mask.
    pub fn changed(&self) -> impl Iterator<Item = (usize, u8)> + '_ {
        let is_set = |index: &usize| self.mask[index / 64] >> (index % 64) & 1 == 1;
        (0..BRICK_VOXELS)
            .filter(is_set)
            .map(|index| (index, self.materials[index]))
    }
}

impl Overlay {
    pub fn is_empty(&self) -> bool {
        self.bricks.is_empty()
    }

    /// Number of changed voxels.
    pub fn count(&self) -> u64 {
        self.bricks.values().map(ChangedBrick::count).sum()
    }

    /// Sets a voxel (grid space).
    pub fn set(&mut self, voxel: UVec3, material: u8) {
        let cell = voxel / CELL;
        let brick = self.bricks.entry([cell.z, cell.y, cell.x]);
        brick
            .or_insert_with(ChangedBrick::unchanged)
            .set(brick_index(voxel % CELL), material);
    }

    /// The cells with changed voxels, in a fixed order.
    pub fn bricks(&self) -> impl ExactSizeIterator<Item = (UVec3, &ChangedBrick)> {
        let cell = |&[z, y, x]: &[u32; 3]| UVec3::new(x, y, z);
        self.bricks
            .iter()
            .map(move |(key, brick)| (cell(key), brick))
    }

    /// Changed voxels (grid space) with their materials, in a fixed order.
    pub fn voxels(&self) -> impl Iterator<Item = (UVec3, u8)> + '_ {
        self.bricks().flat_map(|(cell, brick)| {
            brick.changed().map(move |(index, material)| {
                let index = index as u32;
                let local = UVec3::new(index & 7, index >> 3 & 7, index >> 6);
                (cell * CELL + local, material)
            })
        })
    }

    /// Adds changes that were made later.
    pub fn extend(&mut self, later: &Self) {
        for (key, brick) in &later.bricks {
            let own = self.bricks.entry(*key);
            let own = own.or_insert_with(ChangedBrick::unchanged);
            for (index, material) in brick.changed() {
                own.set(index, material);
            }
        }
    }

    /// These changes for a world of `size` voxels whose grid begins elsewhere and whose materials have other
    /// numbers: voxels move by `shift`, and `renumbered` gives the new number of a material other than air, if
    /// there is one. With the number of changes that have no place or no material.
    pub fn fitted(
        &self,
        size: UVec3,
        shift: IVec3,
        renumbered: impl Fn(u8) -> Option<u8>,
    ) -> (Self, u64) {
        let mut fitted = Self::default();
        let mut lost = 0;
        for (voxel, material) in self.voxels() {
            let at = voxel.as_ivec3() + shift;
            let is_inside = at.cmpge(IVec3::ZERO).all() && at.cmplt(size.as_ivec3()).all();
            let material = if material == 0 {
                Some(0)
            } else {
                renumbered(material)
            };
            match material.filter(|_| is_inside) {
                Some(material) => fitted.set(at.as_uvec3(), material),
                None => lost += 1,
            }
        }
        (fitted, lost)
    }
}

/// Short, and different for different changes: worlds are told apart by their debug texts.
impl fmt::Debug for Overlay {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut hasher = crc32fast::Hasher::new();
        for (voxel, material) in self.voxels() {
            for axis in voxel.to_array() {
                hasher.update(&axis.to_le_bytes());
            }
            hasher.update(&[material]);
        }
        write!(
            f,
            "Overlay({} voxels, {:08x})",
            self.count(),
            hasher.finalize()
        )
    }
}

/// What cells contained when they were first edited.
#[derive(Clone, Debug, Default)]
pub struct Originals(BTreeMap<[u32; 3], Box<Brick>>);

impl Voxels {
    /// Remembers from now on what edited cells contained, for [`Self::overlay`].
    pub fn remember(&mut self, originals: Originals) {
        self.originals = Some(originals);
    }

    /// What edited cells contained, to continue with other voxels of the same world; empty unless they were
    /// remembered.
    pub fn take_originals(&mut self) -> Originals {
        self.originals.take().unwrap_or_default()
    }

    /// Voxels that differ from what they were when [`Self::remember`] was called. The time that it takes is
    /// proportional to the number of edited cells.
    pub fn overlay(&self) -> Overlay {
        let mut overlay = Overlay::default();
        for (&[z, y, x], original) in self.originals.iter().flat_map(|known| &known.0) {
            let cell = UVec3::new(x, y, z);
            let content = self.content(cell);
            let mut brick = ChangedBrick::unchanged();
            for (index, (now, before)) in content.iter().zip(&original[..]).enumerate() {
                if now != before {
                    brick.set(index, *now);
                }
            }
            if brick.count() > 0 {
                overlay.bricks.insert([z, y, x], brick);
            }
        }
        overlay
    }

    /// Makes these changes; those outside of the world have no effect.
    pub fn apply(&mut self, overlay: &Overlay) {
        let size = self.size();
        for (cell, brick) in overlay.bricks() {
            if (cell * CELL).cmpge(size).any() {
                continue;
            }
            let mut content = self.content(cell);
            for (index, material) in brick.changed() {
                let number = index as u32;
                let local = UVec3::new(number & 7, number >> 3 & 7, number >> 6);
                if (cell * CELL + local).cmplt(size).all() {
                    content[index] = material;
                }
            }
            self.keep_original(cell, &content);
            self.store(cell, &content);
        }
        if !overlay.is_empty() {
            self.rebuild_distances();
        }
    }

    /// To be called before a cell gets another content.
    pub(super) fn keep_original(&mut self, cell: UVec3, next: &Brick) {
        if self.originals.is_none() {
            return;
        }
        let now = self.content(cell);
        if let Some(Originals(known)) = &mut self.originals
            && now != *next
        {
            let UVec3 { x, y, z } = cell;
            known.entry([z, y, x]).or_insert_with(|| Box::new(now));
        }
    }

    /// The materials of a cell.
    pub(super) fn content(&self, cell: UVec3) -> Brick {
        match self.cell(cell) {
            Cell::Empty => [0; BRICK_VOXELS],
            Cell::Uniform(material) => [material; BRICK_VOXELS],
            Cell::Brick(materials) => *materials,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A world with stone below and air above, whose edits are remembered.
    fn ground() -> Voxels {
        let mut voxels = Voxels::empty(UVec3::new(40, 37, 40));
        voxels.fill_box(IVec3::ZERO, IVec3::new(39, 12, 39), 2);
        voxels.remember(Originals::default());
        voxels
    }

    #[test]
    fn an_overlay_makes_of_the_old_voxels_the_new_ones() {
        let fresh = ground();
        let mut edited = fresh.clone();
        edited.fill_sphere(glam::Vec3::new(11.0, 13.0, 9.0), 6.0, 0);
        edited.fill_box(IVec3::new(30, 30, 30), IVec3::new(60, 36, 39), 3);
        edited.set(IVec3::new(0, 20, 0), 1);
        edited.set(IVec3::new(0, 20, 0), 0);
        let overlay = edited.overlay();
        assert!(overlay.count() > 500);
        let mut again = fresh.clone();
        again.apply(&overlay);
        assert_eq!(again.crc32(), edited.crc32());
        assert_eq!(again.validate(), Ok(()));
        assert_eq!(again.overlay(), overlay);
        assert!(overlay.voxels().all(|(at, _)| at != UVec3::new(0, 20, 0)));
        assert!(fresh.overlay().is_empty());
    }

    #[test]
    fn later_changes_win() {
        let (mut first, mut later) = (Overlay::default(), Overlay::default());
        first.set(UVec3::new(9, 9, 9), 1);
        first.set(UVec3::new(10, 9, 9), 2);
        later.set(UVec3::new(9, 9, 9), 0);
        later.set(UVec3::new(30, 9, 9), 3);
        first.extend(&later);
        let all: Vec<_> = first.voxels().collect();
        assert_eq!(
            all,
            [
                (UVec3::new(9, 9, 9), 0),
                (UVec3::new(10, 9, 9), 2),
                (UVec3::new(30, 9, 9), 3)
            ]
        );
    }

    #[test]
    fn what_does_not_fit_is_counted() {
        let mut overlay = Overlay::default();
        overlay.set(UVec3::new(0, 0, 0), 1);
        overlay.set(UVec3::new(9, 0, 0), 2);
        overlay.set(UVec3::new(10, 0, 0), 0);
        overlay.set(UVec3::new(11, 0, 0), 7);
        let known = |material| (material < 5).then_some(material + 1);
        let (fitted, lost) = overlay.fitted(UVec3::splat(10), IVec3::new(-1, 0, 0), known);
        let all: Vec<_> = fitted.voxels().collect();
        assert_eq!(all, [(UVec3::new(8, 0, 0), 3), (UVec3::new(9, 0, 0), 0)]);
        assert_eq!(lost, 2);
        assert_ne!(format!("{overlay:?}"), format!("{fitted:?}"));
    }
}
