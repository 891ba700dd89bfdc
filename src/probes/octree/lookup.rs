//! The cells of an octree around a point, and the tree as shaders read it.

use glam::{IVec3, UVec3, Vec3};

use super::divide::{child, corner_offset};
use super::{
    CELL_FADE, CELL_ROWS, Cell, Octree, SLOT_FINEST_SHIFT, SLOT_FRESH, SLOT_TOUCHED, SLOT_USED,
    Slot,
};
use crate::probes::Level;

impl Octree {
    /// The lattices of the levels, the finest first. Only some of their points have probes.
    pub(in crate::probes) fn levels(&self) -> Vec<Level> {
        let whole = (self.roots << self.spec.depth).as_vec3() * self.step.as_vec3();
        let middle = self.anchor.as_vec3() + whole * 0.5;
        let level = |level: u32| {
            let counts = (self.roots << (self.spec.depth - level)) + 1;
            let spacing = (self.step << level).as_vec3();
            Level::still(counts, spacing, middle, self.first_slots[level as usize])
        };
        (0..=self.spec.depth).map(level).collect()
    }

    /// The cell of a level at this place (in cells of the level), if the tree has it.
    pub(super) fn cell_at(&self, level: u32, place: UVec3) -> Option<&Cell> {
        let up = self.spec.depth - level;
        let root = place >> up;
        let mut cell = self
            .cells
            .get((root.x + self.roots.x * (root.y + self.roots.y * root.z)) as usize)?;
        for down in (0..up).rev() {
            if cell.children == 0 {
                return None;
            }
            cell = &self.cells[(cell.children + child((place >> down) & 1)) as usize];
        }
        Some(cell)
    }

    /// How much of the light at a point a level gives, the probes of the level's cell there, and their weights; `None`
    /// where the level has no cell.
    pub(in crate::probes) fn cage(
        &self,
        level: u32,
        point_ws: Vec3,
    ) -> Option<(f32, [(u32, f32); 8])> {
        let counts = self.roots << (self.spec.depth - level);
        let size = (self.step << level).as_vec3();
        let place = ((point_ws - self.anchor.as_vec3()) / size).clamp(Vec3::ZERO, counts.as_vec3());
        let low = place.as_uvec3().min(counts - 1);
        let along = place - low.as_vec3();
        let cell = self.cell_at(level, low)?;
        let weights = std::array::from_fn(|corner| {
            let is_high = corner_offset(corner as u32).cmpeq(IVec3::ONE);
            let by_axis = Vec3::select(is_high, along, 1.0 - along);
            (cell.corners[corner], by_axis.element_product())
        });
        Some((share(cell.borders, along), weights))
    }

    /// The rows of the tree: slots, then cells. Slots: the voxel at the probe's place (world space), and a word.
    pub fn rows(&self) -> Vec<[u32; 4]> {
        let slot = |slot: &Slot| {
            let home = self.anchor + slot.home;
            let flags = [
                (slot.used, SLOT_USED),
                (slot.fresh, SLOT_FRESH),
                (slot.touched, SLOT_TOUCHED),
            ];
            let flags: u32 = flags
                .iter()
                .map(|(is_set, flag)| if *is_set { *flag } else { 0 })
                .sum();
            let levels = u32::from(slot.level) | u32::from(slot.finest) << SLOT_FINEST_SHIFT;
            [home.x as u32, home.y as u32, home.z as u32, levels | flags]
        };
        let mut rows: Vec<[u32; 4]> = self.slots.iter().map(slot).collect();
        for cell in &self.cells {
            let [a, b, c, d, e, f, g, h] = cell.corners;
            rows.extend([
                [cell.children, cell.borders, 0, 0],
                [a, b, c, d],
                [e, f, g, h],
            ]);
        }
        rows
    }

    /// Rows of the tree with the room for edits.
    pub fn most_rows(&self) -> u64 {
        u64::from(self.slots()) + u64::from(CELL_ROWS) * u64::from(self.cell_room)
    }
}

/// Share of a cell's light at a point between its corners: 1, falling to 0 towards places that have no cell of its
/// size. It depends on the distance to those places alone (the largest of the distances along the axes), so it is
/// continuous across cells.
fn share(borders: u32, along: Vec3) -> f32 {
    let is_high = along.cmpgt(Vec3::splat(0.5));
    let towards = IVec3::select(is_high, IVec3::ONE, IVec3::NEG_ONE);
    let apart = along.min(1.0 - along);
    let mut share = 1f32;
    for side in 1..8 {
        let axes = corner_offset(side);
        let step = towards * axes + 1;
        if borders >> (step.x + 3 * step.y + 9 * step.z) & 1 == 1 {
            share = share.min((apart * axes.as_vec3()).max_element() / CELL_FADE);
        }
    }
    share
}
