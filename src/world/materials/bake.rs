//! One block texture, baked: a mask as bytes with its mip levels. The GPU samples the same bytes.

use rayon::prelude::*;

use super::Pattern;
use super::pattern::{Mask, extent_blocks};

/// Texels along a tile's edge.
pub const TEXELS: u32 = 256;
/// Mip levels of a tile, down to a single texel.
pub const LEVELS: u32 = TEXELS.ilog2() + 1;

/// A mask over a square of blocks that repeats seamlessly.
#[derive(Clone, Debug)]
pub struct Tile {
    /// Blocks along its edge.
    pub extent_blocks: u32,
    /// Level 0 first; rows of increasing v, 255 is 1.
    pub levels: Vec<Vec<u8>>,
    /// Mean of level 0, in [0, 1].
    pub mean: f32,
}

impl Tile {
    /// Evaluates a pattern over its tile.
    pub fn bake(pattern: &Pattern, seed: u32) -> Self {
        let mask = Mask::new(pattern, seed);
        let extent_blocks = extent_blocks(pattern);
        let fine = TEXELS * mask.samples;
        let blocks_per_sample = f64::from(extent_blocks) / f64::from(fine);
        let place = |sample: u32| (f64::from(sample) + 0.5) * blocks_per_sample;
        let mut raw: Vec<f32> = (0..TEXELS * TEXELS)
            .into_par_iter()
            .map(|texel| {
                let (x, y) = (texel % TEXELS * mask.samples, texel / TEXELS * mask.samples);
                let samples = (0..mask.samples * mask.samples).map(|sample| {
                    let (i, j) = (sample % mask.samples, sample / mask.samples);
                    mask.at(place(x + i), place(y + j))
                });
                (samples.sum::<f64>() / f64::from(mask.samples * mask.samples)) as f32
            })
            .collect();
        mask.levels(&mut raw);
        Self::from_values(extent_blocks, raw)
    }

    /// Builds the mip levels from unrounded values, so that errors do not accumulate.
    fn from_values(extent_blocks: u32, mut values: Vec<f32>) -> Self {
        let mut levels = vec![bytes(&values)];
        let mean = levels[0].iter().map(|&byte| f64::from(byte)).sum::<f64>()
            / (255.0 * levels[0].len() as f64);
        let mut edge = TEXELS as usize;
        while edge > 1 {
            edge /= 2;
            values = (0..edge * edge)
                .map(|texel| {
                    let corner = texel / edge * 2 * (edge * 2) + texel % edge * 2;
                    let quad = [corner, corner + 1, corner + edge * 2, corner + edge * 2 + 1];
                    quad.map(|index| values[index]).iter().sum::<f32>() / 4.0
                })
                .collect();
            levels.push(bytes(&values));
        }
        Self {
            extent_blocks,
            levels,
            mean: mean as f32,
        }
    }

    /// The mip level whose texels are as wide as the footprint (voxels).
    pub fn level_for(&self, footprint: f64) -> f64 {
        let texels = footprint * f64::from(TEXELS) / f64::from(self.extent_blocks);
        texels.max(1.0).log2().min(f64::from(LEVELS - 1))
    }

    /// The mask at (u, v) in blocks, trilinear between texels and levels.
    pub fn sample(&self, uv: [f64; 2], level: f64) -> f64 {
        let fine = level.floor();
        let at = |level: f64| self.bilinear(uv, (level as usize).min(LEVELS as usize - 1));
        let blend = level - fine;
        if blend == 0.0 {
            at(fine)
        } else {
            at(fine) * (1.0 - blend) + at(fine + 1.0) * blend
        }
    }

    fn bilinear(&self, uv: [f64; 2], level: usize) -> f64 {
        let edge = (TEXELS >> level) as i64;
        let texels_per_block = edge as f64 / f64::from(self.extent_blocks);
        let [x, y] = uv.map(|blocks| blocks * texels_per_block - 0.5);
        let (left, low) = (x.floor(), y.floor());
        let (fx, fy) = (x - left, y - low);
        let texel = |i: i64, j: i64| {
            let (i, j) = (
                (left as i64 + i).rem_euclid(edge),
                (low as i64 + j).rem_euclid(edge),
            );
            f64::from(self.levels[level][(j * edge + i) as usize]) / 255.0
        };
        let lower = texel(0, 0) * (1.0 - fx) + texel(1, 0) * fx;
        let upper = texel(0, 1) * (1.0 - fx) + texel(1, 1) * fx;
        lower * (1.0 - fy) + upper * fy
    }
}

fn bytes(values: &[f32]) -> Vec<u8> {
    values
        .iter()
        .map(|value| (value * 255.0).round() as u8)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const PATTERNS: [Pattern; 10] = [
        Pattern::Stripes {
            pitch: 0.25,
            width: 0.4,
        },
        Pattern::Stripes {
            pitch: 1.7,
            width: 0.4,
        },
        Pattern::Dots {
            radius: 0.05,
            pitch: 0.36,
            angle_deg: 45.0,
        },
        Pattern::Checker { squares: 3 },
        Pattern::Bricks {
            rows: 3,
            joint: 0.06,
        },
        Pattern::Bricks {
            rows: 4,
            joint: 0.06,
        },
        Pattern::Worley {
            cells: 3,
            radius: 0.1,
        },
        Pattern::Fbm {
            cells: 2,
            octaves: 4,
        },
        Pattern::StripesFbm {
            cells: 2,
            octaves: 3,
        },
        Pattern::Radial { rings: 3 },
    ];

    /// Largest difference between neighbours inside the tile, and across its edges.
    fn steps(level: &[u8], axis: usize) -> (i32, i32) {
        let edge = TEXELS as usize;
        let at = |along: usize, across: usize| {
            let [x, y] = if axis == 0 {
                [along, across]
            } else {
                [across, along]
            };
            i32::from(level[y % edge * edge + x % edge])
        };
        let (mut inside, mut over) = (0, 0);
        for across in 0..edge {
            for along in 0..edge {
                let step = (at(along, across) - at((along + 1) % edge, across)).abs();
                if along + 1 < edge {
                    inside = inside.max(step)
                } else {
                    over = over.max(step)
                }
            }
        }
        (inside, over)
    }

    #[test]
    fn tiles_have_no_seam() {
        for pattern in PATTERNS {
            let tile = Tile::bake(&pattern, 3);
            for axis in 0..2 {
                let (inside, over) = steps(&tile.levels[0], axis);
                assert!(
                    over <= inside,
                    "{pattern:?}: {over} over the edge, {inside} inside, axis {axis}"
                );
            }
        }
        // A planted seam is found.
        let mut slope = vec![0u8; (TEXELS * TEXELS) as usize];
        for (index, texel) in slope.iter_mut().enumerate() {
            *texel = (index % TEXELS as usize) as u8;
        }
        assert_eq!(steps(&slope, 0), (1, 255));
    }

    #[test]
    fn every_level_has_the_mean_of_the_first() {
        for pattern in PATTERNS {
            let tile = Tile::bake(&pattern, 3);
            assert_eq!(tile.levels.len(), LEVELS as usize);
            for (number, level) in tile.levels.iter().enumerate() {
                assert_eq!(level.len(), (TEXELS >> number).pow(2) as usize);
                let mean = level.iter().map(|&byte| f32::from(byte)).sum::<f32>()
                    / (255.0 * level.len() as f32);
                assert!(
                    (mean - tile.mean).abs() < 0.6 / 255.0,
                    "{pattern:?} level {number}: {mean} {}",
                    tile.mean
                );
            }
        }
    }

    #[test]
    fn masks_cover_the_area_of_their_numbers() {
        let mean = |pattern: &Pattern| Tile::bake(pattern, 3).mean;
        assert!((mean(&PATTERNS[0]) - 0.4).abs() < 0.01);
        assert!((mean(&PATTERNS[3]) - 0.5).abs() < 0.01);
        // A dot of area π r² in each cell of the fitted lattice, whose pitch is 1/√8.
        let dots = std::f32::consts::PI * 0.05 * 0.05 * 8.0;
        assert!(
            (mean(&PATTERNS[2]) - dots).abs() < 0.003,
            "{} instead of {dots}",
            mean(&PATTERNS[2])
        );
        for noise in &PATTERNS[7..] {
            assert!(
                (0.3..0.7).contains(&mean(noise)),
                "{noise:?}: {}",
                mean(noise)
            );
        }
    }

    #[test]
    fn noises_use_their_whole_range() {
        for pattern in &PATTERNS[7..] {
            let tile = Tile::bake(pattern, 3);
            let [lowest, highest] = [tile.levels[0].iter().min(), tile.levels[0].iter().max()];
            assert!(
                lowest < Some(&30) && highest > Some(&225),
                "{pattern:?}: {lowest:?}..{highest:?}"
            );
        }
    }

    #[test]
    fn the_seed_changes_noises_and_nothing_else_does() {
        let bytes = |seed: u32| Tile::bake(&PATTERNS[7], seed).levels;
        assert_eq!(bytes(1), bytes(1));
        assert_ne!(bytes(1), bytes(2));
    }
}
