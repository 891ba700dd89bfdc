//! Which voxels each probe sees: an exact answer to whether a probe lights a surface.

use glam::{IVec3, UVec3, Vec3};

use super::{Level, Volume};
use crate::parameters::{ProbeParameters, Relocation, Visibility};

/// Largest box (voxels along an axis): with a border of one voxel its solid bits fit the smallest
/// workgroup memory that devices have.
const MOST_COUNT: u32 = 42;
/// Widest spacing whose box is complete.
const MOST_SPACING: u32 = (MOST_COUNT - 2) / 2;
/// Voxels of one word: see [`VisibilityBox`].
const BRICK: UVec3 = UVec3::new(1 << BRICK_LOG2[0], 1 << BRICK_LOG2[1], 1 << BRICK_LOG2[2]);

crate::shared! {
    in probes;

    /// log2 of the voxels along each axis of a brick, whose bits are one word.
    const BRICK_LOG2: [u32; 3] = [2, 2, 1];

    /// Two words for each row of the largest box with a border of one voxel.
    use 2 * (MOST_COUNT + 2) * (MOST_COUNT + 2) => MOST_SOLID: u32;
}

/// The box of voxels around a lattice point that its cages reach, or as much of it as there is room for:
/// see [`Self::reach`]. All probes of one level have boxes of the same size. A probe
/// has one bit for each voxel of the box, set if the voxel is air, borders on a solid voxel, and sees
/// the probe from its centre. One word holds the bits of a brick of 4×4×2 voxels, so that the bits of
/// neighbouring voxels mostly share a word. The words of a probe are ordered along x, then y, then z;
/// the probes of a level are ordered by slot. `shaders/probes/visibility_bits.wesl` reads the bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VisibilityBox {
    /// Voxels along the axes.
    pub counts: UVec3,
    /// First word of the level's first slot.
    pub first_word: u32,
}

impl VisibilityBox {
    fn new(level: &Level, first_word: u32) -> Self {
        let counts = (2.0 * Self::reach(level.spacing())).ceil() + 2.0;
        Self {
            counts: counts.as_uvec3(),
            first_word,
        }
    }

    /// How far a box reaches from its lattice point (voxels): to the end of the cages, but not more than 20
    /// voxels. Where cages are larger, the gather looks at points farther off by marching.
    pub fn reach(spacing: Vec3) -> Vec3 {
        spacing.min(Vec3::splat(MOST_SPACING as f32))
    }

    /// Bricks along the axes.
    pub fn bricks(&self) -> UVec3 {
        (self.counts + BRICK - 1) / BRICK
    }

    /// Words of one probe.
    pub fn words(&self) -> u32 {
        self.bricks().element_product()
    }

    /// Place of a voxel's bit: its word, counted from the probe's first, and the bit in that word. The
    /// voxel is counted from the box's first.
    pub fn place(&self, voxel: UVec3) -> (u32, u32) {
        let (bricks, brick, within) = (self.bricks(), voxel / BRICK, voxel % BRICK);
        let word = brick.x + bricks.x * (brick.y + bricks.y * brick.z);
        (word, within.x + 4 * within.y + 16 * within.z)
    }

    /// The box's first voxel (world space) around a lattice point.
    pub fn corner(lattice_ws: Vec3, spacing: Vec3) -> IVec3 {
        (lattice_ws - Self::reach(spacing) - 0.5).floor().as_ivec3()
    }
}

/// Layout of the visibility bits of a volume's probes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct VisibilityBits {
    boxes: Vec<VisibilityBox>,
    lattice_words: u32,
    back_side: bool,
    is_cut: bool,
}

impl VisibilityBits {
    /// `None` if visibility is not exact. By default all volumes have exact visibility, except nested levels that
    /// follow the camera, where it would take a third of the frame.
    ///
    /// In a volume of one level, each probe has a back-side probe for the surfaces that it does not see, if
    /// probes may leave the lattice. In a volume of several levels, the coarser levels cover what the finer
    /// ones miss.
    pub fn new(volume: &Volume, parameters: &ProbeParameters) -> Option<Self> {
        let is_requested = match parameters.visibility {
            Visibility::Exact => true,
            Visibility::Auto => volume.levels().len() == 1 || !volume.moves(),
            Visibility::Chebyshev => false,
        };
        if !is_requested {
            return None;
        }
        let moves = parameters.relocation == Relocation::Exact;
        let octree = volume.octree();
        if octree.is_some_and(|octree| octree.spec().source) {
            return None;
        }
        let back_side = (volume.levels().len() == 1 || octree.is_some()) && moves;
        let mut words = 0u64;
        let mut boxes = Vec::new();
        for (index, level) in volume.levels().iter().enumerate() {
            let seen = VisibilityBox::new(level, u32::try_from(words).ok()?);
            words += u64::from(volume.slots_of_level(index)) * u64::from(seen.words());
            boxes.push(seen);
        }
        let is_cut = |level: &Level| VisibilityBox::reach(level.spacing()) != level.spacing();
        Some(Self {
            boxes,
            lattice_words: u32::try_from(words).ok()?,
            back_side,
            is_cut: octree.is_some() || volume.levels().iter().any(is_cut),
        })
    }

    /// The box of each level.
    pub fn boxes(&self) -> &[VisibilityBox] {
        &self.boxes
    }

    /// Words of the lattice's own probes; those of their back-side probes follow, in the same order.
    pub fn lattice_words(&self) -> u32 {
        self.lattice_words
    }

    /// Whether each probe has a second slot for its back-side probe.
    pub fn back_side(&self) -> bool {
        self.back_side
    }

    /// Whether a probe lights points outside of its box: cages are larger, or coarse probes are corners of fine cells.
    pub fn is_cut(&self) -> bool {
        self.is_cut
    }

    /// Memory of the bits of all probes.
    pub fn bytes(&self) -> u64 {
        4 * u64::from(self.lattice_words) * if self.back_side { 2 } else { 1 }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;
    use crate::world::LayoutSpec;

    /// Of a volume that follows the camera if it has several levels.
    fn visibility_bits(spacing: f32, cascades: u32) -> Option<VisibilityBits> {
        visibility_by(Visibility::Exact, &spec(spacing, cascades))
    }

    fn spec(spacing: f32, cascades: u32) -> LayoutSpec {
        LayoutSpec {
            name: "test".into(),
            counts: UVec3::splat(4),
            spacing: Vec3::splat(spacing),
            centre: Vec3::ZERO,
            follow: cascades > 1,
            cascades,
            octree: None,
        }
    }

    fn visibility_by(visibility: Visibility, spec: &LayoutSpec) -> Option<VisibilityBits> {
        let parameters = ProbeParameters {
            visibility,
            ..Default::default()
        };
        let volume = Volume::new(spec).expect("a good layout");
        VisibilityBits::new(&volume, &parameters)
    }

    #[test]
    fn the_box_holds_every_voxel_of_the_cages_and_their_neighbours() {
        for (spacing, lattice) in [(4.0, 0.5), (3.5, -0.25), (18.0, 7.0), (0.3, 2.9)] {
            let counts = visibility_bits(spacing, 1).expect("small enough").boxes()[0].counts;
            let corner = VisibilityBox::corner(Vec3::splat(lattice), Vec3::splat(spacing));
            let last = corner + counts.as_ivec3() - 1;
            let reach = spacing + 0.5;
            assert!(corner.x as f32 <= lattice - reach);
            // Neighbours count from half a voxel.
            assert!(
                last.x >= (lattice + reach - 1e-3).floor() as i32,
                "{spacing} {lattice}"
            );
        }
    }

    #[test]
    fn every_voxel_of_a_box_has_a_bit_of_its_own() {
        let seen = visibility_bits(3.5, 1).expect("small enough").boxes()[0];
        let n = seen.counts;
        let places: HashSet<(u32, u32)> = (0..n.element_product())
            .map(|i| seen.place(UVec3::new(i % n.x, i / n.x % n.y, i / n.x / n.y)))
            .collect();
        assert_eq!(places.len() as u32, n.element_product());
        assert!(
            places
                .iter()
                .all(|(word, bit)| *word < seen.words() && *bit < 32)
        );
    }

    #[test]
    fn back_side_probes_follow_all_levels() {
        let three = visibility_bits(2.0, 3).expect("small enough");
        // 6, 10 and 18 voxels along an axis.
        let words = [2 * 2 * 3, 3 * 3 * 5, 5 * 5 * 9];
        assert_eq!(
            three
                .boxes()
                .iter()
                .map(VisibilityBox::words)
                .collect::<Vec<_>>(),
            words
        );
        let firsts: Vec<u32> = three.boxes().iter().map(|b| b.first_word).collect();
        assert_eq!(firsts, [0, 64 * 12, 64 * (12 + 45)]);
        assert_eq!(three.bytes(), 4 * 64 * (12 + 45 + 225));
        assert!(!three.back_side());
        let one = visibility_bits(2.0, 1).expect("small enough");
        assert_eq!(one.bytes(), 2 * 4 * 64 * 12);
    }

    #[test]
    fn visibility_is_exact_by_default_but_for_levels_around_a_camera() {
        let still = LayoutSpec {
            follow: false,
            ..spec(2.0, 3)
        };
        let one = LayoutSpec {
            follow: true,
            ..spec(2.0, 1)
        };
        for volume in [&spec(2.0, 1), &spec(36.0, 1), &one, &still] {
            assert!(visibility_by(Visibility::Auto, volume).is_some());
            assert_eq!(visibility_by(Visibility::Chebyshev, volume), None);
        }
        assert_eq!(visibility_by(Visibility::Auto, &spec(2.0, 2)), None);
        assert!(visibility_by(Visibility::Exact, &spec(2.0, 2)).is_some());
    }

    #[test]
    fn boxes_of_large_cages_are_cut_off() {
        let whole = visibility_bits(20.0, 1).expect("exact");
        assert_eq!(whole.boxes()[0].counts, UVec3::splat(MOST_COUNT));
        assert!(!whole.is_cut());
        let cut = visibility_bits(36.0, 1).expect("exact");
        assert_eq!(cut.boxes()[0].counts, UVec3::splat(MOST_COUNT));
        assert!(cut.is_cut());
        // The coarsest counts.
        assert!(!visibility_bits(5.0, 3).expect("exact").is_cut());
        assert!(visibility_bits(5.2, 3).expect("exact").is_cut());
    }
}
