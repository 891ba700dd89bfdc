//! Numbers that probes store on the GPU in few bytes, as shaders pack them.

use half::f16;

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

/// The light low and high (linear RGB) of an axis of a probe's cube: shaders/probes/probe_cube.wesl.
pub fn axis(words: [u32; 4]) -> [f32; 6] {
    let half = |number: usize| f16::from_bits((words[number / 2] >> (16 * (number % 2))) as u16);
    [0, 1, 2, 3, 4, 5].map(|number| half(number).to_f32())
}

/// Linear RGB in 32 bits: shaders/light/packed_radiance.wesl.
pub fn radiance_of(stored: u32) -> [f32; 3] {
    let step = f32::powi(2.0, (stored >> 27) as i32 - 15 - 9);
    [0, 9, 18].map(|first| ((stored >> first) & 511) as f32 * step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_is_unpacked() {
        let [one, two, half] =
            [1.0, 2.0, 0.5].map(|number| u32::from(f16::from_f32(number).to_bits()));
        let words = [
            one | two << 16,
            half | half << 16,
            two | one << 16,
            u32::MAX,
        ];
        assert_eq!(axis(words), [1.0, 2.0, 0.5, 0.5, 2.0, 1.0]);
        // 256 steps of 2⁻⁸, and 511 and 1 of 2⁻⁹.
        assert_eq!(radiance_of(256 | 16 << 27), [1.0, 0.0, 0.0]);
        let step = 1.0 / 512.0;
        let packed = 511 << 9 | 1 << 18 | 15 << 27;
        assert_eq!(radiance_of(packed), [0.0, 511.0 * step, step]);
    }

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
