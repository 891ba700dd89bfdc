//! The spatial filters of the FLIP observer: blurs, and detectors of edges and points.

use rayon::prelude::*;

/// Width w of the feature detectors in degrees: the detail that the eye resolves best.
const FEATURE_WIDTH_DEG: f64 = 0.082;

/// One number per pixel, row by row.
pub struct Plane {
    pub width: usize,
    pub values: Vec<f32>,
}

impl Plane {
    /// Convolved along x. `taps` has an odd length; its middle is the pixel itself.
    pub fn rows(&self, taps: &[f32]) -> Self {
        let radius = taps.len() / 2;
        let mut values = vec![0.0; self.values.len()];
        let rows = values.par_chunks_mut(self.width);
        rows.zip(self.values.par_chunks(self.width)).for_each_init(
            Vec::new,
            |padded: &mut Vec<f32>, (out, row)| {
                padded.clear();
                padded.extend(std::iter::repeat_n(row[0], radius));
                padded.extend_from_slice(row);
                padded.extend(std::iter::repeat_n(row[row.len() - 1], radius));
                for (tap, shifted) in taps.iter().zip(padded.windows(row.len())) {
                    add_scaled(out, *tap, shifted);
                }
            },
        );
        Self {
            width: self.width,
            values,
        }
    }

    /// Convolved along y.
    pub fn columns(&self, taps: &[f32]) -> Self {
        let (radius, last) = (taps.len() / 2, self.values.len() / self.width - 1);
        let mut values = vec![0.0; self.values.len()];
        let rows = values.par_chunks_mut(self.width).enumerate();
        rows.for_each(|(y, out)| {
            for (k, tap) in taps.iter().enumerate() {
                let from = (y + k).saturating_sub(radius).min(last);
                add_scaled(out, *tap, &self.values[from * self.width..][..self.width]);
            }
        });
        Self {
            width: self.width,
            values,
        }
    }
}

fn add_scaled(sums: &mut [f32], scale: f32, values: &[f32]) {
    for (sum, value) in sums.iter_mut().zip(values) {
        *sum += scale * value;
    }
}

/// A blur: a weighted sum of Gaussians.
pub struct Blur(Vec<(f32, Vec<f32>)>);

impl Blur {
    /// The inverse transform of a contrast sensitivity: Σ a √(π/b) exp(−π² r²/b), r in degrees,
    /// as (a, b) of each term; its sum over the pixels is 1.
    pub fn new(terms: &[(f64, f64)], radius: i32, pixels_per_degree: f64) -> Self {
        use std::f64::consts::PI;
        let parts = terms.iter().map(|&(a, b)| {
            let taps = symmetric(radius, |x| {
                (-(PI * x / pixels_per_degree).powi(2) / b).exp()
            });
            let sum: f64 = taps.iter().sum();
            let normalised = taps.iter().map(|tap| (tap / sum) as f32).collect();
            (a * (PI / b).sqrt() * sum * sum, normalised)
        });
        let parts: Vec<(f64, Vec<f32>)> = parts.collect();
        let total: f64 = parts.iter().map(|(weight, _)| weight).sum();
        let shares = parts
            .into_iter()
            .map(|(w, taps)| ((w / total) as f32, taps));
        Self(shares.collect())
    }

    pub fn applied(&self, plane: &Plane) -> Plane {
        let mut sums = Plane {
            width: plane.width,
            values: vec![0.0; plane.values.len()],
        };
        for (share, taps) in &self.0 {
            let blurred = plane.rows(taps).columns(taps);
            add_scaled(&mut sums.values, *share, &blurred.values);
        }
        sums
    }
}

/// Everything that depends only on the observer.
pub struct Filters {
    pub y: Blur,
    pub cx: Blur,
    pub cz: Blur,
    /// A Gaussian, its first and its second derivative; each side of the derivatives sums to ±1.
    pub feature: [Vec<f32>; 3],
}

impl Filters {
    pub fn new(pixels_per_degree: f64) -> Self {
        use std::f64::consts::PI;
        // Contrast sensitivities of table 1 of the paper: achromatic, red–green, blue–yellow.
        const Y: [(f64, f64); 1] = [(1.0, 0.0047)];
        const CX: [(f64, f64); 1] = [(1.0, 0.0053)];
        const CZ: [(f64, f64); 2] = [(34.1, 0.04), (13.5, 0.025)];
        // Three standard deviations of the widest Gaussian.
        let widest = (CZ[0].1 / (2.0 * PI * PI)).sqrt();
        let radius = (3.0 * widest * pixels_per_degree).ceil() as i32;
        let blur = |terms: &[_]| Blur::new(terms, radius, pixels_per_degree);
        Self {
            y: blur(&Y),
            cx: blur(&CX),
            cz: blur(&CZ),
            feature: feature_filters(0.5 * FEATURE_WIDTH_DEG * pixels_per_degree),
        }
    }
}

/// For a standard deviation in pixels.
fn feature_filters(sigma: f64) -> [Vec<f32>; 3] {
    let radius = (3.0 * sigma).ceil() as i32;
    let gauss = |x: f64| (-x * x / (2.0 * sigma * sigma)).exp();
    let smooth = symmetric(radius, gauss);
    let first = symmetric(radius, |x| -x * gauss(x));
    let second = symmetric(radius, |x| (x * x / (sigma * sigma) - 1.0) * gauss(x));
    [smooth, first, second].map(|taps| {
        let sum = |keep: fn(f64) -> f64| taps.iter().map(|&tap| keep(tap)).sum::<f64>();
        let (positive, negative) = (sum(|tap| tap.max(0.0)), sum(|tap| (-tap).max(0.0)));
        let scaled = taps.iter().map(|&tap| {
            let side = if tap > 0.0 { positive } else { negative };
            if tap == 0.0 { 0.0 } else { (tap / side) as f32 }
        });
        scaled.collect()
    })
}

/// A function at the integers from −radius to radius.
fn symmetric(radius: i32, f: impl Fn(f64) -> f64) -> Vec<f64> {
    (-radius..=radius).map(|x| f(f64::from(x))).collect()
}
