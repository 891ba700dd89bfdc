//! Directions of probe rays: one fixed, even set, rotated at random every frame; or a few rotated sets in turn, where
//! probes keep what their rays hit.

use glam::{DQuat, DVec3};

use crate::parameters::{ProbeHits, ProbeParameters, RayLattice};

/// Direction i of n on the spherical Fibonacci lattice (Keinert et al. 2015; the offset of half a
/// step keeps the set symmetric about the equator).
pub fn fibonacci(i: u32, n: u32) -> DVec3 {
    let golden_ratio_conjugate = (5f64.sqrt() - 1.0) / 2.0;
    let turn = (f64::from(i) * golden_ratio_conjugate).fract() * std::f64::consts::TAU;
    let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(n);
    let radius = (1.0 - z * z).sqrt();
    DVec3::new(radius * turn.cos(), radius * turn.sin(), z)
}

/// Direction i of n on a latitude-longitude lattice: about √(n/2) rows, whose heights are in proportion to their
/// directions, so that every direction stands for a solid angle of 4π/n.
pub fn latlong(i: u32, n: u32) -> DVec3 {
    let rows = (f64::from(n) / 2.0).sqrt().round().max(1.0) as u64;
    let (i, n) = (u64::from(i), u64::from(n));
    let first = |row: u64| row * n / rows;
    // The row that has direction i: first(row) ≤ i < first(row + 1).
    let row = ((i + 1) * rows - 1) / n;
    let (start, end) = (first(row), first(row + 1));
    let z = 1.0 - (start + end) as f64 / n as f64;
    let radius = (1.0 - z * z).sqrt();
    let turn = ((i - start) as f64 + 0.5) / (end - start) as f64 * std::f64::consts::TAU;
    DVec3::new(radius * turn.cos(), radius * turn.sin(), z)
}

/// The set of kept hits that updates of a frame take: the fractional part of the frame's number times the golden ratio, in
/// `sets` equal parts. A probe that is updated in every k-th frame only still takes all sets equally often, whatever k is
/// (Weyl 1916, "Über die Gleichverteilung von Zahlen mod. Eins"): the ratio times k is irrational, too.
pub fn set_of_frame(frame: u64, sets: u32) -> u32 {
    /// The golden ratio's fractional part times 2³².
    const GOLDEN: u64 = 0x9e37_79b9;
    let fraction = frame.wrapping_mul(GOLDEN) & 0xffff_ffff;
    ((fraction * u64::from(sets)) >> 32) as u32
}

/// The directions of one set of kept hits. The first is the lattice itself, the others are turned; the seed of a run does
/// not change them.
pub fn kept_directions(parameters: &ProbeParameters, set: u32) -> Vec<DVec3> {
    let sets = parameters.hit_sets;
    let turned = even_rotation(set, sets) * even_rotation(0, sets).inverse();
    on_lattice(parameters.lattice, parameters.rays, turned)
}

/// Rotation i of n that lie evenly among all rotations: super-Fibonacci spirals (Alexa 2022). Few random rotations
/// would leave gaps, and all sets would miss the same bright thing.
fn even_rotation(i: u32, n: u32) -> DQuat {
    use std::f64::consts::{SQRT_2, TAU};
    /// ψ⁴ = ψ + 4.
    const PSI: f64 = 1.533_751_168_755_204_3;
    let s = f64::from(i) + 0.5;
    let (a, b) = ((s / f64::from(n)).sqrt(), (1.0 - s / f64::from(n)).sqrt());
    let (sin_a, cos_a) = (TAU * s / SQRT_2).sin_cos();
    let (sin_b, cos_b) = (TAU * s / PSI).sin_cos();
    DQuat::from_xyzw(a * sin_a, a * cos_a, b * sin_b, b * cos_b).normalize()
}

/// The directions of all probes in one frame, as the parameters say; `rays` are those of an update.
pub fn directions_of_frame(
    parameters: &ProbeParameters,
    rays: u32,
    seed: u64,
    frame: u64,
) -> Vec<DVec3> {
    match parameters.hits {
        ProbeHits::Traced => on_lattice(parameters.lattice, rays, rotation(seed, frame)),
        ProbeHits::Kept => kept_directions(parameters, set_of_frame(frame, parameters.hit_sets)),
    }
}

fn on_lattice(lattice: RayLattice, rays: u32, turned: DQuat) -> Vec<DVec3> {
    let point = match lattice {
        RayLattice::Fibonacci => fibonacci,
        RayLattice::LatLong => latlong,
    };
    (0..rays).map(|i| turned * point(i, rays)).collect()
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

/// The directions of all probes in one frame under default parameters.
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
    fn latitude_and_longitude_divide_the_sphere_evenly() {
        for n in [8, 9, 64, 100, 128, 401, 2025] {
            assert_isotropic((0..n).map(|i| latlong(i, n)), 1.5 / f64::from(n));
            // Each row's band of the sphere is as large as its share of the directions.
            let heights: Vec<f64> = (0..n).map(|i| latlong(i, n).z).collect();
            let mut top = 1.0;
            for row in heights.chunk_by(|a, b| a == b) {
                let band = 2.0 * row.len() as f64 / f64::from(n);
                assert!((top - band / 2.0 - row[0]).abs() < 1e-12, "{n}: {row:?}");
                top -= band;
            }
            assert!((top + 1.0).abs() < 1e-9, "{n}: the rows end at the pole");
        }
        let rows = |n| {
            let heights: Vec<f64> = (0..n).map(|i| latlong(i, n).z).collect();
            heights.chunk_by(|a, b| a == b).count()
        };
        assert_eq!((rows(64), rows(128)), (6, 8));
    }

    #[test]
    fn every_interval_of_updates_takes_all_sets_equally_often() {
        for sets in [1, 2, 3, 4, 8, 10, 16] {
            for interval in [1, 2, 4, 8, 10] {
                for turn in [0, interval - 1] {
                    let mut taken = vec![0u32; sets as usize];
                    for update in 0..256u32 {
                        let frame = u64::from(update * interval + turn);
                        taken[set_of_frame(frame, sets) as usize] += 1;
                    }
                    let expected = 256.0 / f64::from(sets);
                    for count in taken {
                        let off = (f64::from(count) / expected - 1.0).abs();
                        assert!(off < 0.2, "{sets} sets, interval {interval}: {count}");
                    }
                }
            }
        }
        // Frame number modulo sets would fail: every second frame takes the even half of 8 sets alone.
        assert!((0..64).map(|update| 2 * update % 8).all(|set| set % 2 == 0));
    }

    #[test]
    fn kept_sets_are_the_lattice_and_rotations_of_it() {
        let parameters = ProbeParameters {
            hits: ProbeHits::Kept,
            hit_sets: 4,
            rays: 64,
            ..ProbeParameters::default()
        };
        for lattice in [RayLattice::Fibonacci, RayLattice::LatLong] {
            let parameters = ProbeParameters {
                lattice,
                ..parameters.clone()
            };
            let sets: Vec<_> = (0..4)
                .map(|set| kept_directions(&parameters, set))
                .collect();
            let point = match lattice {
                RayLattice::Fibonacci => fibonacci,
                RayLattice::LatLong => latlong,
            };
            for (turned, i) in sets[0].iter().zip(0..) {
                assert!(turned.distance(point(i, 64)) < 1e-12, "the lattice itself");
            }
            for (set, directions) in sets.iter().enumerate() {
                assert_isotropic(directions.iter().copied(), 2.0 / 64.0);
                let others = &sets[set + 1..];
                assert!(
                    others
                        .iter()
                        .all(|other| other[0].dot(directions[0]) < 0.999)
                );
            }
        }
        let of_frame = |frame| directions_of_frame(&parameters, 64, 7, frame);
        for frame in 0..40 {
            let set = set_of_frame(frame, 4);
            assert_eq!(of_frame(frame), kept_directions(&parameters, set));
        }
        assert_ne!(of_frame(0), of_frame(1));
        let traced = ProbeParameters::default();
        let plain: Vec<DVec3> = directions(128, 7, 3).collect();
        assert_eq!(directions_of_frame(&traced, 128, 7, 3), plain);
    }

    #[test]
    fn a_rotated_set_stays_even() {
        assert_isotropic(directions(400, 7, 3), 0.005);
    }

    /// Largest distance of a rotation from the nearest of a set, as an angle in radians.
    fn largest_gap(set: &[DQuat]) -> f64 {
        let apart = |a: &DQuat| {
            let near = |b: &DQuat| a.dot(*b).abs().min(1.0);
            2.0 * set.iter().map(near).fold(0.0, f64::max).acos()
        };
        let probing: Vec<DQuat> = (0..2000).map(|frame| rotation(3, frame)).collect();
        probing.iter().map(apart).fold(0.0, f64::max)
    }

    #[test]
    fn turned_sets_leave_smaller_gaps_than_random_rotations() {
        for n in [16, 64] {
            let even: Vec<DQuat> = (0..n).map(|i| even_rotation(i, n)).collect();
            let random = |seed| -> Vec<DQuat> {
                let frames = 0..u64::from(n);
                frames.map(|frame| rotation(seed, frame)).collect()
            };
            let gaps = (0..10).map(|seed| largest_gap(&random(seed)));
            let mean = gaps.sum::<f64>() / 10.0;
            assert!(
                largest_gap(&even) < mean,
                "{n}: {} {mean}",
                largest_gap(&even)
            );
        }
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
