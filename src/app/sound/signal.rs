//! Measures of signals, for tests.

use std::f32::consts::TAU;

pub fn energy(samples: &[f32]) -> f32 {
    samples.iter().map(|x| x * x).sum()
}

pub fn peak(samples: &[f32]) -> f32 {
    samples.iter().fold(0.0, |most, x| most.max(x.abs()))
}

/// After a low-pass of the first order.
pub fn low_passed(samples: &[f32], frequency_hz: f32, rate_hz: f32) -> Vec<f32> {
    let keep = (-TAU * frequency_hz / rate_hz).exp();
    let mut low = 0.0;
    samples
        .iter()
        .map(|x| {
            low = keep * low + (1.0 - keep) * x;
            low
        })
        .collect()
}

/// Seconds in which a response fades by 60 dB: Schroeder 1965, "New method of measuring reverberation time". The
/// energy that is still to come falls along a line from −5 to −35 dB (ISO 3382-1: T30).
pub fn reverberation_s(response: &[f32], rate_hz: f32) -> f32 {
    let mut rest = 0.0_f64;
    let mut left: Vec<f64> = response
        .iter()
        .rev()
        .map(|x| {
            rest += f64::from(*x).powi(2);
            rest
        })
        .collect();
    left.reverse();
    let first_below = |db: f64| {
        let level = left[0] * 10_f64.powf(db / 10.0);
        left.iter()
            .position(|energy| *energy < level)
            .unwrap_or(left.len())
    };
    let (begin, end) = (first_below(-5.0), first_below(-35.0));
    2.0 * (end - begin) as f32 / rate_hz
}

/// The mean of a spectrum's frequencies, weighted by their amplitudes (Hz): whether a sound is bright or dull.
/// A plain Fourier transform at 64 frequencies in a geometric row.
pub fn centroid_hz(samples: &[f32], rate_hz: f32) -> f32 {
    let (mut sum, mut weighted) = (0.0, 0.0);
    for band in 0..64 {
        let frequency_hz = 40.0 * 1.0955_f32.powi(band);
        let (mut real, mut imaginary) = (0.0, 0.0);
        for (at, x) in samples.iter().enumerate() {
            let (sin, cos) = (TAU * (frequency_hz * at as f32 / rate_hz).fract()).sin_cos();
            real += x * cos;
            imaginary += x * sin;
        }
        // Bands of a geometric row are as wide as they are high.
        let amplitude = real.hypot(imaginary) * frequency_hz.sqrt();
        sum += amplitude;
        weighted += amplitude * frequency_hz;
    }
    weighted / sum
}

#[test]
fn the_measures_know_what_they_measure() {
    let rate_hz = 48_000.0;
    let sine = |frequency_hz: f32| -> Vec<f32> {
        (0..9600)
            .map(|at| (TAU * frequency_hz * at as f32 / rate_hz).sin())
            .collect()
    };
    assert!((energy(&sine(1000.0)) / 4800.0 - 1.0).abs() < 0.01);
    let dull = centroid_hz(&sine(200.0), rate_hz);
    let bright = centroid_hz(&sine(4000.0), rate_hz);
    assert!(dull < 500.0 && bright > 2500.0, "{dull} {bright}");
    let fading: Vec<f32> = (0..48_000)
        .map(|at| 0.001_f32.powf(at as f32 / 24_000.0) * if at % 2 == 0 { 1.0 } else { -1.0 })
        .collect();
    let measured = reverberation_s(&fading, rate_hz);
    assert!((measured - 0.5).abs() < 0.01, "{measured}");
}
