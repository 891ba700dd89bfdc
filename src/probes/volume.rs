//! Volumes of probes: one lattice, or several nested ones, each twice as wide as the previous one.

use std::sync::Arc;

use glam::{IVec3, UVec3, Vec3};

use super::{Layout, Level, Octree, ProbeError};
use crate::world::scenery::{
    FARTHEST, LEAST_COUNT, LEAST_SPACING, MAX_CASCADES, MAX_DEPTH, MAX_PROBES,
};
use crate::world::{LayoutSpec, voxels::Voxels};

/// Maximum number of probes of one volume.
pub const MAX_SLOTS: u32 = MAX_PROBES;
/// Maximum number of levels of one volume; the shaders have room for as many.
pub const MAX_LEVELS: u32 = if MAX_CASCADES > MAX_DEPTH {
    MAX_CASCADES
} else {
    MAX_DEPTH + 1
};

/// Probes on the lattices of one or more [`Level`]s, the finest first. Each further level has twice the
/// spacing and the same number of probes. A volume that follows the camera moves each level by whole
/// cells. `shaders/probes/volume.wesl` does the same on the GPU.
#[derive(Clone, Debug, PartialEq)]
pub struct Volume {
    counts: UVec3,
    /// Offset of a moving volume's middle from the camera.
    offset: Option<Vec3>,
    levels: Vec<Level>,
    /// Which points of the levels have probes, where that is not all.
    octree: Option<Arc<Octree>>,
}

impl Volume {
    /// A moving volume lies around the origin until the first call of `follow`.
    ///
    /// # Errors
    /// [`ProbeError`] for counts of 0, or below [`LEAST_COUNT`] in nested and moving volumes; for too
    /// many probes or levels; for numbers that are not finite, and for extents beyond ±[`FARTHEST`].
    pub fn new(spec: &LayoutSpec) -> Result<Self, ProbeError> {
        let slots = check(spec)?;
        let moves = spec.follow;
        let levels = (0..spec.cascades).map(|level| {
            let spacing = spec.spacing * (1u32 << level) as f32;
            // Does not overflow: it is below the number of all slots.
            let first_slot = slots / spec.cascades * level;
            if moves {
                Level::moving(spec.counts, spacing, spec.centre, first_slot)
            } else {
                Level::still(spec.counts, spacing, spec.centre, first_slot)
            }
        });
        Ok(Self {
            counts: spec.counts,
            offset: moves.then_some(spec.centre),
            levels: levels.collect(),
            octree: None,
        })
    }

    /// The octree of a layout in the world of these voxels; `origin` is the world-space place of the first voxel.
    ///
    /// # Errors
    /// As [`Octree::new`].
    pub fn octree_of(
        layout: &LayoutSpec,
        voxels: &Voxels,
        origin: IVec3,
    ) -> Result<Self, ProbeError> {
        let octree = Octree::new(layout, voxels, origin)?;
        Ok(Self {
            counts: layout.counts,
            offset: None,
            levels: octree.levels(),
            octree: Some(Arc::new(octree)),
        })
    }

    /// The octree of the volume, if it is one.
    pub fn octree(&self) -> Option<&Octree> {
        self.octree.as_deref()
    }

    /// To divide an octree again.
    pub fn octree_mut(&mut self) -> Option<&mut Octree> {
        self.octree.as_mut().map(Arc::make_mut)
    }

    /// Number of probes: slots, less the spare ones of an octree.
    pub fn probes(&self) -> u32 {
        self.octree().map_or(self.slots(), Octree::probes)
    }

    /// Moves each level of a moving volume by whole cells, so that the camera at `eye_ws` is at its
    /// middle. Lattice points that remain in the window keep their slots.
    pub fn follow(&mut self, eye_ws: Vec3) {
        if let Some(offset) = self.offset {
            for level in &mut self.levels {
                level.move_to(eye_ws + offset);
            }
        }
    }

    /// Whether the volume moves with the camera.
    pub fn moves(&self) -> bool {
        self.offset.is_some()
    }

    /// Probes of each level along each axis.
    pub fn counts(&self) -> UVec3 {
        self.counts
    }

    /// The levels, the finest first; at least one, at most [`MAX_LEVELS`].
    pub fn levels(&self) -> &[Level] {
        &self.levels
    }

    /// Number of slots of each level of a volume without an octree.
    pub fn level_slots(&self) -> u32 {
        self.counts.element_product()
    }

    /// Number of slots of a level.
    pub fn slots_of_level(&self, level: usize) -> u32 {
        let level = level as u32;
        self.octree().map_or(self.level_slots(), |octree| {
            octree.first_slot(level + 1) - octree.first_slot(level)
        })
    }

    /// The level that a slot belongs to.
    pub fn level_of(&self, slot: u32) -> &Level {
        let level = self
            .octree()
            .map_or((slot / self.level_slots()) as usize, |octree| {
                octree.level_of(slot)
            });
        &self.levels[level]
    }

    /// Cells over which a level fades into the next one: `wanted`, but at most the distance from the
    /// level's middle to its edge.
    pub fn fade(&self, wanted: f32) -> f32 {
        wanted.min(self.levels[0].reach().min_element())
    }

    /// Number of slots whose lattice point differs from that in `before`, an earlier state of the same
    /// volume.
    pub fn fresh_since(&self, before: &Self) -> u32 {
        let levels = self.levels.iter().zip(&before.levels);
        levels.map(|(now, before)| now.fresh_since(before)).sum()
    }
}

/// The number of probes of a valid layout.
fn check(spec: &LayoutSpec) -> Result<u32, ProbeError> {
    let layout = || spec.name.clone();
    if spec.counts.min_element() == 0 {
        let counts = spec.counts.to_string();
        return Err(ProbeError::NoProbes {
            layout: layout(),
            counts,
        });
    }
    if !(1..=MAX_CASCADES).contains(&spec.cascades) {
        return Err(ProbeError::Cascades {
            layout: layout(),
            cascades: spec.cascades,
            most: MAX_CASCADES,
        });
    }
    let fades = spec.follow || spec.cascades > 1;
    if fades && spec.counts.min_element() < LEAST_COUNT {
        return Err(ProbeError::TooFew {
            layout: layout(),
            counts: spec.counts.to_string(),
            least: LEAST_COUNT,
        });
    }
    let spacing = spec.spacing;
    // Written so that NaN is refused.
    if !(spacing.min_element() >= LEAST_SPACING && spacing.max_element() <= FARTHEST) {
        return Err(ProbeError::Spacing {
            layout: layout(),
            spacing: spacing.to_string(),
            least: LEAST_SPACING,
            most: FARTHEST,
        });
    }
    if !spec.centre.is_finite() {
        let centre = spec.centre.to_string();
        return Err(ProbeError::Centre {
            layout: layout(),
            centre,
        });
    }
    let counts = spec.counts.to_array().map(u64::from);
    let slots = counts
        .iter()
        .fold(u64::from(spec.cascades), |a, b| a.saturating_mul(*b));
    if slots > u64::from(MAX_SLOTS) {
        return Err(ProbeError::TooMany {
            layout: layout(),
            slots,
            most: MAX_SLOTS,
        });
    }
    let coarsest = spacing.as_dvec3() * f64::from(1u32 << (spec.cascades - 1));
    let half = (spec.counts - 1).as_dvec3() * 0.5 * coarsest;
    let farthest = (spec.centre.as_dvec3().abs() + half).max_element();
    if farthest > f64::from(FARTHEST) {
        return Err(ProbeError::TooFar {
            layout: layout(),
            reach: farthest,
            most: FARTHEST,
        });
    }
    Ok(slots as u32)
}

impl Layout for Volume {
    fn slots(&self) -> u32 {
        let all = self.level_slots() * self.levels.len() as u32;
        self.octree().map_or(all, Octree::slots)
    }

    fn position(&self, slot: u32) -> Vec3 {
        if let Some(octree) = self.octree() {
            return octree.position(slot);
        }
        let level = self.level_of(slot);
        level.position(level.point(slot))
    }

    /// Trilinear in the finest level that contains the point; over the last cell of a level the next
    /// one takes over. Points outside all levels have the weights of the nearest point of the coarsest
    /// level.
    fn cage(&self, point_ws: Vec3) -> Vec<(u32, f32)> {
        let mut corners = Vec::new();
        let mut left = 1.0;
        if let Some(octree) = self.octree() {
            for level in 0..self.levels.len() as u32 {
                if left > 0.0
                    && let Some((share, cage)) = octree.cage(level, point_ws)
                {
                    corners.extend(cage.map(|(slot, weight)| (slot, weight * share * left)));
                    left *= 1.0 - share;
                }
            }
            return corners;
        }
        for (index, level) in self.levels.iter().enumerate() {
            let share = if index + 1 < self.levels.len() {
                left * level.share(point_ws, self.fade(1.0))
            } else {
                left
            };
            if share > 0.0 {
                let cage = level.cage(point_ws);
                corners.extend(cage.map(|(slot, weight)| (slot, weight * share)));
                left -= share;
            }
        }
        corners
    }
}

#[cfg(test)]
mod tests {
    use std::collections::{HashMap, HashSet};

    use glam::IVec3;
    use proptest::prelude::*;

    use super::*;

    fn spec(counts: UVec3, spacing: Vec3, centre: Vec3) -> LayoutSpec {
        LayoutSpec {
            name: "test".into(),
            counts,
            spacing,
            centre,
            follow: false,
            cascades: 1,
            octree: None,
        }
    }

    fn volume(counts: [u32; 3], spacing: f32) -> Volume {
        Volume::new(&spec(counts.into(), Vec3::splat(spacing), Vec3::ZERO)).expect("a good layout")
    }

    fn cascades(counts: [u32; 3], spacing: f32, cascades: u32, follow: bool) -> Volume {
        Volume::new(&LayoutSpec {
            cascades,
            follow,
            ..spec(counts.into(), Vec3::splat(spacing), Vec3::ZERO)
        })
        .expect("a good layout")
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
        let refused = |spec: &LayoutSpec| {
            let error = Volume::new(spec).expect_err("must be refused");
            error.to_string()
        };
        let bad = |counts: UVec3, spacing: f32, centre: f32| {
            refused(&spec(counts, Vec3::splat(spacing), Vec3::splat(centre)))
        };
        assert!(bad(UVec3::new(3, 0, 3), 1.0, 0.0).contains("at least 1"));
        for spacing in [f32::NAN, -1.0, 0.0, 1e-40, 1e30, f32::INFINITY] {
            assert!(bad(UVec3::ONE, spacing, 0.0).contains("between 0.25"));
        }
        assert!(bad(UVec3::ONE, 1.0, f32::INFINITY).contains("centre"));
        assert!(bad(UVec3::ONE, 1.0, f32::NAN).contains("centre"));
        assert!(bad(UVec3::splat(u32::MAX), 1.0, 0.0).contains("at most"));
        assert!(bad(UVec3::splat(9), 1e6, 0.0).contains("4000000 voxels"));
        let many = |cascades, counts, follow| {
            refused(&LayoutSpec {
                cascades,
                follow,
                ..spec(UVec3::splat(counts), Vec3::ONE, Vec3::ZERO)
            })
        };
        assert!(many(0, 8, false).contains("between 1 and 6"));
        assert!(many(7, 8, false).contains("between 1 and 6"));
        assert!(many(6, 64, false).contains("1572864 probes"));
        assert!(many(2, 3, false).contains("at least 4"));
        assert!(many(1, 3, true).contains("at least 4"));
    }

    #[test]
    fn a_lattice_point_has_its_own_probe_alone() {
        let volume = volume([4, 3, 5], 2.0);
        let level = volume.levels()[0];
        for slot in 0..volume.slots() {
            let index = UVec3::new(slot % 4, slot / 4 % 3, slot / 12);
            let point = level.first() + index.as_vec3() * level.spacing();
            let own: f32 = volume
                .cage(point)
                .iter()
                .filter(|c| c.0 == slot)
                .map(|c| c.1)
                .sum();
            assert!((own - 1.0).abs() < 1e-5, "slot {slot}: {own}");
        }
    }

    /// Weights by probe position and level: a slot can change its probe.
    fn weights(volume: &Volume, point: Vec3) -> HashMap<(usize, IVec3), f32> {
        let mut weights = HashMap::new();
        for (slot, weight) in volume.cage(point) {
            let level = slot / volume.level_slots();
            let place = volume.level_of(slot).point(slot);
            *weights.entry((level as usize, place)).or_default() += weight;
        }
        weights
    }

    #[test]
    fn far_positions_are_clamped_and_nan_moves_nothing() {
        let mut volume = cascades([4, 5, 6], 2.0, 6, true);
        let far = |volume: &Volume| {
            let positions = (0..volume.slots()).map(|slot| volume.position(slot));
            positions.fold(0f32, |far, position| far.max(position.abs().max_element()))
        };
        for eye in [
            Vec3::splat(1e7),
            Vec3::splat(f32::NEG_INFINITY),
            Vec3::X * 1e38,
        ] {
            volume.follow(eye);
            assert!(far(&volume) < 2.0 * FARTHEST, "{eye}");
            let positions: HashSet<_> = (0..volume.level_slots())
                .map(|slot| volume.position(slot).to_array().map(f32::to_bits))
                .collect();
            assert_eq!(positions.len(), 120, "positions coincide at {eye}");
        }
        volume.follow(Vec3::new(30.0, 40.0, 50.0));
        let before = volume.clone();
        volume.follow(Vec3::splat(f32::NAN));
        assert_eq!(volume, before);
    }

    proptest! {
        #[test]
        fn cage_weights_are_a_partition_of_one(
            counts in prop::array::uniform3(4u32..7),
            spacing in 0.5f32..20.0,
            levels in 1u32..=6,
            follow in any::<bool>(),
            eye in prop::array::uniform3(-200.0f32..200.0),
            point in prop::array::uniform3(-400.0f32..400.0),
        ) {
            let mut volume = cascades(counts, spacing, levels, follow);
            volume.follow(eye.into());
            let cage = volume.cage(point.into());
            prop_assert!(cage.iter().all(|&(slot, w)| slot < volume.slots() && (0.0..=1.0).contains(&w)));
            prop_assert!((cage.iter().map(|c| c.1).sum::<f32>() - 1.0).abs() < 1e-5);
        }

        #[test]
        fn small_volumes_fade_too(
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
            counts in prop::array::uniform3(4u32..9),
            spacing in 0.5f32..20.0,
            levels in 1u32..=3,
            follow in any::<bool>(),
            eye in prop::array::uniform3(-200.0f32..200.0),
            part in prop::array::uniform3(-1.0f32..1.0),
        ) {
            let mut volume = cascades(counts, spacing, levels, follow);
            volume.follow(eye.into());
            let coarsest = volume.levels()[levels as usize - 1];
            let point = coarsest.middle() + Vec3::from(part) * coarsest.reach() * coarsest.spacing();
            let mean: Vec3 = weights(&volume, point).iter().map(|((level, place), w)| {
                let level = volume.levels()[*level];
                (level.anchor() + place.as_vec3() * level.spacing()) * *w
            }).sum();
            prop_assert!(mean.distance(point) < 2e-3 * coarsest.spacing().x);
        }

        /// However the camera moves, in small steps or in jumps: a lattice point that remains keeps its
        /// slot and its position, and exactly the slots with a new lattice point are fresh.
        #[test]
        fn slots_keep_their_lattice_points_while_they_can(
            counts in prop::array::uniform3(4u32..7),
            spacing in 0.5f32..5.0,
            path in prop::collection::vec(
                (prop::array::uniform3(-1.0f32..1.0), prop::sample::select(vec![0.5f32, 3.0, 30.0, 1e5])),
                1..12,
            ),
        ) {
            let mut volume = cascades(counts, spacing, 3, true);
            let mut eye = Vec3::ZERO;
            for (direction, distance) in path {
                eye += Vec3::from(direction) * distance;
                let before = volume.clone();
                volume.follow(eye);
                let mut fresh = 0;
                for slot in 0..volume.slots() {
                    let (now, then) = (volume.level_of(slot), before.level_of(slot));
                    let stays = now.point(slot) == then.point(slot);
                    prop_assert_eq!(then.contains(now.point(slot)), stays);
                    fresh += u32::from(!stays);
                    prop_assert_eq!(now.slot(now.point(slot)), slot);
                    if stays {
                        prop_assert_eq!(volume.position(slot), before.position(slot));
                    }
                }
                prop_assert_eq!(volume.fresh_since(&before), fresh);
                // Distance between neighbouring f32 numbers this far out.
                let apart = eye.abs().max_element() * f32::EPSILON;
                for level in volume.levels() {
                    let window = level.first() + (level.counts() - 1).as_vec3() * 0.5 * level.spacing();
                    let off = (window - eye).abs() - 0.501 * level.spacing();
                    prop_assert!(off.max_element() < 4.0 * apart, "{off}");
                }
            }
        }

        /// No weight jumps when a window moves by a cell: arriving and leaving points then have weight
        /// 0.
        #[test]
        fn light_is_continuous_in_the_camera(
            counts in prop::array::uniform3(4u32..8),
            spacing in 1.0f32..4.0,
            levels in 1u32..=3,
            cell in prop::array::uniform3(-20i32..20),
            axis in 0usize..3,
            part in prop::array::uniform3(-1.5f32..1.5),
        ) {
            const STEP: f32 = 1e-3;
            let mut volume = cascades(counts, spacing, levels, true);
            // Where the finest window is about to move along one axis.
            let half = (counts[axis] - 1) as f32 * 0.5;
            let mut eye = IVec3::from(cell).as_vec3() * spacing;
            eye[axis] += (half.fract() - 0.5) * spacing;
            let point = eye + Vec3::from(part) * volume.levels()[0].reach() * spacing;
            let mut step = Vec3::ZERO;
            step[axis] = STEP * spacing;
            volume.follow(eye - step);
            let before = weights(&volume, point);
            let base = volume.levels()[0].base();
            volume.follow(eye + step);
            prop_assert_ne!(base, volume.levels()[0].base());
            let after = weights(&volume, point);
            for place in before.keys().chain(after.keys()) {
                let weight = |of: &HashMap<_, f32>| of.get(place).copied().unwrap_or_default();
                let change = (weight(&before) - weight(&after)).abs();
                prop_assert!(change < 10.0 * STEP, "{place:?} jumps by {change}");
            }
        }
    }
}
