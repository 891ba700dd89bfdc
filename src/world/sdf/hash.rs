//! The hash that places scattered copies: the same on the CPU and on the GPU
//! (`shaders/sdf/scatter.wesl`).

use glam::UVec3;

/// PCG in three dimensions: Jarzynski & Olano 2020, "Hash Functions for GPU Rendering".
pub fn pcg3d(v: UVec3) -> UVec3 {
    let mix = |mut v: UVec3| {
        v.x = v.x.wrapping_add(v.y.wrapping_mul(v.z));
        v.y = v.y.wrapping_add(v.z.wrapping_mul(v.x));
        v.z = v.z.wrapping_add(v.x.wrapping_mul(v.y));
        v
    };
    let lcg = |v: u32| v.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    let v = mix(UVec3::new(lcg(v.x), lcg(v.y), lcg(v.z)));
    mix(v ^ (v >> 16))
}

/// The top 24 bits of a hash as a number in [0, 1): exact in an f32.
pub fn unit(hash: u32) -> f32 {
    (hash >> 8) as f32 / 16_777_216.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pcg3d_is_the_published_function() {
        // Computed by hand from the paper's listing for v = 0: lcg gives c in every component.
        let c: u32 = 1_013_904_223;
        let step = |v: [u32; 3]| {
            let x = v[0].wrapping_add(v[1].wrapping_mul(v[2]));
            let y = v[1].wrapping_add(v[2].wrapping_mul(x));
            [x, y, v[2].wrapping_add(x.wrapping_mul(y))]
        };
        let wanted = step(step([c; 3]).map(|v| v ^ (v >> 16)));
        assert_eq!(pcg3d(UVec3::ZERO).to_array(), wanted);
    }
}
