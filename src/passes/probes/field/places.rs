//! Where the probes of a field are, from frame to frame: volumes that follow the camera, and octrees that voxels divide.

use glam::{IVec3, Vec3};

use super::ProbeField;
use crate::{gpu::Gpu, probes::Octree, world::voxels::Voxels};

impl ProbeField {
    /// Moves a volume that follows the camera, before frame `frame`. Returns whether the move discards the light
    /// of all probes; the next frame then counts as the first.
    pub fn follow(&mut self, eye_ws: Vec3, frame: u64) -> bool {
        if self.volume.octree().is_some() {
            return false;
        }
        self.motion.follow(&mut self.volume, eye_ws, frame)
    }

    /// Divides an octree again where voxels have changed (grid space, both ends inclusive), before the next frame.
    pub fn regrow(&mut self, gpu: &Gpu, voxels: &Voxels, first: IVec3, last: IVec3) {
        self.end_growth(gpu);
        if let Some(octree) = self.volume.octree_mut()
            && octree.regrow(voxels, first, last)
        {
            self.tree.write(gpu, octree);
        }
    }

    /// Before each frame: probes of an octree that the last frame has shown are not new any more.
    pub fn end_growth(&mut self, gpu: &Gpu) {
        if self.shows_growth
            && let Some(octree) = self.volume.octree_mut()
        {
            octree.settle_down();
            self.tree.write(gpu, octree);
            self.shows_growth = false;
        }
    }

    /// Probes that are new since the last move, or since an edit changed an octree.
    pub fn fresh(&self) -> u32 {
        self.volume
            .octree()
            .map_or(self.motion.fresh(), Octree::fresh)
    }

    /// Whether passes `probes/classify` and `probes/visibility` must run in this frame: probes are new, have moved, or
    /// are near an edit.
    pub fn misplaced(&self) -> bool {
        self.update_schedule.places_all()
            || self.changes.shown_first().is_some()
            || self.fresh() > 0
    }

    /// Notes that those passes have been recorded.
    pub fn set_placed(&mut self) {
        self.update_schedule.set_placed();
        self.shows_growth = self
            .volume
            .octree()
            .is_some_and(|octree| octree.fresh() > 0);
    }
}
