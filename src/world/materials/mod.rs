//! What voxels are made of: colours, procedural block textures, and the rules that place them.
//!
//! A block texture is a mask in [0, 1] over the faces of a block (or of a few blocks together);
//! albedo = mix(a, b, mask), where a and b are colours of the voxel. Filtering the mask therefore
//! filters the albedo exactly, which is why the baked tiles are masks with mip levels.

pub mod bake;
pub mod colour;
pub mod hash;
mod pattern;
pub mod set;
mod sound;
pub mod table;

use glam::Vec3;

use super::sdf::{NoiseId, Sdf};
pub use set::MaterialSet;
pub use sound::MaterialSound;

#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    pub name: String,
    pub a: Colour,
    pub b: Colour,
    pub pattern: Pattern,
    /// Emitted radiance (linear RGB), the same in every direction.
    pub emission: Vec3,
    pub sound: MaterialSound,
}

/// A colour that is constant over one voxel, and may depend on the voxel's position.
#[derive(Clone, Debug, PartialEq)]
pub enum Colour {
    Flat(Vec3),
    /// The colour of the first stop whose height exceeds that of the voxel's centre; else `above`.
    Bands {
        below: Vec<(f32, Vec3)>,
        above: Vec3,
    },
    /// `low` where x < from, `high` where x ≥ to (x of the voxel's centre), between them a dither by
    /// the voxel's hash.
    DitherX {
        from: f32,
        to: f32,
        low: Vec3,
        high: Vec3,
    },
    /// Between the two colours, by the voxel's hash.
    Hash(Vec3, Vec3),
}

/// The mask over a face. Lengths (pitch, radius, joint) are in blocks; `cells` and `rows` count along
/// one block; [`Pattern::fault`] checks their limits. Pitches and angles are adjusted slightly so that
/// the pattern repeats after a whole number of blocks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pattern {
    Plain,
    /// Vertical stripes; `width` is the share of the pitch that is b.
    Stripes {
        pitch: f32,
        width: f32,
    },
    Dots {
        radius: f32,
        pitch: f32,
        angle_deg: f32,
    },
    /// `squares` along one block.
    Checker {
        squares: u32,
    },
    /// Bricks of a, each tinted by its own amount towards b, and joints of b of this thickness.
    Bricks {
        rows: u32,
        joint: f32,
    },
    /// Spots around Worley feature points: b within `radius` of a point.
    Worley {
        cells: u32,
        radius: f32,
    },
    /// Smooth cloud.
    Fbm {
        cells: u32,
        octaves: u32,
    },
    /// Vertical stripes whose strength follows an fBm.
    StripesFbm {
        cells: u32,
        octaves: u32,
    },
    /// Noise over the distance from the block's centre, in about this many rings.
    Radial {
        rings: u32,
    },
}

/// Most cells, rows, squares or rings along one block: with more, one texel would hold several.
pub const MAX_REPEATS: u32 = 64;
/// Finer octaves would be smaller than a texel.
pub const MAX_OCTAVES: u32 = 8;
/// Narrowest and widest pitch in blocks: the widest fills a whole tile.
pub const PITCHES: std::ops::RangeInclusive<f32> = 0.02..=4.0;

impl Pattern {
    /// Why the pattern cannot be baked, in words for the author of the file.
    pub fn fault(&self) -> Option<String> {
        let count = |name: &str, value: u32, most: u32| {
            (!(1..=most).contains(&value))
                .then(|| format!("{name} is {value}; it must be between 1 and {most}"))
        };
        let number = |name: &str, value: f32, range: std::ops::RangeInclusive<f32>| {
            (!range.contains(&value)).then(|| {
                format!(
                    "{name} is {value}; it must be between {} and {}",
                    range.start(),
                    range.end()
                )
            })
        };
        let noise = |cells, octaves| {
            count("cells", cells, MAX_REPEATS).or_else(|| count("octaves", octaves, MAX_OCTAVES))
        };
        match *self {
            Self::Plain => None,
            Self::Stripes { pitch, width } => {
                number("pitch", pitch, PITCHES).or_else(|| number("width", width, 0.0..=1.0))
            }
            Self::Dots {
                radius,
                pitch,
                angle_deg,
            } => number("radius", radius, 0.0..=4.0)
                .or_else(|| number("pitch", pitch, PITCHES))
                .or_else(|| number("angle_deg", angle_deg, -360.0..=360.0)),
            Self::Checker { squares } => count("squares", squares, MAX_REPEATS),
            Self::Bricks { rows, joint } => {
                count("rows", rows, MAX_REPEATS).or_else(|| number("joint", joint, 0.0..=1.0))
            }
            Self::Worley { cells, radius } => {
                count("cells", cells, MAX_REPEATS).or_else(|| number("radius", radius, 0.0..=4.0))
            }
            Self::Fbm { cells, octaves } | Self::StripesFbm { cells, octaves } => {
                noise(cells, octaves)
            }
            Self::Radial { rings } => count("rings", rings, MAX_REPEATS),
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Rule {
    /// 1-based index into the world's materials.
    pub material: u8,
    pub when: Condition,
}

/// Evaluated at a voxel's centre in world space.
#[derive(Clone, Debug, PartialEq)]
pub enum Condition {
    Always,
    /// The voxel's centre lies below this height.
    Below(f32),
    Above(f32),
    InBox {
        min: Vec3,
        max: Vec3,
    },
    Inside(Sdf),
    NoiseBelow {
        noise: NoiseId,
        value: f32,
    },
    /// Depth below the surface, −shape(p), is less than this.
    ShallowerThan(f32),
    /// The world's shape is empty one voxel above.
    FacesUp,
    /// The world's shape is empty one voxel below.
    FacesDown,
    All(Vec<Condition>),
    Any(Vec<Condition>),
    Not(Box<Condition>),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pattern_that_cannot_be_baked_says_why() {
        for (pattern, word) in [
            (
                Pattern::Stripes {
                    pitch: 0.0,
                    width: 0.5,
                },
                "pitch",
            ),
            (
                Pattern::Stripes {
                    pitch: f32::NAN,
                    width: 0.5,
                },
                "pitch",
            ),
            (
                Pattern::Stripes {
                    pitch: 1.0,
                    width: -0.1,
                },
                "width",
            ),
            (
                Pattern::Dots {
                    radius: 0.1,
                    pitch: 1.0,
                    angle_deg: f32::INFINITY,
                },
                "angle_deg",
            ),
            (Pattern::Checker { squares: 0 }, "squares"),
            (
                Pattern::Bricks {
                    rows: 4,
                    joint: 2.0,
                },
                "joint",
            ),
            (
                Pattern::Worley {
                    cells: 1_000_000,
                    radius: 0.1,
                },
                "cells",
            ),
            (
                Pattern::Fbm {
                    cells: 2,
                    octaves: 0,
                },
                "octaves",
            ),
            (Pattern::Radial { rings: 65 }, "rings"),
        ] {
            let fault = pattern
                .fault()
                .unwrap_or_else(|| panic!("{pattern:?} is accepted"));
            assert!(fault.starts_with(word), "{fault}");
        }
        assert_eq!(Pattern::Plain.fault(), None);
        assert_eq!(
            Pattern::Worley {
                cells: 3,
                radius: 0.1
            }
            .fault(),
            None
        );
    }

    /// Accepted patterns can be baked, also at their limits.
    #[test]
    fn patterns_at_their_limits_are_baked() {
        for pattern in [
            Pattern::Stripes {
                pitch: 0.02,
                width: 1.0,
            },
            Pattern::Stripes {
                pitch: 4.0,
                width: 0.0,
            },
            Pattern::Dots {
                radius: 4.0,
                pitch: 4.0,
                angle_deg: -360.0,
            },
            Pattern::Worley {
                cells: MAX_REPEATS,
                radius: 0.0,
            },
            Pattern::Fbm {
                cells: MAX_REPEATS,
                octaves: MAX_OCTAVES,
            },
            Pattern::Bricks {
                rows: MAX_REPEATS,
                joint: 1.0,
            },
        ] {
            assert_eq!(pattern.fault(), None);
            let mean = bake::Tile::bake(&pattern, 1).mean;
            assert!((0.0..=1.0).contains(&mean), "{pattern:?}: {mean}");
        }
    }
}
