//! Edits: a voxel, a box, a sphere. Bricks are allocated and freed, and distances stay exact.

use glam::{IVec3, UVec3, Vec3};

use super::{BRICK, CELL, SOLID, Voxels, brick_index};

/// Most words of the grid, and most bricks, that are copied in vain between two that have changed: another copy to the GPU would
/// take the CPU longer (2 µs on a server).
const JOINED_WORDS: usize = 1024;
const JOINED_BRICKS: usize = 48;

/// What an edit changed, so that the GPU's copy can be updated.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Edit {
    /// Bricks whose masks and materials have changed, and some between them, as disjoint ascending ranges.
    pub bricks: Vec<std::ops::Range<usize>>,
    /// Indices of the grid's words that have changed, and of some between them, likewise.
    pub grid: Vec<std::ops::Range<usize>>,
    /// Voxels (grid space, both ends inclusive) that may have changed.
    pub region: Option<(UVec3, UVec3)>,
}

impl Voxels {
    /// Sets one voxel (grid space) to a material, 0 for air. Voxels outside of the world stay air.
    pub fn set(&mut self, voxel: IVec3, material: u8) -> Edit {
        self.fill_box(voxel, voxel, material)
    }

    /// Sets the voxels of a box, both ends inclusive.
    pub fn fill_box(&mut self, min: IVec3, max: IVec3, material: u8) -> Edit {
        self.edit(min, max, |_, _| material)
    }

    /// Sets the voxels whose centres lie within `radius` of `centre` (grid space).
    pub fn fill_sphere(&mut self, centre: Vec3, radius: f32, material: u8) -> Edit {
        let min = (centre - radius).floor().as_ivec3();
        let max = (centre + radius).floor().as_ivec3();
        self.edit(min, max, |voxel, old| {
            let offset = voxel.as_vec3() + 0.5 - centre;
            let inside = offset.length_squared() <= radius * radius;
            if inside { material } else { old }
        })
    }

    /// Rewrites the voxels of a box (both ends inclusive) as `change(voxel, old material)`.
    pub fn edit(
        &mut self,
        min: IVec3,
        max: IVec3,
        mut change: impl FnMut(IVec3, u8) -> u8,
    ) -> Edit {
        let min = min.max(IVec3::ZERO);
        let max = max.min(self.size().as_ivec3() - 1);
        if min.cmpgt(max).any() {
            return Edit::default();
        }
        let (min, max) = (min.as_uvec3(), max.as_uvec3());
        let mut bricks = Vec::new();
        let mut words = Vec::new();
        // The box of cells that have become empty or are empty no longer: distances depend on nothing else.
        let mut flipped: Option<(UVec3, UVec3)> = None;
        let (low, high) = (min / CELL, max / CELL);
        for z in low.z..=high.z {
            for y in low.y..=high.y {
                for x in low.x..=high.x {
                    let cell = UVec3::new(x, y, z);
                    let index = self.cell_index(cell);
                    let before = self.grid[index];
                    let mut content = self.content(cell);
                    let first = min.max(cell * CELL);
                    let last = max.min(cell * CELL + (CELL - 1));
                    for z in first.z..=last.z {
                        for y in first.y..=last.y {
                            let start = brick_index(UVec3::new(first.x, y, z) % CELL);
                            for (x, slot) in (first.x..=last.x).zip(&mut content[start..]) {
                                *slot = change(IVec3::new(x as i32, y as i32, z as i32), *slot);
                            }
                        }
                    }
                    self.keep_original(cell, &content);
                    bricks.extend(self.store(cell, &content).map(|brick| brick as usize));
                    let is_empty = self.grid[index] & SOLID == 0;
                    if is_empty != (before & SOLID == 0) {
                        let (first, last) = flipped.unwrap_or((cell, cell));
                        flipped = Some((first.min(cell), last.max(cell)));
                    } else if is_empty {
                        // It keeps its distances.
                        self.grid[index] = before;
                    }
                    if self.grid[index] != before {
                        words.push(index);
                    }
                }
            }
        }
        if let Some((first, last)) = flipped {
            self.rebuild_distances_within(first, last, |index| words.push(index));
        }
        Edit {
            bricks: ranges(bricks, JOINED_BRICKS),
            grid: ranges(words, JOINED_WORDS),
            region: Some((min, max)),
        }
    }

    /// Checks every invariant of the structure.
    ///
    /// # Errors
    /// The first invariant that is broken.
    pub fn validate(&self) -> Result<(), String> {
        let mut fresh = self.clone();
        fresh.rebuild_distances();
        if fresh.grid != self.grid {
            return Err("a distance differs from a fresh build".to_owned());
        }
        let mut named = vec![false; self.masks.len()];
        for word in self.grid.iter().filter(|word| **word >> 30 == 2) {
            let brick = (word & BRICK) as usize;
            if std::mem::replace(&mut named[brick], true) {
                return Err(format!("brick {brick} belongs to two cells"));
            }
            let content = &self.materials[brick];
            if content.iter().all(|material| *material == content[0]) {
                return Err(format!("brick {brick} is uniform"));
            }
            if super::masks_of(content) != self.masks[brick] {
                return Err(format!(
                    "the masks of brick {brick} differ from its materials"
                ));
            }
        }
        let free = self.free_bricks.iter().all(|brick| !named[*brick as usize]);
        let counted = named.iter().filter(|named| **named).count() == self.bricks();
        if free && counted {
            Ok(())
        } else {
            Err("the free list differs from what the grid names".to_owned())
        }
    }
}

/// The ranges of these indices; where few indices lie between two, they are joined: each range costs a copy to the GPU.
fn ranges(mut indices: Vec<usize>, joined: usize) -> Vec<std::ops::Range<usize>> {
    // Edits tell them in a few ascending runs, which a stable sort merges.
    indices.sort();
    let mut ranges: Vec<std::ops::Range<usize>> = Vec::new();
    for index in indices {
        match ranges.last_mut() {
            Some(range) if index <= range.end + joined => range.end = range.end.max(index + 1),
            _ => ranges.push(index..index + 1),
        }
    }
    ranges
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::world::voxels::{BRICK_VOXELS, NewCell};

    #[derive(Clone, Debug)]
    enum Change {
        Set(IVec3, u8),
        Box(IVec3, IVec3, u8),
        Sphere(Vec3, f32, u8),
    }

    fn changes() -> impl Strategy<Value = Vec<Change>> {
        let place = || (-4..44i32, -4..44i32, -4..44i32).prop_map(|(x, y, z)| IVec3::new(x, y, z));
        let material = || prop_oneof![Just(0u8), 1..4u8];
        let change = prop_oneof![
            (place(), material()).prop_map(|(at, m)| Change::Set(at, m)),
            (place(), place(), material()).prop_map(|(a, b, m)| Change::Box(a.min(b), a.max(b), m)),
            (place(), 0.5..14.0f32, material()).prop_map(|(at, r, m)| Change::Sphere(
                at.as_vec3(),
                r,
                m
            )),
        ];
        proptest::collection::vec(change, 1..12)
    }

    fn apply(voxels: &mut Voxels, change: &Change) -> Edit {
        match *change {
            Change::Set(at, material) => voxels.set(at, material),
            Change::Box(min, max, material) => voxels.fill_box(min, max, material),
            Change::Sphere(at, radius, material) => voxels.fill_sphere(at, radius, material),
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]
        /// Any sequence of edits gives the same result as a fresh build from the same voxels.
        #[test]
        fn edits_equal_a_fresh_build(changes in changes()) {
            let size = UVec3::new(40, 37, 40);
            let mut edited = Voxels::empty(size);
            let mut followed = edited.clone();
            for change in &changes {
                let edit = apply(&mut edited, change);
                follow(&mut followed, &edited, &edit);
            }
            prop_assert_eq!(edited.validate(), Ok(()));
            let fresh = Voxels::from_cells(size, |cell| {
                let mut content = [0; BRICK_VOXELS];
                for voxel in voxels_of(UVec3::ZERO, UVec3::splat(CELL - 1)) {
                    content[brick_index(voxel)] = edited.material((cell * CELL + voxel).as_ivec3());
                }
                NewCell::Voxels(Box::new(content))
            });
            prop_assert_eq!(edited.bricks(), fresh.bricks());
            for (after, built) in edited.grid.iter().zip(&fresh.grid) {
                // The number of a cell's brick depends on history; whether the cell has a brick does
                // not.
                let same = if after >> 30 == 2 { built >> 30 == 2 } else { after == built };
                prop_assert!(same, "{after:#x} against {built:#x}");
            }
            prop_assert_eq!(&followed.grid, &edited.grid);
            prop_assert_eq!(&followed.masks, &edited.masks);
        }
    }

    fn voxels_of(first: UVec3, last: UVec3) -> impl Iterator<Item = UVec3> {
        (first.z..=last.z).flat_map(move |z| {
            (first.y..=last.y)
                .flat_map(move |y| (first.x..=last.x).map(move |x| UVec3::new(x, y, z)))
        })
    }

    /// Copies only what the edit reports as changed, like the GPU's copy.
    fn follow(copy: &mut Voxels, edited: &Voxels, edit: &Edit) {
        copy.masks.resize(edited.masks.len(), [0; 16]);
        for range in &edit.grid {
            copy.grid[range.clone()].copy_from_slice(&edited.grid[range.clone()]);
        }
        for range in &edit.bricks {
            copy.masks[range.clone()].copy_from_slice(&edited.masks[range.clone()]);
        }
    }

    #[test]
    fn validation_notices_a_wrong_distance() {
        let mut voxels = Voxels::empty(UVec3::splat(64));
        voxels.set(IVec3::splat(20), 1);
        assert_eq!(voxels.validate(), Ok(()));
        voxels.grid[0] += 1;
        assert!(voxels.validate().is_err());
    }

    #[test]
    fn an_edit_that_empties_no_cell_changes_its_own_words_alone() {
        let mut voxels = Voxels::empty(UVec3::splat(128));
        voxels.fill_box(IVec3::splat(64), IVec3::splat(71), 1);
        let index = voxels.cell_index(UVec3::splat(8));
        let dug = voxels.set(IVec3::splat(66), 0);
        let own = index..index + 1;
        assert_eq!(dug.grid, std::slice::from_ref(&own), "it gets a brick");
        let dug = voxels.set(IVec3::splat(67), 0);
        assert_eq!(dug.grid, [], "its brick stays");
        let nothing = voxels.set(IVec3::splat(20), 0);
        assert_eq!(
            (nothing.grid, nothing.bricks),
            (vec![], vec![]),
            "air stays"
        );
        assert_eq!(voxels.validate(), Ok(()));
        let built = voxels.set(IVec3::splat(20), 1);
        let words: usize = built.grid.iter().map(std::ops::Range::len).sum();
        assert!(words > 100 && built.grid.len() < 20, "{:?}", built.grid);
        assert_eq!(voxels.validate(), Ok(()));
    }

    #[test]
    fn an_edit_outside_changes_nothing() {
        let mut voxels = Voxels::empty(UVec3::splat(8));
        assert_eq!(voxels.set(IVec3::splat(-1), 1), Edit::default());
    }
}
