//! All randomness of the grammar: one stream of numbers from one seed.

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use super::term::Term;

/// Draws the same numbers for the same seed on every machine.
pub struct Dice(ChaCha8Rng);

impl Dice {
    /// `stream` separates the numbers for one purpose from all other numbers of the same seed.
    pub fn new(seed: u32, stream: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(u64::from(seed));
        rng.set_stream(stream);
        Self(rng)
    }

    /// In [0, 1).
    pub fn unit(&mut self) -> f64 {
        self.0.random::<f64>()
    }

    /// Whether something with this probability happens.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    /// A whole number from `low` to `high`, both included.
    pub fn whole(&mut self, low: u32, high: u32) -> u32 {
        self.0.random_range(low..=high)
    }

    /// A number between the two, with three decimals: short in a file, and unchanged when it is read back.
    pub fn number(&mut self, low: f64, high: f64) -> f64 {
        rounded(low + (high - low) * self.unit())
    }

    /// Like [`number`](Self::number), but every order of magnitude is equally likely. Both ends must be above
    /// 0.
    pub fn magnitude(&mut self, low: f64, high: f64) -> f64 {
        rounded((low.ln() + (high / low).ln() * self.unit()).exp()).max(0.001)
    }

    /// One of the items.
    pub fn pick<'a, T>(&mut self, of: &'a [T]) -> &'a T {
        &of[self.whole(0, of.len() as u32 - 1) as usize]
    }

    /// Three numbers, each between minus and plus the half extent of its axis.
    pub fn within(&mut self, half: [f64; 3]) -> Term {
        Term::vector(half.map(|half| self.number(-half, half)))
    }
}

/// Rounds to three decimals.
pub fn rounded(value: f64) -> f64 {
    (value * 1000.0).round() / 1000.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seeds_and_streams_are_repeatable_and_differ() {
        let draws = |seed, stream| {
            let mut dice = Dice::new(seed, stream);
            [dice.unit(), dice.unit(), dice.number(-4.0, 4.0)]
        };
        assert_eq!(draws(3, 0), draws(3, 0));
        assert_ne!(draws(3, 0), draws(4, 0));
        assert_ne!(draws(3, 0), draws(3, 1));
    }
}
