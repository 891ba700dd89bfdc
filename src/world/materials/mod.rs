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
pub mod table;

use glam::Vec3;
use serde::Deserialize;

use super::sdf::{NoiseId, Sdf};
pub use set::MaterialSet;

#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    pub name: String,
    pub a: Colour,
    pub b: Colour,
    pub pattern: Pattern,
    /// Emitted radiance (linear RGB), the same in every direction.
    pub emission: Vec3,
}

/// A colour that is constant over one voxel, and may depend on where the voxel lies.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Colour {
    Flat(Vec3),
    /// The colour of the first stop whose height exceeds that of the voxel's centre; else `above`.
    Bands {
        below: Vec<(f32, Vec3)>,
        above: Vec3,
    },
    /// `low` where x < from, `high` where x ≥ to (x of the voxel's centre), between them a dither
    /// by the voxel's hash.
    DitherX {
        from: f32,
        to: f32,
        low: Vec3,
        high: Vec3,
    },
    /// Between the two by the voxel's hash.
    Hash(Vec3, Vec3),
}

/// The mask over a face. Lengths (pitch, radius, joint) are in blocks; `cells` and `rows` count along
/// one block. Pitches and angles are adjusted a little so that the pattern repeats after a whole
/// number of blocks.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
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
    /// Bricks of a, each with a tone of its own towards b, and joints of b of this thickness.
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
    /// Noise over the distance from the block's centre, about so many rings.
    Radial {
        rings: u32,
    },
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
    /// Depth under the surface, −shape(p), is less than this.
    ShallowerThan(f32),
    /// The world's shape is empty one voxel above.
    FacesUp,
    /// The world's shape is empty one voxel below.
    FacesDown,
    All(Vec<Condition>),
    Any(Vec<Condition>),
    Not(Box<Condition>),
}
