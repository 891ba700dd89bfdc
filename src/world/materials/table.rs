//! Materials as bytes for the GPU: the storage buffer of `shaders/scene/materials.wesl`.
//!
//! Every hit reads a material, from places that differ from ray to ray, so it is packed small: a
//! colour is four words, its channels as 16-bit floats (relative error 2⁻¹¹).

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use half::f16;

use super::{Colour, MaterialSet};

crate::shared! {
    in world;

    /// Materials in the table: one for each value of a voxel's byte. Number 0, air, is left black.
    pub const CAPACITY as MATERIALS: usize = 256;

    /// In `GpuMaterial::texture`: the material has none.
    pub const NO_TEXTURE: u32 = u32::MAX;

    const KIND_FLAT as COLOUR_FLAT: u32 = 0;
    const KIND_HASH as COLOUR_HASH: u32 = 1;
    const KIND_DITHER_X as COLOUR_DITHER_X: u32 = 2;
    const KIND_BANDS as COLOUR_BANDS: u32 = 3;
}

/// `Material` in `shaders/scene/materials.wesl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct GpuMaterial {
    /// A packed [`Colour`]: low.r low.g, low.b high.r, high.g high.b as pairs of 16-bit floats (the
    /// first in the lower half), then the kind in two bits and above it an index into the details.
    pub a: [u32; 4],
    pub b: [u32; 4],
    pub emission: [f32; 3],
    pub mask_mean: f32,
    /// Layer of the texture array | blocks along a tile's edge << 16, or [`NO_TEXTURE`].
    pub texture: u32,
    pub _pad: [u32; 3],
}

/// What does not fit into a packed colour. Of a dither: (from, to, 0, 0). Of bands: (number of
/// stops, 0, 0, 0), then the stops (height, r, g, b).
type Detail = [f32; 4];

impl MaterialSet {
    /// The storage buffer's content: [`CAPACITY`] materials, then the details of their colours.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut table = vec![GpuMaterial::default(); CAPACITY];
        // A buffer must have room for one element of its last array.
        let mut details: Vec<Detail> = vec![[0.0; 4]];
        for (index, material) in self.materials.iter().enumerate() {
            let tile = self.tile_of[index].map(|layer| (layer as u32, &self.tiles[layer]));
            table[index + 1] = GpuMaterial {
                a: packed(&material.a, &mut details),
                b: packed(&material.b, &mut details),
                emission: material.emission.to_array(),
                mask_mean: tile.map_or(0.0, |(_, tile)| tile.mean),
                texture: tile.map_or(NO_TEXTURE, |(layer, tile)| layer | tile.extent_blocks << 16),
                _pad: [0; 3],
            };
        }
        let mut bytes = bytemuck::cast_slice(&table).to_vec();
        bytes.extend_from_slice(bytemuck::cast_slice(&details));
        bytes
    }
}

fn packed(colour: &Colour, details: &mut Vec<Detail>) -> [u32; 4] {
    let index = details.len() as u32;
    let (kind, low, high) = match colour {
        Colour::Flat(colour) => (KIND_FLAT, *colour, *colour),
        Colour::Hash(low, high) => (KIND_HASH, *low, *high),
        Colour::DitherX {
            from,
            to,
            low,
            high,
        } => {
            details.push([*from, *to, 0.0, 0.0]);
            (KIND_DITHER_X, *low, *high)
        }
        Colour::Bands { below, above } => {
            details.push([below.len() as f32, 0.0, 0.0, 0.0]);
            details.extend(
                below
                    .iter()
                    .map(|(height, colour)| [*height, colour.x, colour.y, colour.z]),
            );
            (KIND_BANDS, *above, *above)
        }
    };
    let [a, b, c] = pairs(low, high);
    [a, b, c, kind | index << 2]
}

fn pairs(low: Vec3, high: Vec3) -> [u32; 3] {
    let pair = |x: f32, y: f32| {
        u32::from(f16::from_f32(x).to_bits()) | u32::from(f16::from_f32(y).to_bits()) << 16
    };
    [
        pair(low.x, low.y),
        pair(low.z, high.x),
        pair(high.y, high.z),
    ]
}
