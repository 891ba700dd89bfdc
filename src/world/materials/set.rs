//! The materials of a world with their textures: albedo and emission of any point of a surface.

use glam::{DVec3, IVec3, Vec3};
use rayon::prelude::*;

use super::bake::Tile;
use super::colour::voxel_detail;
use super::{Material, Pattern};

/// The materials of a world with their textures.
#[derive(Clone, Debug)]
pub struct MaterialSet {
    pub(super) materials: Vec<Material>,
    pub(super) tiles: Vec<Tile>,
    /// Index into `tiles`; plain materials have none.
    pub(super) tile_of: Vec<Option<usize>>,
}

impl MaterialSet {
    /// Bakes a tile for every pattern that the materials use, in parallel. The same materials and
    /// seed give the same bytes.
    pub fn bake(materials: &[Material], seed: u32) -> Self {
        let mut patterns: Vec<Pattern> = Vec::new();
        let tile_of = materials
            .iter()
            .map(|material| {
                let pattern = material.pattern;
                if pattern == Pattern::Plain {
                    return None;
                }
                let known = patterns.iter().position(|known| *known == pattern);
                Some(known.unwrap_or_else(|| {
                    patterns.push(pattern);
                    patterns.len() - 1
                }))
            })
            .collect();
        Self {
            materials: materials.to_vec(),
            tiles: patterns
                .par_iter()
                .map(|pattern| Tile::bake(pattern, seed))
                .collect(),
            tile_of,
        }
    }

    /// The highest mean albedo of a material, over its texture and the channels; 0 without materials. (A colour that
    /// differs from voxel to voxel counts with its value at the origin.)
    pub fn brightest(&self) -> f32 {
        let numbers = 1..=self.materials.len() as u8;
        let means =
            numbers.map(|material| self.mean_albedo(material, IVec3::ZERO).element_sum() / 3.0);
        means.fold(0.0, f32::max)
    }

    /// The layers of the GPU's texture array.
    pub fn tiles(&self) -> &[Tile] {
        &self.tiles
    }

    /// Albedo (linear RGB) of a point on a face of a world-space voxel.
    ///
    /// `material` is the voxel's, 1-based; `face` is 0 −x, 1 +x, 2 −y, 3 +y, 4 −z, 5 +z; `footprint` is
    /// the width in voxels of the area that the ray sees (pixel angle · distance / cosine), over which
    /// the texture is averaged.
    pub fn albedo(
        &self,
        material: u8,
        voxel: IVec3,
        face: u8,
        position_ws: DVec3,
        footprint: f64,
    ) -> Vec3 {
        let index = index_of(material);
        let material = &self.materials[index];
        let detail = voxel_detail(footprint as f32);
        let a = material.a.at(voxel, detail);
        let Some(tile) = self.tile_of[index] else {
            return a;
        };
        let tile = &self.tiles[tile];
        let mask = tile.sample(face_uv(face, position_ws), tile.level_for(footprint));
        a.lerp(material.b.at(voxel, detail), mask as f32)
    }

    /// Albedo of a voxel averaged over its texture: for rays that need no detail.
    pub fn mean_albedo(&self, material: u8, voxel: IVec3) -> Vec3 {
        let index = index_of(material);
        let material = &self.materials[index];
        let a = material.a.at(voxel, 1.0);
        match self.tile_of[index] {
            Some(tile) => a.lerp(material.b.at(voxel, 1.0), self.tiles[tile].mean),
            None => a,
        }
    }

    /// Emitted radiance (linear RGB).
    pub fn emission(&self, material: u8) -> Vec3 {
        self.materials[index_of(material)].emission
    }
}

fn index_of(material: u8) -> usize {
    debug_assert_ne!(material, 0, "air has no surface");
    usize::from(material) - 1
}

/// Texture coordinates of a face in blocks: aligned to the world, so that textures continue from block
/// to block. v is up on the four upright sides.
fn face_uv(face: u8, position_ws: DVec3) -> [f64; 2] {
    match face / 2 {
        0 => [position_ws.z, position_ws.y],
        1 => [position_ws.x, position_ws.z],
        _ => [position_ws.x, position_ws.y],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::{Colour, MaterialSound};

    const STRIPES: Pattern = Pattern::Stripes {
        pitch: 0.25,
        width: 0.4,
    };
    const SPOTS: Pattern = Pattern::Worley {
        cells: 3,
        radius: 0.1,
    };
    const CLOUD: Pattern = Pattern::Fbm {
        cells: 2,
        octaves: 4,
    };

    fn material(pattern: Pattern) -> Material {
        Material {
            name: "m".into(),
            a: Colour::Flat(Vec3::new(1.0, 0.0, 0.25)),
            b: Colour::Flat(Vec3::new(0.0, 1.0, 0.25)),
            pattern,
            emission: Vec3::new(0.0, 2.0, 0.0),
            sound: MaterialSound::Glow,
        }
    }

    #[test]
    fn equal_patterns_share_a_tile_and_plain_ones_need_none() {
        let patterns = [STRIPES, Pattern::Plain, SPOTS, STRIPES];
        let set = MaterialSet::bake(&patterns.map(material), 1);
        assert_eq!(set.tiles().len(), 2);
        assert_eq!(set.tile_of, [Some(0), None, Some(1), Some(0)]);
        assert_eq!(set.mean_albedo(2, IVec3::ZERO), Vec3::new(1.0, 0.0, 0.25));
        assert_eq!(set.emission(1), Vec3::new(0.0, 2.0, 0.0));
    }

    /// From far away a texture is its mean, at any place on it.
    #[test]
    fn a_wide_footprint_sees_the_mean() {
        let set = MaterialSet::bake(&[material(SPOTS)], 1);
        let mean = set.mean_albedo(1, IVec3::ZERO);
        for step in 0..50 {
            let position = DVec3::new(0.37, 0.71, 0.13) * f64::from(step);
            let seen = set.albedo(1, position.floor().as_ivec3(), 5, position, 50.0);
            assert!((seen - mean).length() < 0.01, "{seen} {mean}");
        }
    }

    /// The average over a face does not depend on the footprint: filtering keeps energy.
    #[test]
    fn filtering_keeps_the_average() {
        let set = MaterialSet::bake(&[material(CLOUD)], 1);
        let average = |footprint: f64| {
            let places =
                (0..64 * 64).map(|i| DVec3::new(f64::from(i % 64), f64::from(i / 64), 0.0) / 8.0);
            places
                .map(|at| set.albedo(1, IVec3::ZERO, 5, at, footprint))
                .sum::<Vec3>()
                / 4096.0
        };
        for footprint in [0.0, 0.05, 0.3, 1.1, 3.0] {
            let difference = average(footprint) - set.mean_albedo(1, IVec3::ZERO);
            assert!(difference.length() < 0.01, "{difference} at {footprint}");
        }
    }

    #[test]
    fn textures_continue_from_block_to_block() {
        let set = MaterialSet::bake(&[material(CLOUD)], 1);
        for face in [0, 3, 5] {
            let at = |x: f64| {
                set.albedo(
                    1,
                    DVec3::splat(x).floor().as_ivec3(),
                    face,
                    DVec3::splat(x),
                    0.0,
                )
            };
            for edge in -5..6 {
                let edge = f64::from(edge);
                assert!((at(edge - 1e-6) - at(edge + 1e-6)).length() < 1e-3);
            }
        }
    }
}
