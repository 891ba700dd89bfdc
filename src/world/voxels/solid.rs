//! Which voxels are solid, and nothing else: what a frame keeps of the CPU's copy.

use glam::IVec3;

use super::{BRICK, CELL, Edit, SOLID, UNIFORM, Voxels, grid_cells};

/// The grid's words and the masks of a brick map: a ninth of what it takes with its materials.
#[derive(Clone, Debug, PartialEq)]
pub struct SolidVoxels {
    size: IVec3,
    /// log2 of the cells along x, and along x and y.
    shifts: [u32; 2],
    grid: Vec<u32>,
    masks: Vec<[u32; 16]>,
}

impl SolidVoxels {
    pub fn of(voxels: &Voxels) -> Self {
        let (grid, masks, _) = voxels.raw();
        let bits = grid_cells(voxels.size).map(u32::trailing_zeros);
        Self {
            size: voxels.size.as_ivec3(),
            shifts: [bits.x, bits.x + bits.y],
            grid: grid.to_vec(),
            masks: masks.to_vec(),
        }
    }

    /// Follows an edit of the voxels that these are a copy of.
    pub fn follow(&mut self, voxels: &Voxels, edit: &Edit) {
        let (grid, masks, _) = voxels.raw();
        for range in &edit.grid {
            self.grid[range.clone()].copy_from_slice(&grid[range.clone()]);
        }
        self.masks.resize(masks.len(), [0; 16]);
        for range in &edit.bricks {
            self.masks[range.clone()].copy_from_slice(&masks[range.clone()]);
        }
    }

    /// Whether a voxel (grid space) is solid. None is outside of the world.
    pub fn is_solid(&self, voxel: IVec3) -> bool {
        if voxel.cmplt(IVec3::ZERO).any() || voxel.cmpge(self.size).any() {
            return false;
        }
        let voxel = voxel.as_uvec3();
        let cell = voxel / CELL;
        let word =
            self.grid[(cell.x | cell.y << self.shifts[0] | cell.z << self.shifts[1]) as usize];
        if word & SOLID == 0 || word & UNIFORM != 0 {
            return word & SOLID != 0;
        }
        let half = (voxel >> 2u32) & 1;
        let low = voxel & 3;
        let bit = low.x | low.y << 2 | low.z << 4;
        let mask = 2 * (half.x | half.y << 1 | half.z << 2) + bit / 32;
        self.masks[(word & BRICK) as usize][mask as usize] >> (bit % 32) & 1 != 0
    }
}

#[cfg(test)]
mod tests {
    use glam::{UVec3, Vec3};

    use super::*;

    /// Whether both say the same of every voxel, and of some outside.
    fn agree(solid: &SolidVoxels, voxels: &Voxels) -> bool {
        let size = voxels.size().as_ivec3();
        let mut all = (-2..size.z + 2)
            .flat_map(|z| (-2..size.y + 2).map(move |y| (y, z)))
            .flat_map(|(y, z)| (-2..size.x + 2).map(move |x| IVec3::new(x, y, z)));
        all.all(|at| solid.is_solid(at) == (voxels.material(at) != 0))
    }

    #[test]
    fn a_copy_knows_what_is_solid_and_follows_edits() {
        let mut voxels = Voxels::empty(UVec3::new(37, 20, 50));
        voxels.fill_box(IVec3::new(3, 2, 1), IVec3::new(30, 17, 40), 1);
        voxels.fill_sphere(Vec3::new(12.3, 9.1, 20.7), 6.5, 0);
        let mut solid = SolidVoxels::of(&voxels);
        assert!(agree(&solid, &voxels));
        for (centre, radius, material) in [
            (Vec3::new(33.0, 10.0, 44.0), 5.0, 2),
            (Vec3::new(12.0, 9.0, 20.0), 3.0, 1),
            (Vec3::new(20.0, 10.0, 25.0), 12.0, 0),
            (Vec3::new(1.0, 1.0, 1.0), 4.0, 3),
        ] {
            let edit = voxels.fill_sphere(centre, radius, material);
            let before = solid.clone();
            solid.follow(&voxels, &edit);
            assert!(agree(&solid, &voxels), "{centre}");
            // The comparator: without following, the copy is wrong.
            assert!(!agree(&before, &voxels), "{centre}");
        }
    }
}
