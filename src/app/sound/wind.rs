//! Wind, where the sky is open: noise below a frequency that rises and falls with the gusts.

use std::f32::consts::TAU;

use super::{
    chance::Chance,
    filter::{Filter, Pass},
};

/// Seconds between two gusts, about.
const GUST_S: f32 = 3.5;
/// Frequencies below which a calm and a gust sound (Hz).
const CALM_HZ: f32 = 180.0;
const GUST_HZ: f32 = 620.0;
/// Amplitude under an open sky.
const LOUDNESS: f32 = 0.16;

#[derive(Clone, Debug)]
pub struct Wind {
    chance: Chance,
    /// One ear after the other.
    ears: [Filter; 2],
    /// From calm (0) to a gust (1): now, and where it goes.
    gust: f32,
    next: f32,
    rate_hz: f32,
    pass: Pass,
}

impl Wind {
    pub fn new(seed: u32, rate_hz: f32) -> Self {
        Self {
            chance: Chance::new(seed),
            ears: Default::default(),
            gust: 0.3,
            next: 0.3,
            rate_hz,
            pass: Pass::new(CALM_HZ, 0.8, rate_hz),
        }
    }

    /// Lets some samples of weather pass.
    pub fn turn(&mut self, samples: u32) {
        let passed_s = samples as f32 / self.rate_hz;
        if self.chance.unit() < passed_s / GUST_S {
            self.next = self.chance.unit();
        }
        self.gust += (self.next - self.gust) * (1.0 - (-TAU * passed_s / GUST_S).exp());
        let frequency_hz = CALM_HZ * (GUST_HZ / CALM_HZ).powf(self.gust);
        self.pass = Pass::new(frequency_hz, 0.8, self.rate_hz);
    }

    /// At the left and the right ear, under an open sky.
    pub fn next(&mut self) -> [f32; 2] {
        let loudness = LOUDNESS * (0.25 + 0.75 * self.gust);
        // Wind comes from somewhere: a part of it is the same at both ears.
        let shared = self.chance.signed();
        self.ears.each_mut().map(|ear| {
            let own = self.chance.signed();
            loudness * ear.next(0.6 * shared + 0.8 * own, &self.pass).low
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::sound::signal::{centroid_hz, energy, peak};

    #[test]
    fn it_is_quiet_dull_and_never_quite_still() {
        let rate_hz = 48_000.0;
        let mut wind = Wind::new(5, rate_hz);
        let mut left = Vec::new();
        for block in 0..20 * 750 {
            wind.turn(64);
            let kept = block % 10 == 0;
            for _ in 0..64 {
                let [one, _] = wind.next();
                if kept {
                    left.push(one);
                }
            }
        }
        assert!(left.iter().all(|x| x.is_finite()));
        assert!(peak(&left) < 0.2, "{}", peak(&left));
        let seconds: Vec<f32> = left
            .chunks(4800)
            .map(|part| (energy(part) / 4800.0).sqrt())
            .collect();
        let most = seconds.iter().fold(0.0_f32, |a, b| a.max(*b));
        let least = seconds.iter().fold(1.0_f32, |a, b| a.min(*b));
        assert!(
            least > 0.0005 && most > 1.5 * least && most < 0.05,
            "{seconds:?}"
        );
        assert!(centroid_hz(&left[..9600], rate_hz) < 1500.0);
    }
}
