//! Cells into which a world is divided, for what is known about its lamps in each part of it.

use glam::UVec3;

/// Cubes of voxels that cover a world.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cells {
    /// Along each axis.
    pub count: UVec3,
    /// log2 of the voxels along a cell.
    pub shift: u32,
}

/// The cells that know which lamps are seen from them: the smallest (log2 of their voxels), and how many at most.
const LEAST_SHIFT: u32 = 3;
const MOST_CELLS: u64 = 1 << 18;

impl Cells {
    /// Those of 2^`shift` voxels along each axis that cover `size` voxels.
    pub fn covering(size: UVec3, shift: u32) -> Self {
        Self {
            count: (size + ((1 << shift) - 1)) >> UVec3::splat(shift),
            shift,
        }
    }

    /// Those that know which lamps are seen from them, in a world of `size` voxels.
    pub fn of_sight(size: UVec3) -> Self {
        (LEAST_SHIFT..31)
            .map(|shift| Self::covering(size, shift))
            .find(|cells| cells.number() <= MOST_CELLS)
            .unwrap_or(Self::covering(size, 31))
    }

    /// All of them.
    pub fn number(self) -> u64 {
        self.count.to_array().map(u64::from).iter().product()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_of_sight_are_as_fine_as_there_is_room_for() {
        assert_eq!(Cells::of_sight(UVec3::new(512, 256, 512)).shift, 3);
        assert_eq!(Cells::of_sight(UVec3::splat(1024)).shift, 4);
        let small = Cells::of_sight(UVec3::new(9, 8, 1));
        assert_eq!((small.count, small.shift), (UVec3::new(2, 1, 1), 3));
        assert_eq!(small.number(), 2);
    }
}
