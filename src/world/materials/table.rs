//! Materials as bytes for the GPU: the storage buffer of `shaders/scene/materials.wesl`.
//!
//! Every hit reads a material, from addresses that differ between rays, so the table is packed small: a
//! constant colour takes four words, and other colours have more among the details. Albedos keep all
//! bits, because an error grows with every bounce.

use glam::Vec3;

use super::{Colour, MaterialSet};

crate::shared! {
    in world;

    /// Materials in the table: one for each value of a voxel's byte. Number 0, air, stays black.
    pub const CAPACITY as MATERIALS: usize = 256;

    /// In `GpuMaterial::texture`: the material has no texture.
    pub const NO_TEXTURE: u32 = u32::MAX;

    const KIND_FLAT as COLOUR_FLAT: u32 = 0;
    const KIND_HASH as COLOUR_HASH: u32 = 1;
    const KIND_DITHER_X as COLOUR_DITHER_X: u32 = 2;
    const KIND_BANDS as COLOUR_BANDS: u32 = 3;

    /// A material; albedo = mix(a, b, mask).
    pub struct GpuMaterial as Material {
        /// A packed colour: red, green and blue of its lower end as f32, then a word with the kind in
        /// two bits and above them an index into the details.
        pub a: [u32; 4],
        pub b: [u32; 4],
        /// Radiance (linear RGB).
        pub emission: [f32; 3],
        pub mask_mean: f32,
        /// Layer of `block_masks` | blocks along a tile's edge << 16, or NO_TEXTURE.
        pub texture: u32,
        pub _pad: [u32; 3],
    }
}

/// The parts of a colour that do not fit into its packed form. Hash: its upper end (r, g, b, 0).
/// Dither: (from, to, 0, 0), then its upper end. Bands: (number of stops, 0, 0, 0), then the stops
/// (height, r, g, b).
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
    let upper_end = |colour: &Vec3| colour.extend(0.0).to_array();
    let (kind, low) = match colour {
        Colour::Flat(colour) => (KIND_FLAT, colour),
        Colour::Hash(low, high) => {
            details.push(upper_end(high));
            (KIND_HASH, low)
        }
        Colour::DitherX {
            from,
            to,
            low,
            high,
        } => {
            details.push([*from, *to, 0.0, 0.0]);
            details.push(upper_end(high));
            (KIND_DITHER_X, low)
        }
        Colour::Bands { below, above } => {
            details.push([below.len() as f32, 0.0, 0.0, 0.0]);
            details.extend(
                below
                    .iter()
                    .map(|(height, colour)| [*height, colour.x, colour.y, colour.z]),
            );
            (KIND_BANDS, above)
        }
    };
    let [r, g, b] = low.to_array().map(f32::to_bits);
    [r, g, b, kind | index << 2]
}
