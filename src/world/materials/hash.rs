//! Whole-number hashes: the same bits here and in `shaders/math/hash.wesl`.

use glam::IVec3;

/// PCG output permutation: Jarzynski & Olano 2020, "Hash Functions for GPU Rendering".
pub fn hash(input: u32) -> u32 {
    let state = input.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}

/// The hash of a world-space voxel.
pub fn hash_voxel(voxel: IVec3) -> u32 {
    let [x, y, z] = voxel.to_array().map(|axis| axis as u32);
    hash(x ^ hash(y ^ hash(z)))
}

/// The upper 24 bits as a number in [0, 1), exactly representable.
pub fn unit(hash: u32) -> f32 {
    (hash >> 8) as f32 * (1.0 / 16_777_216.0)
}
