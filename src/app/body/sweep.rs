//! A box that moves through voxels, in whole numbers.
//!
//! Positions are whole multiples of 2⁻²⁰ voxel, so a box that touches a face has exactly the coordinate of that
//! face: there is no rounding and no epsilon. A move goes along one axis at a time and looks at every layer of
//! voxels that the leading face enters, however far it goes: nothing is skipped at any speed. (Amanatides & Woo
//! 1987 for a box: along one axis the next boundary is simply the next whole number.)

use glam::{DVec3, I64Vec3, IVec3};

use super::terrain::Terrain;

/// Fraction bits of a coordinate.
const BITS: u32 = 20;
/// Units per voxel.
pub const ONE: i64 = 1 << BITS;
/// Coordinates stay within ± this many voxels, so that nothing overflows.
pub const FARTHEST: i64 = 1 << 22;
/// Longest move along one axis (voxels).
const LONGEST: i64 = 1 << 12;

/// A length in voxels as units; what is not a number becomes 0.
pub fn to_units(voxels: f64) -> i64 {
    let farthest = FARTHEST as f64;
    (voxels.clamp(-farthest, farthest) * ONE as f64).round() as i64
}

/// A position in voxels as units.
pub fn point_to_units(voxels: DVec3) -> I64Vec3 {
    I64Vec3::from(voxels.to_array().map(to_units))
}

pub fn to_voxels(units: i64) -> f64 {
    units as f64 / ONE as f64
}

/// An axis-aligned box, not empty. It holds the voxels of which it covers more than a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Aabb {
    pub min: I64Vec3,
    pub max: I64Vec3,
}

impl Aabb {
    pub fn moved(self, by: I64Vec3) -> Self {
        Self {
            min: self.min + by,
            max: self.max + by,
        }
    }

    /// The lowest and the highest voxel in the box.
    pub fn voxels(&self) -> (IVec3, IVec3) {
        (
            (self.min >> BITS).as_ivec3(),
            ((self.max - 1) >> BITS).as_ivec3(),
        )
    }

    /// The box and all that it passes on a way along `axis`.
    pub fn along(mut self, axis: usize, way: i64) -> Self {
        self.min[axis] += way.min(0);
        self.max[axis] += way.max(0);
        self
    }

    /// Whether any voxel in the box is solid, or a moving body is in it.
    pub fn overlaps(&self, terrain: &impl Terrain) -> bool {
        let (low, high) = self.voxels();
        any_solid(terrain, low, high) || terrain.in_the_way().overlaps(self)
    }

    /// How far the box can move along `axis` (0 … 2), of `distance`: to the first solid voxel or moving body in its way.
    /// What the box is in already does not stop it.
    pub fn sweep(&self, terrain: &impl Terrain, axis: usize, distance: i64) -> i64 {
        let free = self.sweep_voxels(terrain, axis, distance);
        terrain.in_the_way().sweep(self, axis, free)
    }

    /// The same without moving bodies.
    pub fn sweep_voxels(&self, terrain: &impl Terrain, axis: usize, distance: i64) -> i64 {
        let distance = distance.clamp(-LONGEST * ONE, LONGEST * ONE);
        let (mut low, mut high) = self.voxels();
        let mut is_blocked = |layer: i64| {
            low[axis] = layer as i32;
            high[axis] = layer as i32;
            any_solid(terrain, low, high)
        };
        if distance > 0 {
            let face = self.max[axis];
            let entered = (face + ONE - 1) >> BITS..=(face + distance - 1) >> BITS;
            for layer in entered {
                if is_blocked(layer) {
                    return (layer << BITS) - face;
                }
            }
        } else {
            let face = self.min[axis];
            let entered = (face + distance) >> BITS..=(face >> BITS) - 1;
            for layer in entered.rev() {
                if is_blocked(layer) {
                    return ((layer + 1) << BITS) - face;
                }
            }
        }
        distance
    }

    /// Whether the box stands on a voxel.
    pub fn is_supported(&self, terrain: &impl Terrain) -> bool {
        self.sweep(terrain, 1, -1) == 0
    }
}

fn any_solid(terrain: &impl Terrain, low: IVec3, high: IVec3) -> bool {
    (low.y..=high.y).any(|y| {
        (low.z..=high.z).any(|z| (low.x..=high.x).any(|x| terrain.is_solid(IVec3::new(x, y, z))))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Wall(i32);

    impl Terrain for Wall {
        fn is_solid(&self, voxel: IVec3) -> bool {
            voxel.x == self.0
        }
    }

    fn cube(low: f64) -> Aabb {
        let min = point_to_units(DVec3::splat(low));
        Aabb {
            min,
            max: min + I64Vec3::splat(ONE),
        }
    }

    #[test]
    fn a_box_stops_exactly_at_a_face_from_either_side_however_far_it_goes() {
        for distance in [3.0, 3.5, 1000.0] {
            let free = cube(0.5).sweep(&Wall(4), 0, to_units(distance));
            assert_eq!(cube(0.5).max.x + free, 4 * ONE);
            let free = cube(0.5).sweep(&Wall(-3), 0, -to_units(distance));
            assert_eq!(cube(0.5).min.x + free, -2 * ONE);
        }
        assert_eq!(cube(0.5).sweep(&Wall(4), 0, ONE), ONE);
        assert_eq!(cube(0.5).sweep(&Wall(4), 1, 9 * ONE), 9 * ONE, "along it");
    }

    #[test]
    fn a_box_at_a_face_touches_but_does_not_overlap() {
        assert!(!cube(3.0).overlaps(&Wall(4)));
        assert!(!cube(5.0).overlaps(&Wall(4)));
        assert_eq!(cube(3.0).sweep(&Wall(4), 0, 1), 0);
        assert_eq!(cube(5.0).sweep(&Wall(4), 0, -1), 0);
        for inside in [3.0 + 1e-5, 4.0, 5.0 - 1e-5] {
            assert!(cube(inside).overlaps(&Wall(4)), "{inside}");
        }
        assert_eq!(
            cube(4.5).sweep(&Wall(4), 0, ONE),
            ONE,
            "the way out is free"
        );
    }

    #[test]
    fn what_is_no_number_is_no_length() {
        assert_eq!(to_units(f64::NAN), 0);
        assert_eq!(to_units(f64::INFINITY), FARTHEST * ONE);
    }
}
