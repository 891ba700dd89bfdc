//! Steps of the ground: up, down, and edges that a body which sneaks does not leave.

use glam::I64Vec3;

use super::{Body, sweep::to_voxels, terrain::Terrain};

impl Body {
    /// Slides over the ground. Where a step stops it that is low enough, it goes up instead.
    pub(super) fn slide_and_step_up(&mut self, terrain: &impl Terrain, way: I64Vec3) {
        let before = (self.feet, self.velocity);
        self.slide(terrain, way);
        let stopped = (self.feet, self.velocity);
        if stopped.0 == before.0 + way {
            return;
        }
        (self.feet, self.velocity) = before;
        let raised = self.shape().sweep(terrain, 1, self.measures.step_up);
        self.feet.y += raised;
        self.slide(terrain, way);
        self.feet.y += self.shape().sweep(terrain, 1, -raised);
        let progress = |feet: I64Vec3| (feet - before.0).with_y(0).length_squared();
        let climbed = self.feet.y - before.0.y;
        if climbed > 0 && progress(self.feet) > progress(stopped.0) {
            self.eye_lift -= to_voxels(climbed);
        } else {
            (self.feet, self.velocity) = stopped;
        }
    }

    /// Goes down a step that is low enough, and says whether there was one.
    pub(super) fn step_down(&mut self, terrain: &impl Terrain) -> bool {
        let deepest = self.measures.step_up;
        let drop = -self.shape().sweep(terrain, 1, -deepest);
        let lands = self
            .shape()
            .moved(I64Vec3::NEG_Y * drop)
            .is_supported(terrain);
        if lands {
            self.feet.y -= drop;
            self.eye_lift += to_voxels(drop);
        }
        lands
    }

    /// Shortens the way of a body that sneaks, so that a part of it stays above the ground.
    pub(super) fn stay_on_edges(&mut self, terrain: &impl Terrain, way: &mut I64Vec3) {
        let mut along = I64Vec3::ZERO;
        for axis in [0, 2] {
            let stands = |distance: i64| {
                let mut to = along;
                to[axis] = distance;
                self.shape().moved(to).is_supported(terrain)
            };
            let (mut held, mut lost) = (0, way[axis]);
            if stands(lost) {
                held = lost;
            }
            // A step is shorter than a voxel, so there is one edge.
            while (lost - held).abs() > 1 {
                let middle = held + (lost - held) / 2;
                if stands(middle) {
                    held = middle;
                } else {
                    lost = middle;
                }
            }
            if held != way[axis] {
                self.velocity[axis] = 0.0;
            }
            way[axis] = held;
            along[axis] = held;
        }
    }
}
