//! Models of bodies as the shaders read them (`shaders/scene/bodies.wesl`).

use glam::{IVec3, UVec3};

use super::{
    body_emitters::EmissiveFaces, body_lit_faces::LitFaces, body_supports::Supports,
    hierarchy::Bounds,
};
use crate::world::bodies::BodyModel;

/// Edge of a block in voxels.
pub const BLOCK: u32 = 4;
pub const FACES: [IVec3; 6] = [
    IVec3::NEG_X,
    IVec3::X,
    IVec3::NEG_Y,
    IVec3::Y,
    IVec3::NEG_Z,
    IVec3::Z,
];

/// Blocks along each axis of a model of this size in voxels.
pub fn blocks_of(size: UVec3) -> UVec3 {
    size.map(|edge| edge.div_ceil(BLOCK))
}

/// The material of a voxel, 0 beyond the model's end.
fn material(model: &BodyModel, at: UVec3) -> u8 {
    if at.cmpge(model.size).any() {
        return 0;
    }
    model.materials[(at.x + model.size.x * (at.y + model.size.y * at.z)) as usize]
}

/// All places of a box of this extent, x first.
pub fn places(extent: UVec3) -> impl Iterator<Item = UVec3> {
    let rows = (0..extent.z).flat_map(move |z| (0..extent.y).map(move |y| (y, z)));
    rows.flat_map(move |(y, z)| (0..extent.x).map(move |x| UVec3::new(x, y, z)))
}

/// 64 bits for each block, two blocks in a vector.
fn masks(model: &BodyModel) -> Vec<[u32; 4]> {
    let mask = |block: UVec3| {
        let bits = places(UVec3::splat(BLOCK)).enumerate();
        bits.fold(0u64, |mask, (bit, at)| {
            let is_solid = material(model, block * BLOCK + at) != 0;
            mask | u64::from(is_solid) << bit
        })
    };
    let all: Vec<u64> = places(blocks_of(model.size)).map(mask).collect();
    let words = |mask: u64| [mask as u32, (mask >> 32) as u32];
    all.chunks(2)
        .map(|pair| {
            let [low, high] = words(pair[0]);
            let [next_low, next_high] = words(pair.get(1).copied().unwrap_or(0));
            [low, high, next_low, next_high]
        })
        .collect()
}

/// A byte for each voxel of the blocks' extent.
fn materials(model: &BodyModel) -> Vec<[u32; 4]> {
    let extent = blocks_of(model.size) * BLOCK;
    let bytes: Vec<u8> = places(extent).map(|at| material(model, at)).collect();
    // The extent is a multiple of 64 voxels.
    bytes.chunks(16).map(bytemuck::pod_read_unaligned).collect()
}

/// A face of a voxel in a word: x, y and z in six bits each, then the face.
pub fn packed_face(voxel: UVec3, face: usize) -> u32 {
    voxel.x | voxel.y << 6 | voxel.z << 12 | (face as u32) << 18
}

/// Four words in a vector; zeros after the last.
pub fn in_fours(words: &[u32]) -> Vec<[u32; 4]> {
    let four = |words: &[u32]| std::array::from_fn(|i| words.get(i).copied().unwrap_or(0));
    words.chunks(4).map(four).collect()
}

/// The box around the solid voxels; around the first corner where there are none.
fn solid(model: &BodyModel) -> Bounds {
    let solid = places(model.size).filter(|at| material(model, *at) != 0);
    let found = solid.fold(None, |found: Option<(UVec3, UVec3)>, at| {
        let (low, high) = found.unwrap_or((at, at));
        Some((low.min(at), high.max(at)))
    });
    let (low, high) = found.map_or((UVec3::ZERO, UVec3::ZERO), |(low, high)| (low, high + 1));
    Bounds {
        low: low.as_vec3(),
        high: high.as_vec3(),
    }
}

/// A model as it lies in the buffer.
pub struct GpuModel {
    /// Masks, materials, the faces with stored light, and the emissive faces.
    pub vectors: Vec<[u32; 4]>,
    /// The first of the vectors with emissive faces.
    pub first_emissive: usize,
    pub emissive: EmissiveFaces,
    /// Number of faces with stored light.
    pub lit_faces: usize,
    /// Around the solid voxels (model space).
    pub solid: Bounds,
    pub supports: Supports,
    /// Blocks along each axis.
    pub blocks: UVec3,
}

impl GpuModel {
    /// `weights` are those of [`crate::lights::emitters::weights`].
    pub fn of(model: &BodyModel, weights: &[f64]) -> Self {
        let lit = LitFaces::of(model);
        let emissive = EmissiveFaces::of(model, weights);
        let mut vectors = masks(model);
        vectors.extend(materials(model));
        vectors.extend(lit.vectors());
        let first_emissive = vectors.len();
        vectors.extend(emissive.vectors());
        Self {
            vectors,
            first_emissive,
            emissive,
            lit_faces: lit.count(),
            solid: solid(model),
            supports: Supports::of(model),
            blocks: blocks_of(model.size),
        }
    }
}
