//! The uniform volume: probes on a regular lattice.

use glam::{UVec3, Vec3};

use super::{Layout, ProbeError};
use crate::world::LayoutSpec;
use crate::world::scenery::MAX_PROBES;

/// Most probes of one volume.
pub const MAX_SLOTS: u32 = MAX_PROBES;

/// Lattice point (x, y, z) has slot x + counts.x · (y + counts.y · z) and lies at
/// first + (x, y, z) · spacing; its probe stands at the centre of the voxel that contains it.
/// Interpolation weights are those of the regular lattice. `shaders/probes/volume.wesl` does the
/// same on the GPU.
#[derive(Clone, Debug, PartialEq)]
pub struct Volume {
    counts: UVec3,
    spacing: Vec3,
    /// World-space position of lattice point (0, 0, 0).
    first: Vec3,
}

impl Volume {
    /// # Errors
    /// [`ProbeError`] for counts of 0, too many probes, or numbers that are not finite.
    pub fn new(spec: &LayoutSpec) -> Result<Self, ProbeError> {
        let layout = || spec.name.clone();
        if spec.counts.min_element() == 0 {
            let counts = spec.counts.to_string();
            return Err(ProbeError::NoProbes {
                layout: layout(),
                counts,
            });
        }
        if !spec.spacing.is_finite() || spec.spacing.min_element() <= 0.0 {
            let spacing = spec.spacing.to_string();
            return Err(ProbeError::Spacing {
                layout: layout(),
                spacing,
            });
        }
        if !spec.centre.is_finite() {
            let centre = spec.centre.to_string();
            return Err(ProbeError::Centre {
                layout: layout(),
                centre,
            });
        }
        let slots = spec
            .counts
            .to_array()
            .map(u64::from)
            .iter()
            .fold(1u64, |a, b| a.saturating_mul(*b));
        if slots > u64::from(MAX_SLOTS) {
            return Err(ProbeError::TooMany {
                layout: layout(),
                slots,
                most: MAX_SLOTS,
            });
        }
        Ok(Self {
            counts: spec.counts,
            spacing: spec.spacing,
            first: spec.centre - (spec.counts - 1).as_vec3() * 0.5 * spec.spacing,
        })
    }

    pub fn counts(&self) -> UVec3 {
        self.counts
    }

    /// Distance between neighbouring lattice points (voxels).
    pub fn spacing(&self) -> Vec3 {
        self.spacing
    }

    /// World-space position of lattice point (0, 0, 0).
    pub fn first(&self) -> Vec3 {
        self.first
    }

    /// The farthest that a probe can be from a point of its own cage (voxels).
    pub fn cage_diagonal(&self) -> f32 {
        self.spacing.length()
    }

    fn slot(&self, index: UVec3) -> u32 {
        index.x + self.counts.x * (index.y + self.counts.y * index.z)
    }
}

impl Layout for Volume {
    fn slots(&self) -> u32 {
        self.counts.element_product()
    }

    fn position(&self, slot: u32) -> Vec3 {
        let row = slot / self.counts.x;
        let index = UVec3::new(
            slot % self.counts.x,
            row % self.counts.y,
            row / self.counts.y,
        );
        (self.first + index.as_vec3() * self.spacing).floor() + 0.5
    }

    /// Trilinear; points outside the volume get the weights of the nearest point on its border.
    fn cage(&self, point_ws: Vec3) -> [(u32, f32); 8] {
        let last = self.counts - 1;
        let place = ((point_ws - self.first) / self.spacing).clamp(Vec3::ZERO, last.as_vec3());
        // The last lattice point belongs to the cage before it, but a count of 1 has only one.
        let base = place.as_uvec3().min(last.saturating_sub(UVec3::ONE));
        let along = place - base.as_vec3();
        std::array::from_fn(|corner| {
            let offset = UVec3::new(
                corner as u32 & 1,
                corner as u32 >> 1 & 1,
                corner as u32 >> 2,
            );
            let weights = Vec3::select(offset.cmpeq(UVec3::ONE), along, 1.0 - along);
            (
                self.slot((base + offset).min(last)),
                weights.element_product(),
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn spec(counts: UVec3, spacing: Vec3, centre: Vec3) -> LayoutSpec {
        LayoutSpec {
            name: "test".into(),
            counts,
            spacing,
            centre,
        }
    }

    fn volume(counts: [u32; 3], spacing: f32) -> Volume {
        Volume::new(&spec(counts.into(), Vec3::splat(spacing), Vec3::ZERO)).expect("a good layout")
    }

    #[test]
    fn probes_stand_at_voxel_centres_around_the_centre() {
        let volume = volume([3, 1, 2], 9.0);
        assert_eq!(volume.slots(), 6);
        assert_eq!(volume.position(0), Vec3::new(-8.5, 0.5, -4.5));
        assert_eq!(volume.position(5), Vec3::new(9.5, 0.5, 4.5));
        for slot in 0..volume.slots() {
            assert_eq!(volume.position(slot).fract_gl(), Vec3::splat(0.5));
        }
    }

    #[test]
    fn bad_layouts_say_what_is_wrong() {
        let bad = |counts: UVec3, spacing: f32, centre: f32| {
            Volume::new(&spec(counts, Vec3::splat(spacing), Vec3::splat(centre)))
                .expect_err("must be refused")
                .to_string()
        };
        assert!(bad(UVec3::new(3, 0, 3), 1.0, 0.0).contains("at least 1"));
        assert!(bad(UVec3::ONE, f32::NAN, 0.0).contains("spacing"));
        assert!(bad(UVec3::ONE, -1.0, 0.0).contains("spacing"));
        assert!(bad(UVec3::ONE, 1.0, f32::INFINITY).contains("centre"));
        assert!(bad(UVec3::splat(u32::MAX), 1.0, 0.0).contains("at most"));
    }

    #[test]
    fn a_lattice_point_has_its_own_probe_alone() {
        let volume = volume([4, 3, 5], 2.0);
        for slot in 0..volume.slots() {
            let index = UVec3::new(slot % 4, slot / 4 % 3, slot / 12);
            let point = volume.first() + index.as_vec3() * volume.spacing();
            let own: f32 = volume
                .cage(point)
                .iter()
                .filter(|c| c.0 == slot)
                .map(|c| c.1)
                .sum();
            assert!((own - 1.0).abs() < 1e-5, "slot {slot}: {own}");
        }
    }

    proptest! {
        #[test]
        fn cage_weights_are_a_partition_of_one(
            counts in prop::array::uniform3(1u32..6),
            spacing in 0.5f32..20.0,
            point in prop::array::uniform3(-200.0f32..200.0),
        ) {
            let volume = volume(counts, spacing);
            let cage = volume.cage(point.into());
            prop_assert!(cage.iter().all(|&(slot, w)| slot < volume.slots() && (0.0..=1.0).contains(&w)));
            prop_assert!((cage.iter().map(|c| c.1).sum::<f32>() - 1.0).abs() < 1e-5);
        }

        /// Inside the volume the weights reproduce the point from the lattice: they are trilinear.
        #[test]
        fn cage_weights_reproduce_linear_fields(
            counts in prop::array::uniform3(2u32..6),
            spacing in 0.5f32..20.0,
            part in prop::array::uniform3(0.0f32..1.0),
        ) {
            let volume = volume(counts, spacing);
            let extent = (volume.counts() - 1).as_vec3() * spacing;
            let point = volume.first() + Vec3::from(part) * extent;
            let mean: Vec3 = volume.cage(point).iter().map(|&(slot, w)| {
                let index = UVec3::new(
                    slot % counts[0],
                    slot / counts[0] % counts[1],
                    slot / (counts[0] * counts[1]),
                );
                (volume.first() + index.as_vec3() * spacing) * w
            }).sum();
            prop_assert!(mean.distance(point) < 1e-3 * spacing);
        }
    }
}
