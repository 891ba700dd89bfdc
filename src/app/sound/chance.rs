//! Random numbers that repeat: the same seed gives the same sound, bit for bit.

/// Marsaglia 2003, "Xorshift RNGs": 32 bits of state. Its statistics are enough for noise and directions.
#[derive(Clone, Debug)]
pub struct Chance(u32);

impl Chance {
    /// Neighbouring seeds give unrelated numbers: the state is the seed after the finaliser of MurmurHash3.
    pub fn new(seed: u32) -> Self {
        let mut state = seed ^ 0x9e37_79b9;
        state = (state ^ state >> 16).wrapping_mul(0x85eb_ca6b);
        state = (state ^ state >> 13).wrapping_mul(0xc2b2_ae35);
        state ^= state >> 16;
        // Zero is the one state that xorshift never leaves.
        Self(state.max(1))
    }

    fn next(&mut self) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        self.0
    }

    /// In [0, 1).
    pub fn unit(&mut self) -> f32 {
        (self.next() >> 8) as f32 / (1 << 24) as f32
    }

    /// In [−1, 1): white noise.
    pub fn signed(&mut self) -> f32 {
        2.0 * self.unit() - 1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_fill_their_range_evenly_and_repeat() {
        for seed in [0, 1, u32::MAX] {
            let mut chance = Chance::new(seed);
            let many: Vec<f32> = (0..40_000).map(|_| chance.signed()).collect();
            let mean = many.iter().sum::<f32>() / 40_000.0;
            let square = many.iter().map(|x| x * x).sum::<f32>() / 40_000.0;
            assert!(mean.abs() < 0.02, "{mean}");
            assert!((square - 1.0 / 3.0).abs() < 0.01, "{square}");
            let mut again = Chance::new(seed);
            assert!(many.iter().all(|x| x.to_bits() == again.signed().to_bits()));
        }
        assert_ne!(Chance::new(7).unit(), Chance::new(8).unit());
    }
}
