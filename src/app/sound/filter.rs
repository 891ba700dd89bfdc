//! A filter whose frequency may change at every sample, and a resonance.

use std::f32::consts::{PI, TAU};

/// The state-variable filter of Simper 2013 ("Linear trapezoidal integrated SVF"; after Zavalishin 2012): second
/// order, stable at every frequency below half the sampling rate.
#[derive(Clone, Debug, Default)]
pub struct Filter {
    first: f32,
    second: f32,
}

/// What a [`Filter`] lets pass, for a frequency and a sampling rate.
#[derive(Clone, Copy, Debug)]
pub struct Pass {
    gain: f32,
    damping: f32,
    share: f32,
}

/// One sample after the filter: what lies below the frequency, and what lies around it.
#[derive(Clone, Copy, Debug)]
pub struct Filtered {
    pub low: f32,
    /// With gain 1 at the frequency itself.
    pub band: f32,
}

impl Pass {
    /// `quality`: the frequency over the width of the band.
    pub fn new(frequency_hz: f32, quality: f32, rate_hz: f32) -> Self {
        let highest = 0.45 * rate_hz;
        let gain = (PI * frequency_hz.clamp(1.0, highest) / rate_hz).tan();
        let damping = 1.0 / quality;
        Self {
            gain,
            damping,
            share: 1.0 / (1.0 + gain * (gain + damping)),
        }
    }
}

impl Filter {
    pub fn next(&mut self, input: f32, pass: &Pass) -> Filtered {
        let rest = input - self.second;
        let band = pass.share * (self.first + pass.gain * rest);
        let low = self.second + pass.gain * band;
        self.first = 2.0 * band - self.first;
        self.second = 2.0 * low - self.second;
        Filtered {
            low,
            band: pass.damping * band,
        }
    }
}

/// A sine that fades, as a struck solid gives it off (a mode; van den Doel & Pai 1998): a number that turns in the
/// complex plane and shrinks.
#[derive(Clone, Copy, Debug, Default)]
pub struct Mode {
    sine: f32,
    cosine: f32,
    turn: (f32, f32),
}

impl Mode {
    /// `fade_s`: seconds until its amplitude has fallen to a thousandth.
    pub fn new(frequency_hz: f32, fade_s: f32, amplitude: f32, rate_hz: f32) -> Self {
        let angle = TAU * frequency_hz.min(0.45 * rate_hz) / rate_hz;
        let shrink = 0.001_f32.powf(1.0 / (fade_s * rate_hz));
        Self {
            sine: 0.0,
            cosine: amplitude,
            turn: (shrink * angle.cos(), shrink * angle.sin()),
        }
    }

    pub fn next(&mut self) -> f32 {
        let (cos, sin) = self.turn;
        let sine = self.sine * cos + self.cosine * sin;
        self.cosine = self.cosine * cos - self.sine * sin;
        self.sine = sine;
        sine
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE_HZ: f32 = 48_000.0;

    /// Amplitude of a sine after the filter: of its low side, and of its band.
    fn response(pass: &Pass, frequency_hz: f32) -> (f32, f32) {
        let mut filter = Filter::default();
        let (mut low, mut band) = (0.0_f32, 0.0_f32);
        for sample in 0..24_000 {
            let sine = (TAU * frequency_hz * sample as f32 / RATE_HZ).sin();
            let out = filter.next(sine, pass);
            if sample > 12_000 {
                low = low.max(out.low.abs());
                band = band.max(out.band.abs());
            }
        }
        (low, band)
    }

    #[test]
    fn the_band_passes_and_what_is_far_from_it_does_not() {
        let pass = Pass::new(1000.0, 2.0, RATE_HZ);
        let (_, band) = response(&pass, 1000.0);
        assert!((band - 1.0).abs() < 0.02, "{band}");
        let (low, band) = response(&pass, 50.0);
        assert!((low - 1.0).abs() < 0.02 && band < 0.05, "{low} {band}");
        let (low, band) = response(&pass, 15_000.0);
        assert!(low < 0.01 && band < 0.05, "{low} {band}");
    }

    #[test]
    fn a_mode_sounds_at_its_frequency_and_fades_in_its_time() {
        let mut mode = Mode::new(440.0, 0.5, 1.0, RATE_HZ);
        let samples: Vec<f32> = (0..24_000).map(|_| mode.next()).collect();
        let rises = samples
            .windows(2)
            .filter(|pair| pair[0] < 0.0 && pair[1] >= 0.0);
        assert!(rises.count().abs_diff(220) <= 1, "440 Hz for half a second");
        let last = samples[23_800..]
            .iter()
            .fold(0.0_f32, |most, x| most.max(x.abs()));
        assert!((0.0009..0.0012).contains(&last), "{last}");
    }
}
