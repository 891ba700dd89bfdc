//! Random numbers that depend only on the seed, the pixel and the sample, never on the thread.

use std::f64::consts::TAU;

use glam::DVec3;

/// PCG-XSH-RR 64/32 (O'Neill 2014).
#[derive(Clone, Debug)]
pub struct Pcg {
    state: u64,
    increment: u64,
}

impl Pcg {
    /// A separate stream for one sample of one pixel.
    pub fn new(seed: u64, pixel: u64, sample: u64) -> Self {
        let stream = mixed(seed ^ mixed(pixel));
        let mut random = Self {
            state: mixed(stream ^ mixed(sample)),
            increment: stream << 1 | 1,
        };
        random.next_u32();
        random
    }

    fn next_u32(&mut self) -> u32 {
        let old = self.state;
        self.state = old
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(self.increment);
        let shifted = ((old >> 18 ^ old) >> 27) as u32;
        shifted.rotate_right((old >> 59) as u32)
    }

    /// Uniform in [0, 1), all 53 bits of the fraction.
    pub fn unit(&mut self) -> f64 {
        let high = u64::from(self.next_u32()) << 21;
        let low = u64::from(self.next_u32()) >> 11;
        (high | low) as f64 / (1u64 << 53) as f64
    }

    /// A unit direction about the positive or negative `axis` (0 x, 1 y, 2 z) with probability density
    /// cosine/π: a uniform point of the disc, projected up to the hemisphere (Malley's method).
    pub fn cosine_direction(&mut self, axis: usize, positive: bool) -> DVec3 {
        let squared_radius = self.unit();
        let (sin, cos) = (TAU * self.unit()).sin_cos();
        let radius = squared_radius.sqrt();
        // 1 − u lies in (0, 1], so that no direction lies in the surface.
        let height = (1.0 - squared_radius).sqrt();
        let mut direction = DVec3::ZERO;
        direction[axis] = if positive { height } else { -height };
        direction[(axis + 1) % 3] = radius * cos;
        direction[(axis + 2) % 3] = radius * sin;
        direction
    }
}

/// Spreads every bit of the input over the output (the finaliser of SplitMix64, Steele 2014).
fn mixed(value: u64) -> u64 {
    let z = value.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ z >> 31
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::statistics::MeanEstimate;

    /// The first outputs of pcg32-demo (`pcg32_srandom(42, 54)`) from the generator's own sources.
    #[test]
    fn the_generator_gives_the_published_numbers() {
        let mut random = Pcg {
            state: 0,
            increment: 54 << 1 | 1,
        };
        random.next_u32();
        random.state = random.state.wrapping_add(42);
        random.next_u32();
        let published = [
            0xa15c_02b7,
            0x7b47_f409,
            0xba1d_3330,
            0x83d2_f293,
            0xbfa4_784b,
            0xcbed_606e,
        ];
        assert_eq!(published.map(|_| random.next_u32()), published);
    }

    #[test]
    fn neighbouring_streams_are_uniform_and_unrelated() {
        let first = |pixel, sample| Pcg::new(7, pixel, sample).unit();
        for (name, values) in [
            (
                "pixels",
                (0..20_000).map(|i| first(i, 0)).collect::<Vec<_>>(),
            ),
            ("samples", (0..20_000).map(|i| first(3, i)).collect()),
        ] {
            let mean = MeanEstimate::of(values.iter().copied()).expect("not empty");
            assert!(mean.agrees_with(0.5, 4.0, 0.0), "{name}: {mean:?}");
            let lagged = values
                .windows(2)
                .map(|pair| (pair[0] - 0.5) * (pair[1] - 0.5));
            let correlation = MeanEstimate::of(lagged).expect("not empty");
            assert!(
                correlation.agrees_with(0.0, 4.0, 0.0),
                "{name}: {correlation:?}"
            );
        }
    }

    #[test]
    fn cosine_directions_have_the_moments_of_their_density() {
        let mut random = Pcg::new(1, 2, 3);
        let directions: Vec<DVec3> = (0..50_000)
            .map(|_| random.cosine_direction(1, false))
            .collect();
        let agrees = |truth: f64, value: &dyn Fn(DVec3) -> f64| {
            let mean = MeanEstimate::of(directions.iter().map(|&d| value(d))).expect("not empty");
            assert!(mean.agrees_with(truth, 4.0, 0.0), "{truth}: {mean:?}");
        };
        agrees(-2.0 / 3.0, &|d| d.y);
        agrees(0.5, &|d| d.y * d.y);
        agrees(0.0, &|d| d.x);
        agrees(0.25, &|d| d.z * d.z);
        assert!(
            directions
                .iter()
                .all(|d| d.y < 0.0 && (d.length() - 1.0).abs() < 1e-12)
        );
    }
}
