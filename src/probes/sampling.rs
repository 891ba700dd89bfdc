//! Directions of probe rays: one fixed, even set, rotated at random every frame.

use glam::{DQuat, DVec3};

/// Direction i of n on the spherical Fibonacci lattice (Keinert et al. 2015; the offset of half a
/// step keeps the set symmetric about the equator).
pub fn fibonacci(i: u32, n: u32) -> DVec3 {
    let golden_ratio_conjugate = (5f64.sqrt() - 1.0) / 2.0;
    let turn = (f64::from(i) * golden_ratio_conjugate).fract() * std::f64::consts::TAU;
    let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(n);
    let radius = (1.0 - z * z).sqrt();
    DVec3::new(radius * turn.cos(), radius * turn.sin(), z)
}

/// A rotation from the uniform distribution over all rotations (Shoemake 1992, "Uniform random
/// rotations", Graphics Gems III). The same seed and frame give the same rotation.
pub fn rotation(seed: u64, frame: u64) -> DQuat {
    let mut state = mix(seed ^ mix(frame));
    let mut uniform = || {
        state = state.wrapping_add(WEYL);
        (mix(state) >> 11) as f64 / (1u64 << 53) as f64
    };
    let (u1, u2, u3) = (uniform(), uniform(), uniform());
    let (sin2, cos2) = (u2 * std::f64::consts::TAU).sin_cos();
    let (sin3, cos3) = (u3 * std::f64::consts::TAU).sin_cos();
    let (a, b) = ((1.0 - u1).sqrt(), u1.sqrt());
    DQuat::from_xyzw(a * sin2, a * cos2, b * sin3, b * cos3).normalize()
}

/// The directions of all probes in one frame.
pub fn directions(rays: u32, seed: u64, frame: u64) -> impl Iterator<Item = DVec3> {
    let rotation = rotation(seed, frame);
    (0..rays).map(move |i| rotation * fibonacci(i, rays))
}

const WEYL: u64 = 0x9e37_79b9_7f4a_7c15;

/// The finaliser of SplitMix64 (Steele et al. 2014).
fn mix(mut z: u64) -> u64 {
    z = z.wrapping_add(WEYL);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moments(directions: impl Iterator<Item = DVec3>) -> (DVec3, [[f64; 3]; 3], f64) {
        let (mut mean, mut covariance, mut count) = (DVec3::ZERO, [[0.0; 3]; 3], 0.0);
        for d in directions {
            assert!((d.length() - 1.0).abs() < 1e-12);
            mean += d;
            for (a, row) in covariance.iter_mut().enumerate() {
                for (b, sum) in row.iter_mut().enumerate() {
                    *sum += d[a] * d[b];
                }
            }
            count += 1.0;
        }
        (
            mean / count,
            covariance.map(|r| r.map(|c| c / count)),
            count,
        )
    }

    fn assert_isotropic(directions: impl Iterator<Item = DVec3>, tolerance: f64) {
        let (mean, covariance, _) = moments(directions);
        assert!(mean.length() < tolerance, "mean {mean}");
        for (a, row) in covariance.iter().enumerate() {
            for (b, value) in row.iter().enumerate() {
                let expected = if a == b { 1.0 / 3.0 } else { 0.0 };
                assert!((value - expected).abs() < tolerance, "{a}{b}: {value}");
            }
        }
    }

    #[test]
    fn fibonacci_directions_have_no_mean_and_a_third_of_covariance() {
        for n in [64, 400, 2025] {
            assert_isotropic((0..n).map(|i| fibonacci(i, n)), 2.0 / f64::from(n));
        }
    }

    #[test]
    fn a_rotated_set_stays_even() {
        assert_isotropic(directions(400, 7, 3), 0.005);
    }

    #[test]
    fn rotations_take_any_direction_everywhere() {
        // Shoemake's construction is uniform: the images of one axis are uniform on the sphere.
        let axis = DVec3::new(1.0, 2.0, 3.0).normalize();
        assert_isotropic((0..20_000).map(|frame| rotation(1, frame) * axis), 0.02);
    }

    #[test]
    fn frames_differ_and_repeat() {
        assert_eq!(rotation(5, 9), rotation(5, 9));
        assert!(rotation(5, 9).angle_between(rotation(5, 10)) > 1e-3);
        assert!(rotation(5, 9).angle_between(rotation(6, 9)) > 1e-3);
    }
}
