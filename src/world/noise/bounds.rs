//! How large a field can be and how fast it can change.

use super::{Fractal, NoiseBank, NoiseField, RIDGE_ATTENUATION};

impl NoiseField {
    /// Number of permutation tables that the field reads: one per octave.
    pub fn octaves(&self) -> u32 {
        match self.fractal {
            Fractal::None => 1,
            Fractal::Fbm { octaves, .. }
            | Fractal::Ridged { octaves, .. }
            | Fractal::Billow { octaves, .. } => octaves.clamp(1, NoiseBank::MAX_OCTAVES),
        }
    }

    /// Factor of the sum of the octaves, so that the field keeps within its range.
    pub fn scale(&self) -> f64 {
        let octaves = self.octaves() as i32;
        match self.fractal {
            Fractal::None => 1.0,
            Fractal::Fbm { persistence, .. } | Fractal::Billow { persistence, .. } => {
                1.0 / (1..=octaves)
                    .map(|octave| persistence.powi(octave))
                    .sum::<f64>()
            }
            Fractal::Ridged { persistence, .. } => {
                let mut signal = 1.0;
                let mut sum = signal;
                for octave in 1..=octaves {
                    let weight: f64 = signal / RIDGE_ATTENUATION.powi(octave);
                    signal = weight.clamp(0.0, 1.0) * persistence.powi(octave);
                    sum += signal;
                }
                2.0 / sum
            }
        }
    }

    /// Upper bound of |value(p) − value(q)| over all p, q at most `radius` apart: each octave
    /// contributes its Lipschitz constant times its frequency times the radius, but at most the width
    /// of its range.
    pub fn variation(&self, radius: f64) -> f64 {
        self.variation_at_frequency(self.frequency.abs().max_element(), radius)
    }

    /// The same between points of a horizontal plane.
    pub fn variation_xz(&self, radius: f64) -> f64 {
        self.variation_at_frequency(self.frequency.x.abs().max(self.frequency.z.abs()), radius)
    }

    /// Lipschitz constant in world space: the slope of [`Self::variation`] at 0.
    pub fn lipschitz(&self) -> f64 {
        self.variation(SMALL_RADIUS) / SMALL_RADIUS
    }

    /// Lipschitz constant within a horizontal plane.
    pub fn lipschitz_xz(&self) -> f64 {
        self.variation_xz(SMALL_RADIUS) / SMALL_RADIUS
    }

    /// Upper bound of the absolute value.
    pub fn amplitude(&self) -> f64 {
        match self.fractal {
            Fractal::None | Fractal::Fbm { .. } => self.basis.amplitude(),
            Fractal::Billow { .. } => 1.0,
            Fractal::Ridged { persistence, .. } => {
                // The crate's scale underrates the later octaves, so ridges can exceed 1.
                let octaves = 0..self.octaves() as i32;
                let highest: f64 = octaves
                    .map(|octave| (persistence / RIDGE_ATTENUATION).powi(octave))
                    .sum();
                (highest * self.scale() - 1.0).max(1.0)
            }
        }
    }

    fn variation_at_frequency(&self, frequency: f64, radius: f64) -> f64 {
        // Both fractals of |noise| cover half the width of the range.
        let signed =
            |radius: f64| (self.basis.lipschitz() * radius).min(2.0 * self.basis.amplitude());
        let absolute = |radius: f64| (self.basis.lipschitz() * radius).min(self.basis.amplitude());
        let octaves = 0..self.octaves() as i32;
        let sum: f64 = match self.fractal {
            Fractal::None => signed(radius * frequency),
            Fractal::Fbm {
                lacunarity,
                persistence,
                ..
            } => octaves
                .map(|octave| {
                    persistence.powi(octave + 1)
                        * signed(radius * frequency * lacunarity.powi(octave))
                })
                .sum(),
            Fractal::Billow {
                lacunarity,
                persistence,
                ..
            } => octaves
                .map(|octave| {
                    persistence.powi(octave + 1)
                        * 2.0
                        * absolute(radius * frequency * lacunarity.powi(octave))
                })
                .sum(),
            Fractal::Ridged {
                lacunarity,
                persistence,
                ..
            } => {
                // signal = (1 − |noise|)²·weight; the next weight is half the signal.
                let mut weight = 1.0;
                let mut weight_variation = 0.0;
                octaves
                    .map(|octave| {
                        let ridge = absolute(radius * frequency * lacunarity.powi(octave));
                        let signal: f64 =
                            (weight * (2.0 * ridge).min(1.0) + weight_variation).min(weight);
                        weight = (weight / RIDGE_ATTENUATION).min(1.0);
                        weight_variation = (signal / RIDGE_ATTENUATION).min(weight);
                        persistence.powi(octave) * signal
                    })
                    .sum()
            }
        };
        sum * self.scale()
    }
}

/// A radius so small that no octave has reached the width of its range.
const SMALL_RADIUS: f64 = 1e-12;
