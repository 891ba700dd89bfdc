//! The way out of stone: edits, a world that is read again, or a start in a wall can put a body into it.

use glam::I64Vec3;

use super::{
    Body,
    sweep::{ONE, Terrain},
};

/// Voxels that the search goes in each direction at most.
const FARTHEST: i64 = 12;

impl Body {
    /// The nearest place with room for the body: straight up where that is possible, else in the middle of a
    /// voxel nearby, the higher of two that are equally far. `None` if there is none within two body heights.
    pub(super) fn nearest_room(&self, terrain: &impl Terrain) -> Option<I64Vec3> {
        let reach = (2 * self.measures.height / ONE + 2).min(FARTHEST);
        let has_room = |feet: &I64Vec3| !self.at(*feet).overlaps(terrain);
        let floor = self.feet & !(ONE - 1);
        let above =
            (0..=reach).map(|up| I64Vec3::new(self.feet.x, floor.y + up * ONE, self.feet.z));
        if let Some(feet) = above.filter(|feet| feet.y >= self.feet.y).find(has_room) {
            return Some(feet);
        }
        let middle = floor + I64Vec3::new(ONE / 2, 0, ONE / 2);
        let all = -reach..=reach;
        let mut offsets: Vec<I64Vec3> = all
            .clone()
            .flat_map(|y| all.clone().map(move |z| (y, z)))
            .flat_map(|(y, z)| all.clone().map(move |x| I64Vec3::new(x, y, z)))
            .collect();
        offsets.sort_by_key(|offset| (offset.length_squared(), -offset.y));
        let places = offsets.into_iter().map(|offset| middle + offset * ONE);
        places.into_iter().find(has_room)
    }
}
