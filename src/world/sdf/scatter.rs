//! Scattered copies: which cells hold one, where and how large, from an integer hash that is the
//! same on the CPU and on the GPU (`shaders/sdf/scatter.wesl`).

use glam::{DVec3, IVec3, UVec3, Vec3};

use super::shape::Node;
use crate::world::noise::NoiseBank;

/// PCG in three dimensions: Jarzynski & Olano 2020, "Hash Functions for GPU Rendering".
pub fn pcg3d(v: UVec3) -> UVec3 {
    let mix = |mut v: UVec3| {
        v.x = v.x.wrapping_add(v.y.wrapping_mul(v.z));
        v.y = v.y.wrapping_add(v.z.wrapping_mul(v.x));
        v.z = v.z.wrapping_add(v.x.wrapping_mul(v.y));
        v
    };
    let lcg = |v: u32| v.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    let v = mix(UVec3::new(lcg(v.x), lcg(v.y), lcg(v.z)));
    mix(v ^ (v >> 16))
}

/// The top 24 bits of a hash as a number in [0, 1): exact in an f32.
fn unit(hash: u32) -> f32 {
    (hash >> 8) as f32 / 16_777_216.0
}

/// A prepared [`super::Sdf::Scatter`]. The cells are a block of whole cubes, centred in the box of
/// the description: as many along each axis as fit best, at least one.
#[derive(Clone, Debug)]
pub struct Scatter {
    /// Lowest corner of cell (0, 0, 0).
    pub(super) start: Vec3,
    pub(super) cells: UVec3,
    pub(super) cell: f32,
    /// A cell holds a copy when the top 24 bits of its hash lie below this.
    pub(super) threshold: u32,
    /// Greatest move from the cell's centre along each axis, voxels.
    pub(super) jitter: f32,
    pub(super) scale_low: f32,
    pub(super) scale_span: f32,
    pub(super) reach: f32,
    /// The seed, spread over all bits: it flips those of the cell's x before hashing.
    pub(super) seed_bits: u32,
    pub(super) of: Node,
}

/// One copy of the sub-tree.
pub(super) struct Placed {
    pub centre: Vec3,
    pub scale: f32,
}

impl Scatter {
    /// The copy in a cell, if it holds one.
    pub(super) fn placed(&self, cell: UVec3) -> Option<Placed> {
        let presence = pcg3d(UVec3::new(cell.x ^ self.seed_bits, cell.y, cell.z));
        if presence.x >> 8 >= self.threshold {
            return None;
        }
        let place = pcg3d(presence);
        let jitter = Vec3::new(unit(place.x), unit(place.y), unit(place.z)) * 2.0 - 1.0;
        Some(Placed {
            centre: self.start + (cell.as_vec3() + 0.5) * self.cell + jitter * self.jitter,
            scale: self.scale_low + unit(presence.y) * self.scale_span,
        })
    }

    /// Greatest distance of a copy's solid from its centre.
    pub(super) fn greatest_reach(&self) -> f64 {
        f64::from(self.reach) * f64::from(self.scale_low + self.scale_span)
    }

    /// No copy outside of the 27 cells around a point is nearer than this.
    pub(super) fn clearance(&self) -> f64 {
        1.5 * f64::from(self.cell) - f64::from(self.jitter) - self.greatest_reach()
    }

    /// Centre and half extent of the box that holds all copies.
    pub(super) fn content(&self) -> (DVec3, DVec3) {
        let half_cells = self.cells.as_dvec3() * f64::from(self.cell) / 2.0;
        let margin = f64::from(self.jitter) + self.greatest_reach() - f64::from(self.cell) / 2.0;
        (self.start.as_dvec3() + half_cells, half_cells + margin)
    }

    /// Distance to the nearest copy, cut off at [`Self::clearance`] among the cells, so that the 27
    /// cells around the point decide it, and at the distance to the box of all copies outside.
    pub(super) fn eval(&self, p: DVec3, bank: &NoiseBank) -> f64 {
        let (centre, half) = self.content();
        let outside = (((p - centre).abs() - half).max(DVec3::ZERO)).length();
        let mut nearest = self.clearance();
        if outside >= nearest {
            return outside;
        }
        let cell = f64::from(self.cell);
        let last = self.cells.as_ivec3() - 1;
        let home = ((p - self.start.as_dvec3()) / cell)
            .floor()
            .as_ivec3()
            .clamp(IVec3::ZERO, last);
        for x in (home.x - 1).max(0)..=(home.x + 1).min(last.x) {
            for y in (home.y - 1).max(0)..=(home.y + 1).min(last.y) {
                for z in (home.z - 1).max(0)..=(home.z + 1).min(last.z) {
                    let Some(copy) = self.placed(IVec3::new(x, y, z).as_uvec3()) else {
                        continue;
                    };
                    let from_centre = p - copy.centre.as_dvec3();
                    let scale = f64::from(copy.scale);
                    // Beyond its reach a copy is at least as far as its bounding sphere, whatever
                    // its own function says: without this the cut-off would not be continuous.
                    let to_sphere = from_centre.length() - f64::from(self.reach) * scale;
                    if to_sphere < nearest {
                        let distance = self.of.eval(from_centre / scale, bank) * scale;
                        nearest = nearest.min(distance.max(to_sphere));
                    }
                }
            }
        }
        if outside > 0.0 {
            nearest.max(outside)
        } else {
            nearest
        }
    }
}
