//! An octree of probes: a lattice of root cells, each divided where there is geometry.
//!
//! Probes are the corners of all cells, divided ones included; corners at the same place are one probe. A point is lit
//! by the eight corners of the finest cell around it. Beside coarser cells the light of a cell fades to that of the
//! cell it was divided from, whose corners are probes too. Because of that, hanging nodes need no treatment of their
//! own: on the border to a coarser cell both sides interpolate the same eight probes. The tree is balanced: the sizes
//! of cells that touch, even in a corner, differ by a factor of 2 at most. docs/notes/octree.md has the argument.
//!
//! `shaders/probes/octree.wesl` does the same on the GPU.

mod cells;
mod check;
mod divide;
mod geometry;
mod homes;
mod lookup;

use glam::{IVec3, UVec3, Vec3};
use rustc_hash::FxHashMap;

use super::ProbeError;
use crate::world::scenery::{MAX_PROBES, OctreeSpec};
use crate::world::{LayoutSpec, voxels::Voxels};
use check::check;
use divide::{Division, corner_offset};
use geometry::Geometry;

crate::shared! {
    in probes;

    /// Rows of a cell: its children and its borders, and its corners' slots.
    pub const CELL_ROWS: u32 = 3;

    /// Width, in its own size, of a cell's edge over which its light fades to that of the cell it was divided from.
    const CELL_FADE: f32 = 0.5;

    /// Fields of a slot's word: its level, that of the finest cell that it is a corner of, and three flags: whether it
    /// has a probe, whether the probe is new, and whether cells around it are new.
    pub const SLOT_FINEST_SHIFT: u32 = 4;
    pub const SLOT_USED: u32 = 1 << 8;
    pub const SLOT_FRESH: u32 = 1 << 9;
    pub const SLOT_TOUCHED: u32 = 1 << 10;
}

/// Spare slots of each level and spare cells, for edits: one in this many, and SPARE more.
const SPARE_SHARE: u32 = 4;
const SPARE: u32 = 64;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Slot {
    /// Voxels from the lattice's first point.
    home: IVec3,
    level: u8,
    /// Level of the finest cell that has it as a corner.
    finest: u8,
    used: bool,
    fresh: bool,
    touched: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Cell {
    /// Number of the first of its eight children; 0: it is not divided.
    children: u32,
    /// A bit for each of the 27 places around it that has no cell of its size.
    borders: u32,
    corners: [u32; 8],
}

/// The octree of a world's voxels.
#[derive(Clone, Debug, PartialEq)]
pub struct Octree {
    spec: OctreeSpec,
    /// World-space voxel at the lattice's first point.
    anchor: IVec3,
    /// Voxels between the points of the finest lattice.
    step: IVec3,
    roots: UVec3,
    /// First slot of each level, and the end of the last one.
    first_slots: Vec<u32>,
    slots: Vec<Slot>,
    by_home: FxHashMap<IVec3, u32>,
    /// The roots, then the children of each divided cell together.
    cells: Vec<Cell>,
    cell_room: u32,
    geometry: Geometry,
    /// What the geometry divides; balance divides more.
    wanted: Option<Division>,
    fresh: u32,
}

impl Octree {
    /// Divides the roots by the geometry in `voxels`; `origin` is the world-space place of the first voxel.
    ///
    /// # Errors
    /// [`ProbeError`] for counts below 2, a spacing that cannot be halved `depth` times, and for more cells or probes
    /// than are possible.
    pub fn new(layout: &LayoutSpec, voxels: &Voxels, origin: IVec3) -> Result<Self, ProbeError> {
        let spec = layout.octree.clone().unwrap_or_default();
        let step = check(layout, spec.depth)?;
        let roots = layout.counts - 1;
        let half = (roots << spec.depth).as_vec3() * step.as_vec3() * 0.5;
        let anchor = (layout.centre - half).round().as_ivec3();
        let geometry = Geometry::new(&spec, roots, step, anchor - origin, voxels);
        let mut tree = Self {
            anchor,
            step,
            roots,
            first_slots: Vec::new(),
            slots: Vec::new(),
            by_home: FxHashMap::default(),
            cells: Vec::new(),
            cell_room: 0,
            geometry,
            wanted: None,
            fresh: 0,
            spec,
        };
        let too_many = |slots: u64| ProbeError::TooMany {
            layout: layout.name.clone(),
            slots,
            most: MAX_PROBES,
        };
        let too_deep = ProbeError::Cells {
            layout: layout.name.clone(),
            depth: tree.spec.depth,
            most: MAX_PROBES,
        };
        let wanted = tree.wanted(voxels);
        let Some(division) = wanted.as_ref().and_then(|wanted| tree.division(wanted)) else {
            return Err(too_deep);
        };
        tree.wanted = wanted;
        let homes = tree.homes(&division, voxels);
        let mut first = 0u64;
        for level in 0..=tree.spec.depth {
            tree.first_slots.push(first.min(u64::from(u32::MAX)) as u32);
            let count = homes.iter().filter(|home| home.1 == level).count() as u64;
            // No level has more probes than its whole lattice.
            let lattice = (tree.roots << (tree.spec.depth - level)) + 1;
            let whole = lattice.to_array().map(u64::from).iter().product::<u64>();
            first +=
                (count + count / u64::from(SPARE_SHARE) + u64::from(SPARE)).min(whole.max(count));
        }
        if first > u64::from(MAX_PROBES) {
            return Err(too_many(first));
        }
        tree.first_slots.push(first as u32);
        tree.slots = vec![Slot::default(); first as usize];
        for level in 0..=tree.spec.depth {
            let own = tree.first_slots[level as usize]..tree.first_slots[level as usize + 1];
            for slot in own {
                tree.slots[slot as usize].level = level as u8;
            }
        }
        let cells = division.cells(tree.roots);
        tree.cell_room = cells + cells / SPARE_SHARE + 8 * SPARE;
        let settled = tree.settle(&division, &homes);
        debug_assert!(settled.is_some(), "room for every probe was just made");
        for slot in &mut tree.slots {
            (slot.fresh, slot.touched) = (false, false);
        }
        tree.fresh = 0;
        Ok(tree)
    }

    /// Divides again what voxels that have changed (grid space, both ends inclusive) make different. Probes whose place
    /// stays keep their slots. Returns whether any probe is new or gone. A tree without room for the new probes stays
    /// as it is: it lights the changed voxels, only not as finely.
    pub fn regrow(&mut self, voxels: &Voxels, first: IVec3, last: IVec3) -> bool {
        self.geometry.edit(voxels, first, last);
        let wanted = self.wanted(voxels);
        // The published way also asks which leaves see enough of the voxels.
        if wanted == self.wanted && !self.spec.source {
            return false;
        }
        let Some(division) = wanted.as_ref().and_then(|wanted| self.division(wanted)) else {
            return false;
        };
        if division.cells(self.roots) > self.cell_room {
            return false;
        }
        let homes = self.homes(&division, voxels);
        let Some(is_changed) = self.settle(&division, &homes) else {
            return false;
        };
        self.wanted = wanted;
        is_changed
    }

    /// What the geometry divides. `None` for a tree of too many cells.
    fn wanted(&mut self, voxels: &Voxels) -> Option<Division> {
        let geometry = &mut self.geometry;
        Division::new(self.roots, self.spec.depth, |level, cells| {
            geometry.divided(voxels, level, cells)
        })
    }

    /// What the tree divides for that. `None` for a tree of too many cells.
    fn division(&self, wanted: &Division) -> Option<Division> {
        let division = match self.spec.source {
            true => wanted.clone(),
            false => wanted.balanced(self.roots),
        };
        (division.cells(self.roots) <= MAX_PROBES).then_some(division)
    }

    /// Gives every probe a slot, and builds the cells. Returns whether any probe is new, gone, or a corner of new cells; `None`, and
    /// changes nothing, without enough slots.
    fn settle(&mut self, division: &Division, homes: &[(IVec3, u32, u32)]) -> Option<bool> {
        let mut kept = vec![false; self.slots.len()];
        let mut found = vec![None; homes.len()];
        for (place, (home, ..)) in found.iter_mut().zip(homes) {
            *place = self.by_home.get(home).copied();
            if let Some(slot) = *place {
                kept[slot as usize] = true;
            }
        }
        let mut next = self.first_slots.clone();
        for (place, (_, level, _)) in found.iter_mut().zip(homes) {
            if place.is_none() {
                let (next, end) = (
                    &mut next[*level as usize],
                    self.first_slots[*level as usize + 1],
                );
                while *next < end && kept[*next as usize] {
                    *next += 1;
                }
                if *next == end {
                    return None;
                }
                *place = Some(*next);
                *next += 1;
            }
        }
        let before = self.slots.clone();
        for slot in &mut self.slots {
            *slot = Slot {
                level: slot.level,
                ..Slot::default()
            };
        }
        self.by_home.retain(|_, slot| kept[*slot as usize]);
        for (slot, (home, level, finest)) in found.iter().flatten().zip(homes) {
            let old = before[*slot as usize];
            let is_same = old.used && old.home == *home;
            self.slots[*slot as usize] = Slot {
                home: *home,
                level: *level as u8,
                finest: *finest as u8,
                used: true,
                // Until a frame has shown them, probes stay new.
                fresh: !is_same || old.fresh,
                touched: is_same && (old.touched || old.finest != *finest as u8),
            };
            if !is_same {
                self.by_home.insert(*home, *slot);
            }
        }
        for (slot, old) in self.slots.iter_mut().zip(&before) {
            // Its place must be cleared.
            slot.fresh |= !slot.used && (old.used || old.fresh);
        }
        self.build_cells(division);
        let is_changed = |slot: &&Slot| slot.fresh || slot.touched;
        self.fresh = self.slots.iter().filter(is_changed).count() as u32;
        Some(self.fresh > 0)
    }

    fn build_cells(&mut self, division: &Division) {
        self.cells.clear();
        if self.spec.source {
            return;
        }
        let points = self.points();
        let mut slots = vec![0u32; points.count()];
        for (home, slot) in &self.by_home {
            slots[points.number(*home / self.step)] = *slot;
        }
        let mut divided: FxHashMap<(u32, IVec3), u32> = FxHashMap::default();
        for (level, cells) in division.by_level(self.roots) {
            for cell in cells {
                let number = self.cells.len() as u32;
                let corners = std::array::from_fn(|corner| {
                    let point = (cell + corner_offset(corner as u32)) << level;
                    slots[points.number(point)]
                });
                if division.is_divided(level, cell) {
                    divided.insert((level, cell), number);
                }
                self.cells.push(Cell {
                    children: 0,
                    borders: division.borders(self.roots, level, cell),
                    corners,
                });
                if level < self.spec.depth && (cell & 1) == IVec3::ZERO {
                    let parent = divided[&(level + 1, cell >> 1)];
                    self.cells[parent as usize].children = number;
                }
            }
        }
    }

    /// Ends the frame in which probes were new.
    pub fn settle_down(&mut self) {
        for slot in &mut self.slots {
            (slot.fresh, slot.touched) = (false, false);
        }
        self.fresh = 0;
    }

    /// Probes that are new, gone, or corners of new cells since the last call of [`settle_down`](Self::settle_down).
    pub fn fresh(&self) -> u32 {
        self.fresh
    }

    pub fn spec(&self) -> &OctreeSpec {
        &self.spec
    }

    /// Slots, spare ones included.
    pub fn slots(&self) -> u32 {
        self.slots.len() as u32
    }

    /// Slots that have a probe.
    pub fn probes(&self) -> u32 {
        self.by_home.len() as u32
    }

    /// Whether a slot is not spare.
    pub fn has_probe(&self, slot: u32) -> bool {
        self.slots[slot as usize].used
    }

    /// First slot of a level, or the end of the last one.
    pub fn first_slot(&self, level: u32) -> u32 {
        self.first_slots[level as usize]
    }

    pub(super) fn level_of(&self, slot: u32) -> usize {
        usize::from(self.slots[slot as usize].level)
    }

    pub fn position(&self, slot: u32) -> Vec3 {
        (self.anchor + self.slots[slot as usize].home).as_vec3() + 0.5
    }
}

#[cfg(test)]
mod tests;
