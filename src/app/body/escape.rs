//! The way out of stone, and out of the way of moving bodies. Edits, a world that is read again, or a start in a wall can
//! put a body into stone.

use glam::I64Vec3;

use super::{Body, Mode, sweep::ONE, terrain::Terrain, to_units};

/// Voxels that the search goes in each direction at most.
const FARTHEST: i64 = 12;
/// What bears the body may sink by this much in a step (metres of the player), and the body stays on it.
const SINKING_M: f64 = 0.25;

impl Body {
    /// Stays on what it rides, and gives way to what has moved into it.
    pub(super) fn follow_obstacles(&mut self, terrain: &impl Terrain) {
        if self.mode == Mode::NoClip {
            return;
        }
        let deepest = -to_units(SINKING_M * self.measures.scale);
        if self.rides {
            let sunk = terrain.in_the_way().sweep(&self.shape(), 1, deepest);
            if sunk != deepest && self.shape().sweep_voxels(terrain, 1, sunk) == sunk {
                self.feet.y += sunk;
            }
        }
        if terrain.in_the_way().overlaps(&self.shape()) {
            self.give_way(terrain);
        }
    }

    /// Moves along one axis until no moving body is in the box: the shortest way without a wall in between, and up if
    /// another is as short. Where there is none, the box stays.
    fn give_way(&mut self, terrain: &impl Terrain) {
        let shape = self.shape();
        let longest = self.measures.height + ONE;
        let ways = [(1, 1), (0, 1), (0, -1), (2, 1), (2, -1), (1, -1)];
        let ways = ways.into_iter().filter_map(|(axis, sign)| {
            let way = sign * terrain.in_the_way().way_out(&shape, axis, sign, longest)?;
            (shape.sweep_voxels(terrain, axis, way) == way).then_some((axis, way))
        });
        if let Some((axis, way)) = ways.min_by_key(|(_, way)| way.abs()) {
            self.feet[axis] += way;
            // What pushes the body also stops it.
            if self.velocity[axis] * (way as f64) < 0.0 {
                self.velocity[axis] = 0.0;
            }
        }
    }

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
