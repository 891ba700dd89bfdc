//! Features (mushrooms and the like): boxes of voxels that are stamped into the air.

use glam::IVec3;

/// One box of a feature, in world-space voxels, both ends inclusive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FeaturePart {
    pub min: IVec3,
    pub max: IVec3,
    /// 1-based index into the world's materials.
    pub material: u8,
    /// The four vertical edge columns of the box stay air (a 5×5 cap without its corners).
    pub without_corners: bool,
}

impl FeaturePart {
    /// Whether the part fills this world-space voxel.
    pub fn contains(&self, voxel: IVec3) -> bool {
        let inside = voxel.cmpge(self.min).all() && voxel.cmple(self.max).all();
        let on_x_side = voxel.x == self.min.x || voxel.x == self.max.x;
        let on_z_side = voxel.z == self.min.z || voxel.z == self.max.z;
        inside && !(self.without_corners && on_x_side && on_z_side)
    }
}
