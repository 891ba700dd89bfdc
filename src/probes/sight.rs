//! What each probe sees, voxel by voxel: the exact answer to whether a probe lights a surface.

use glam::{IVec3, UVec3, Vec3};

use super::Volume;
use crate::parameters::{ProbeParameters, Relocation, Visibility};

/// Largest box (voxels along an axis): with a border of one voxel its rows fit words of 32 bits.
const MOST_COUNT: u32 = 30;

/// The box of voxels around a lattice point that its cages reach. A probe has one bit for each of
/// them, set where the voxel is air beside stone and its centre sees the probe. A row of voxels along
/// x is one u32, its first voxel in the lowest bit; rows follow each other along y, then z.
/// `shaders/probes/sight.wesl` reads the bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sight {
    /// Voxels along the axes of the box.
    pub counts: UVec3,
}

impl Sight {
    /// `None` where visibility is not to be exact, where cages are too large for it (more than 14
    /// voxels along an axis), and where the volume moves, has several levels, or probes walk: what is
    /// kept would soon be that of another place.
    pub fn new(volume: &Volume, parameters: &ProbeParameters) -> Option<Self> {
        let [level] = volume.levels() else {
            return None;
        };
        let counts = (2.0 * level.spacing()).ceil() + 2.0;
        let fits = counts.max_element() <= MOST_COUNT as f32;
        let walk = parameters.relocation == Relocation::Statistical;
        (parameters.visibility == Visibility::Exact && fits && !walk && !volume.moves()).then(
            || Self {
                counts: counts.as_uvec3(),
            },
        )
    }

    /// Words of one probe.
    pub fn words(&self) -> u32 {
        self.counts.y * self.counts.z
    }

    /// The box's first voxel (world space) around a lattice point.
    pub fn corner(lattice_ws: Vec3, spacing: Vec3) -> IVec3 {
        (lattice_ws - spacing - 0.5).floor().as_ivec3()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::LayoutSpec;

    fn sight(spacing: f32) -> Option<Sight> {
        let spec = LayoutSpec {
            name: "test".into(),
            counts: UVec3::splat(2),
            spacing: Vec3::splat(spacing),
            centre: Vec3::ZERO,
            follow: false,
            cascades: 1,
        };
        let parameters = ProbeParameters {
            visibility: Visibility::Exact,
            ..Default::default()
        };
        Sight::new(&Volume::new(&spec).expect("a good layout"), &parameters)
    }

    #[test]
    fn the_box_holds_every_voxel_of_the_cages_and_their_neighbours() {
        for (spacing, lattice) in [(4.0, 0.5), (3.5, -0.25), (14.0, 7.0), (0.3, 2.9)] {
            let counts = sight(spacing).expect("small enough").counts;
            let corner = Sight::corner(Vec3::splat(lattice), Vec3::splat(spacing));
            let last = corner + counts.as_ivec3() - 1;
            let reach = spacing + 0.5;
            assert!(corner.x as f32 <= lattice - reach);
            // Neighbours count from half a voxel on.
            assert!(
                last.x >= (lattice + reach - 1e-3).floor() as i32,
                "{spacing} {lattice}"
            );
        }
    }

    #[test]
    fn large_cages_have_none() {
        assert!(sight(14.0).is_some());
        assert_eq!(sight(14.6), None);
    }
}
