//! Numbers that probes store on the GPU in few bytes, as shaders pack them.

/// Mean distance and mean of squares that a texel of the distance atlas stores, in units of the longest distance and its
/// square: shaders/probes/moments.wesl.
pub fn distances_of(stored: u32) -> [f32; 2] {
    let share = |bits: u32| (bits & 0xffff) as f32 / 65535.0;
    let (mean, root) = (share(stored), share(stored >> 16));
    [mean, root * root]
}

/// Linear RGB that a texel of an irradiance map stores: shaders/probes/light.wesl.
pub fn light_of([low, high]: [u32; 2]) -> [f32; 3] {
    let bits = u64::from(low) | u64::from(high) << 32;
    let channel = |first: u32| ((bits >> first) & 0x7_ffff) as f32;
    let step = f32::powi(2.0, (bits >> 57) as i32 - 100 - 19);
    [0, 19, 38].map(|first| channel(first) * step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ends_of_the_scales_are_stored_exactly() {
        assert_eq!(distances_of(0), [0.0; 2]);
        assert_eq!(distances_of(0xffff_ffff), [1.0; 2]);
        assert_eq!(distances_of(0x8000_ffff)[0], 1.0);
        assert_eq!(light_of([0, 0]), [0.0; 3]);
        // 2¹⁸ steps of 2⁻¹⁸ in the first channel, 3 and 5 steps in the others.
        let exponent = 101 << 25;
        let found = light_of([1 << 18 | 3 << 19, 5 << 6 | exponent]);
        let step = 1.0 / 262_144.0;
        assert_eq!(found, [1.0, 3.0 * step, 5.0 * step]);
    }
}
