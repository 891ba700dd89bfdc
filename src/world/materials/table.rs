//! Materials as bytes for the GPU: the storage buffer of `shaders/data/materials.wesl`.

use bytemuck::{Pod, Zeroable};

use super::{Colour, MaterialSet};

/// Materials in the table: one for each value of a voxel's byte. Number 0, air, is left black.
pub const CAPACITY: usize = 256;

/// In `GpuMaterial::layer`: the material has no texture.
pub const NO_LAYER: u32 = u32::MAX;

const KIND_FLAT: u32 = 0;
const KIND_HASH: u32 = 1;
const KIND_DITHER_X: u32 = 2;
const KIND_BANDS: u32 = 3;

/// A [`Colour`]: `Colour` in `shaders/data/materials.wesl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct GpuColour {
    /// Of bands: the colour above all stops.
    pub low: [f32; 3],
    pub kind: u32,
    pub high: [f32; 3],
    /// Bands: index of the first stop.
    pub first_stop: u32,
    pub from_x: f32,
    pub to_x: f32,
    pub stop_count: u32,
    pub _pad: u32,
}

/// `Material` in `shaders/data/materials.wesl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct GpuMaterial {
    pub a: GpuColour,
    pub b: GpuColour,
    pub emission: [f32; 3],
    pub mask_mean: f32,
    /// Of the texture array, or [`NO_LAYER`].
    pub layer: u32,
    pub tiles_per_block: f32,
    pub _pad: [f32; 2],
}

impl MaterialSet {
    /// The storage buffer's content: [`CAPACITY`] materials, then the stops of all bands
    /// (height, r, g, b).
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut table = vec![GpuMaterial::default(); CAPACITY];
        // A buffer must have room for one element of its last array.
        let mut stops = vec![[0.0f32; 4]];
        for (index, material) in self.materials.iter().enumerate() {
            let tile = self.tile_of[index].map(|tile| &self.tiles[tile]);
            table[index + 1] = GpuMaterial {
                a: gpu_colour(&material.a, &mut stops),
                b: gpu_colour(&material.b, &mut stops),
                emission: material.emission.to_array(),
                mask_mean: tile.map_or(0.0, |tile| tile.mean),
                layer: self.tile_of[index].map_or(NO_LAYER, |tile| tile as u32),
                tiles_per_block: tile.map_or(1.0, |tile| 1.0 / tile.extent_blocks as f32),
                _pad: [0.0; 2],
            };
        }
        let mut bytes = bytemuck::cast_slice(&table).to_vec();
        bytes.extend_from_slice(bytemuck::cast_slice(&stops));
        bytes
    }
}

fn gpu_colour(colour: &Colour, stops: &mut Vec<[f32; 4]>) -> GpuColour {
    let two = |kind: u32, low: glam::Vec3, high: glam::Vec3| GpuColour {
        low: low.to_array(),
        kind,
        high: high.to_array(),
        ..GpuColour::default()
    };
    match colour {
        Colour::Flat(colour) => two(KIND_FLAT, *colour, *colour),
        Colour::Hash(low, high) => two(KIND_HASH, *low, *high),
        Colour::DitherX {
            from,
            to,
            low,
            high,
        } => GpuColour {
            from_x: *from,
            to_x: *to,
            ..two(KIND_DITHER_X, *low, *high)
        },
        Colour::Bands { below, above } => {
            let first_stop = stops.len() as u32;
            stops.extend(
                below
                    .iter()
                    .map(|(height, colour)| [*height, colour.x, colour.y, colour.z]),
            );
            GpuColour {
                first_stop,
                stop_count: below.len() as u32,
                ..two(KIND_BANDS, *above, *above)
            }
        }
    }
}
