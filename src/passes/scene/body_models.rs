//! Models of bodies as the GPU reads them.

use glam::UVec3;

use super::hierarchy::Bounds;
use crate::world::bodies::{Bodies, BodyModel};

/// Edge of a block in voxels.
const BLOCK: u32 = 4;

/// What the buffers of bodies hold at most.
#[derive(Clone, Copy)]
pub(super) struct Room {
    pub bodies: usize,
    /// Vectors of all models.
    pub models: usize,
}

impl Room {
    pub fn of(bodies: &Bodies) -> Self {
        Self {
            bodies: bodies.bodies.len(),
            models: bodies.models.iter().map(vectors_of).sum(),
        }
    }
}

pub(super) fn blocks_of(size: UVec3) -> UVec3 {
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
fn places(extent: UVec3) -> impl Iterator<Item = UVec3> {
    let rows = (0..extent.z).flat_map(move |z| (0..extent.y).map(move |y| (y, z)));
    rows.flat_map(move |(y, z)| (0..extent.x).map(move |x| UVec3::new(x, y, z)))
}

/// 64 bits for each block, two blocks in a vector.
pub(super) fn masks(model: &BodyModel) -> Vec<[u32; 4]> {
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
pub(super) fn materials(model: &BodyModel) -> Vec<[u32; 4]> {
    let extent = blocks_of(model.size) * BLOCK;
    let bytes: Vec<u8> = places(extent).map(|at| material(model, at)).collect();
    // The extent is a multiple of 64 voxels.
    bytes.chunks(16).map(bytemuck::pod_read_unaligned).collect()
}

/// The box around the solid voxels; around the first corner where there are none.
pub(super) fn solid(model: &BodyModel) -> Bounds {
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

/// Vectors of the masks and of the materials of a model.
fn vectors_of(model: &BodyModel) -> usize {
    let blocks = blocks_of(model.size).element_product() as usize;
    blocks.div_ceil(2) + blocks * (BLOCK * BLOCK * BLOCK) as usize / 16
}
