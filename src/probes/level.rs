//! One level of a volume: a window of probes on an infinite lattice of fixed points.

use glam::{IVec3, UVec3, Vec3};

use crate::world::scenery::FARTHEST;

/// Lattice point p (integers) lies at anchor + p · spacing, wherever the window is; its probe is at the
/// centre of the voxel that contains the point. The level has probes at the points from `base` to
/// `base` + counts − 1. Point p has slot first + wrapped x + counts.x · (wrapped y + counts.y · wrapped
/// z), where wrapped is p modulo the counts: when the window moves, points that remain in it keep their
/// slots, and new points take the slots of those that left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Level {
    counts: UVec3,
    spacing: Vec3,
    anchor: Vec3,
    base: IVec3,
    /// World-space middle of the region that the level lights. In a moving window it follows the camera
    /// without steps, so that light is continuous when the window moves by a cell.
    middle: Vec3,
    /// Distance from the middle to where the level's light ends, in cells.
    reach: Vec3,
    first_slot: u32,
}

impl Level {
    /// A fixed window around `centre`, with lattice point (0, 0, 0) at its lowest corner.
    pub(super) fn still(counts: UVec3, spacing: Vec3, centre: Vec3, first_slot: u32) -> Self {
        let reach = (counts - 1).as_vec3() * 0.5;
        Self {
            counts,
            spacing,
            anchor: centre - reach * spacing,
            base: IVec3::ZERO,
            middle: centre,
            reach,
            first_slot,
        }
    }

    /// A window around `middle` on the lattice through the origin of world space. The window's own
    /// middle is never more than half a cell away.
    pub(super) fn moving(counts: UVec3, spacing: Vec3, middle: Vec3, first_slot: u32) -> Self {
        let mut level = Self {
            counts,
            spacing,
            anchor: Vec3::ZERO,
            base: IVec3::ZERO,
            middle: Vec3::ZERO,
            // Half a cell less than the window, because its own middle may be that far off.
            reach: counts.as_vec3() * 0.5 - 1.0,
            first_slot,
        };
        level.move_to(middle);
        level
    }

    /// Moves the window by whole cells. Coordinates are clamped to the range in which f32 still tells
    /// voxels apart; NaN changes nothing.
    pub(super) fn move_to(&mut self, middle: Vec3) {
        let known = Vec3::select(middle.is_nan_mask(), self.middle, middle);
        self.middle = known.clamp(Vec3::splat(-FARTHEST), Vec3::splat(FARTHEST));
        let half = (self.counts - 1).as_dvec3() * 0.5;
        let corner = self.middle.as_dvec3() / self.spacing.as_dvec3() - half;
        self.base = corner.round().as_ivec3();
    }

    /// Probes along each axis.
    pub fn counts(&self) -> UVec3 {
        self.counts
    }

    /// Distance between neighbouring lattice points (voxels).
    pub fn spacing(&self) -> Vec3 {
        self.spacing
    }

    /// World-space position of lattice point (0, 0, 0).
    pub fn anchor(&self) -> Vec3 {
        self.anchor
    }

    /// Lattice point at the lowest corner of the window.
    pub fn base(&self) -> IVec3 {
        self.base
    }

    /// World-space position of the point at `base`.
    pub fn first(&self) -> Vec3 {
        self.anchor + self.base.as_vec3() * self.spacing
    }

    /// World-space middle of the region that the level lights.
    pub fn middle(&self) -> Vec3 {
        self.middle
    }

    /// Distance from the middle to where the level's light ends, in cells.
    pub fn reach(&self) -> Vec3 {
        self.reach
    }

    /// The first slot of the level.
    pub fn first_slot(&self) -> u32 {
        self.first_slot
    }

    /// The window's lowest corner in the order of the slots: `base` modulo the counts.
    pub fn wrap(&self) -> UVec3 {
        self.base.rem_euclid(self.counts.as_ivec3()).as_uvec3()
    }

    /// The greatest distance of a probe from a point of its own cage (voxels).
    pub fn cage_diagonal(&self) -> f32 {
        self.spacing.length()
    }

    /// Default position of the probe of a lattice point: the centre of a voxel (world space).
    pub fn position(&self, point: IVec3) -> Vec3 {
        (self.anchor + point.as_vec3() * self.spacing).floor() + 0.5
    }

    /// Slot of a lattice point in the window.
    pub fn slot(&self, point: IVec3) -> u32 {
        let place = point.rem_euclid(self.counts.as_ivec3()).as_uvec3();
        self.first_slot + place.x + self.counts.x * (place.y + self.counts.y * place.z)
    }

    /// The lattice point of the window that owns a slot of the level.
    pub fn point(&self, slot: u32) -> IVec3 {
        let local = slot - self.first_slot;
        let row = local / self.counts.x;
        let place = UVec3::new(
            local % self.counts.x,
            row % self.counts.y,
            row / self.counts.y,
        );
        self.base + (place.as_ivec3() - self.base).rem_euclid(self.counts.as_ivec3())
    }

    /// Whether the window has a lattice point.
    pub fn contains(&self, point: IVec3) -> bool {
        let index = point - self.base;
        index.cmpge(IVec3::ZERO).all() && index.cmplt(self.counts.as_ivec3()).all()
    }

    /// Number of slots whose lattice point differs from that in `before`, an earlier state of the same
    /// level.
    pub fn fresh_since(&self, before: &Self) -> u32 {
        let moved = (self.base - before.base).abs().as_uvec3();
        let kept = self.counts.saturating_sub(moved);
        self.counts.element_product() - kept.element_product()
    }

    /// Share of a point's light that the level gives, 0 to 1: all of it inside, none outside, falling
    /// linearly over the last `fade` cells.
    pub fn share(&self, point_ws: Vec3, fade: f32) -> f32 {
        let inside = self.reach - (point_ws - self.middle).abs() / self.spacing;
        (inside.min_element() / fade).clamp(0.0, 1.0)
    }

    /// Trilinear weights. A point outside the region that the level lights has the weights of the
    /// nearest point inside.
    pub fn cage(&self, point_ws: Vec3) -> [(u32, f32); 8] {
        let last = self.counts - 1;
        let half = self.reach * self.spacing;
        let lit = point_ws.clamp(self.middle - half, self.middle + half);
        let place = ((lit - self.first()) / self.spacing).clamp(Vec3::ZERO, last.as_vec3());
        // The last lattice point belongs to the cage before it, but a count of 1 has only one.
        let low = place.as_uvec3().min(last.saturating_sub(UVec3::ONE));
        let along = place - low.as_vec3();
        std::array::from_fn(|corner| {
            let corner = corner as u32;
            let offset = UVec3::new(corner & 1, corner >> 1 & 1, corner >> 2);
            let weights = Vec3::select(offset.cmpeq(UVec3::ONE), along, 1.0 - along);
            let point = self.base + (low + offset).min(last).as_ivec3();
            (self.slot(point), weights.element_product())
        })
    }
}
