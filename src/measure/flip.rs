//! LDR-FLIP: how large the difference between two pictures looks to someone who flips between them.
//!
//! After Andersson et al. 2020, "FLIP: A Difference Evaluator for Alternating Images", with the
//! constants of the paper. Deviations, both for speed and without effect on the result: filters
//! run row by row, then column by column, and the blue–yellow filter (a sum of two Gaussians) as
//! two such pairs. Beyond its edges a picture continues with the colour of its edge.

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use super::{
    metrics::{MetricError, comparable},
    picture::Picture,
    tonemap::linear_from_srgb,
};

/// Of a screen 0.7 m wide with 3840 pixels, seen from 0.7 m: the paper's observer.
pub const PIXELS_PER_DEGREE: f64 = 67.0;

/// FLIP of each pixel, row by row, in [0, 1]; 0 where no difference is seen. The pictures are
/// display values (sRGB-encoded; clamped to [0, 1]); their order makes no difference.
///
/// # Errors
/// [`MetricError`] for pictures of different sizes, without pixels, or not finite.
pub fn flip(a: &Picture, b: &Picture, pixels_per_degree: f64) -> Result<Vec<f32>, MetricError> {
    comparable(a, b)?;
    let filters = Filters::new(pixels_per_degree);
    let (a, b) = rayon::join(|| Seen::new(a, &filters), || Seen::new(b, &filters));
    let most = most_colour_difference();
    Ok((0..a.lab.len())
        .into_par_iter()
        .map(|i| {
            let colour = colour_difference(a.lab[i], b.lab[i], most);
            let edges = (a.edges[i] - b.edges[i]).abs();
            let points = (a.points[i] - b.points[i]).abs();
            let feature = (edges.max(points) * std::f32::consts::FRAC_1_SQRT_2).powf(FEATURE_POWER);
            colour.powf(1.0 - feature)
        })
        .collect())
}

/// Exponents q_c and q_f of the paper: they stretch small colour and feature differences.
const COLOUR_POWER: f64 = 0.7;
const FEATURE_POWER: f32 = 0.5;
/// The share p_c of the largest colour difference that is mapped to p_t of the scale.
const COMMON_SHARE: f64 = 0.4;
const COMMON_MAPPED: f64 = 0.95;
/// Width w of the feature detectors in degrees: what the eye resolves best.
const FEATURE_WIDTH_DEG: f64 = 0.082;

/// One picture as the observer sees it: colours after blurring, and features.
struct Seen {
    /// CIELAB with Hunt's adjustment.
    lab: Vec<[f32; 3]>,
    edges: Vec<f32>,
    points: Vec<f32>,
}

impl Seen {
    fn new(display: &Picture, filters: &Filters) -> Self {
        let width = display.width as usize;
        let opponent: Vec<[f32; 3]> = display.rgb.par_iter().map(|&rgb| ycxcz(rgb)).collect();
        let channel = |c: usize| Plane {
            width,
            values: opponent.par_iter().map(|colour| colour[c]).collect(),
        };
        let (y, cx, cz) = (channel(0), channel(1), channel(2));
        let blurred = [(&y, &filters.y), (&cx, &filters.cx), (&cz, &filters.cz)]
            .map(|(plane, filter)| filter.applied(plane));
        let lab = (0..opponent.len())
            .into_par_iter()
            .map(|i| hunt_lab([0, 1, 2].map(|c| blurred[c].values[i])))
            .collect();

        // Y from 0 (black) to 1 (white).
        let grey = Plane {
            width,
            values: y.values.par_iter().map(|y| (y + 16.0) / 116.0).collect(),
        };
        let [smooth, first, second] = filters.feature.each_ref().map(|taps| grey.rows(taps));
        let [gauss, derivative, curvature] = &filters.feature;
        Self {
            lab,
            edges: lengths(&first.columns(gauss), &smooth.columns(derivative)),
            points: lengths(&second.columns(gauss), &smooth.columns(curvature)),
        }
    }
}

/// Length of the vector (x, y) at each pixel.
fn lengths(x: &Plane, y: &Plane) -> Vec<f32> {
    let both = x.values.par_iter().zip(&y.values);
    both.map(|(x, y)| (x * x + y * y).sqrt()).collect()
}

/// One number a pixel, row by row.
struct Plane {
    width: usize,
    values: Vec<f32>,
}

impl Plane {
    /// Convolved along x. `taps` has an odd length; its middle is the pixel itself.
    fn rows(&self, taps: &[f32]) -> Self {
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
    fn columns(&self, taps: &[f32]) -> Self {
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

/// A blur: a sum of Gaussians, each with its share of the whole.
struct Blur(Vec<(f32, Vec<f32>)>);

impl Blur {
    /// The inverse transform of a contrast sensitivity: Σ a √(π/b) exp(−π² r²/b), r in degrees,
    /// as (a, b) of each term; its sum over the pixels is 1.
    fn new(terms: &[(f64, f64)], radius: i32, pixels_per_degree: f64) -> Self {
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

    fn applied(&self, plane: &Plane) -> Plane {
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

/// Everything that depends on the observer alone.
struct Filters {
    y: Blur,
    cx: Blur,
    cz: Blur,
    /// A Gaussian, its first and its second derivative; each side of those sums to ±1.
    feature: [Vec<f32>; 3],
}

impl Filters {
    fn new(pixels_per_degree: f64) -> Self {
        use std::f64::consts::PI;
        // Contrast sensitivities of table 1 of the paper: achromatic, red–green, blue–yellow.
        const Y: [(f64, f64); 1] = [(1.0, 0.0047)];
        const CX: [(f64, f64); 1] = [(1.0, 0.0053)];
        const CZ: [(f64, f64); 2] = [(34.1, 0.04), (13.5, 0.025)];
        // Three standard deviations of the widest.
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

/// Linear Rec. 709 to CIE XYZ under D65; the columns are the primaries.
const XYZ_FROM_RGB: DMat3 = DMat3::from_cols(
    DVec3::new(
        10_135_552.0 / 24_577_794.0,
        2_613_072.0 / 12_288_897.0,
        1_425_312.0 / 73_733_382.0,
    ),
    DVec3::new(
        8_788_810.0 / 24_577_794.0,
        8_788_810.0 / 12_288_897.0,
        8_788_810.0 / 73_733_382.0,
    ),
    DVec3::new(
        4_435_075.0 / 24_577_794.0,
        887_015.0 / 12_288_897.0,
        70_074_185.0 / 73_733_382.0,
    ),
);

/// XYZ relative to the white of the display, so that white is (1, 1, 1).
fn relative_xyz(linear: DVec3) -> DVec3 {
    XYZ_FROM_RGB * linear / (XYZ_FROM_RGB * DVec3::ONE)
}

/// Display values to YCxCz: CIELAB without its cube root, in which light may be averaged.
fn ycxcz(display: [f32; 3]) -> [f32; 3] {
    let encoded = DVec3::from_array(display.map(f64::from)).clamp(DVec3::ZERO, DVec3::ONE);
    let xyz = relative_xyz(encoded.map(linear_from_srgb));
    [
        116.0 * xyz.y - 16.0,
        500.0 * (xyz.x - xyz.y),
        200.0 * (xyz.y - xyz.z),
    ]
    .map(|value| value as f32)
}

/// YCxCz, limited to what a display can show, to CIELAB with chroma scaled by lightness (Hunt).
fn hunt_lab([y, cx, cz]: [f32; 3]) -> [f32; 3] {
    let y = (f64::from(y) + 16.0) / 116.0;
    let xyz = DVec3::new(y + f64::from(cx) / 500.0, y, y - f64::from(cz) / 200.0);
    let white = XYZ_FROM_RGB * DVec3::ONE;
    let linear = XYZ_FROM_RGB.inverse() * (xyz * white);
    lab_of(linear.clamp(DVec3::ZERO, DVec3::ONE)).map(|value| value as f32)
}

/// CIELAB of linear light in [0, 1], its chroma scaled by lightness.
fn lab_of(linear: DVec3) -> [f64; 3] {
    let root = |t: f64| {
        const DELTA: f64 = 6.0 / 29.0;
        if t > DELTA * DELTA * DELTA {
            t.cbrt()
        } else {
            t / (3.0 * DELTA * DELTA) + 4.0 / 29.0
        }
    };
    let f = relative_xyz(linear).map(root);
    let lightness = 116.0 * f.y - 16.0;
    let hunt = 0.01 * lightness;
    [
        lightness,
        hunt * 500.0 * (f.x - f.y),
        hunt * 200.0 * (f.y - f.z),
    ]
}

/// HyAB (Abasi et al. 2020) to the power q_c.
fn raised_hyab(a: [f64; 3], b: [f64; 3]) -> f64 {
    let difference = DVec3::from_array(a) - DVec3::from_array(b);
    (difference.x.abs() + difference.y.hypot(difference.z)).powf(COLOUR_POWER)
}

/// Between the green and the blue primary: no two displayed colours are farther apart.
fn most_colour_difference() -> f64 {
    raised_hyab(lab_of(DVec3::Y), lab_of(DVec3::Z))
}

/// In [0, 1]: common differences take most of the scale, the largest are pressed together above.
fn colour_difference(a: [f32; 3], b: [f32; 3], most: f64) -> f32 {
    let difference = raised_hyab(a.map(f64::from), b.map(f64::from));
    let common = COMMON_SHARE * most;
    let mapped = if difference < common {
        COMMON_MAPPED * difference / common
    } else {
        COMMON_MAPPED + (1.0 - COMMON_MAPPED) * (difference - common) / (most - common)
    };
    mapped as f32
}

#[cfg(test)]
mod tests {
    use nv_flip::FlipImageRgb8;

    use super::*;

    /// A picture whose values are those of 8 bits, from a function of x and y.
    fn drawn(width: u32, height: u32, colour: impl Fn(u32, u32) -> [u8; 3]) -> Picture {
        let pixels = (0..width * height).map(|i| colour(i % width, i / width));
        let rgb = pixels.map(|rgb| rgb.map(|value| f32::from(value) / 255.0));
        Picture {
            width,
            height,
            rgb: rgb.collect(),
        }
    }

    /// Smooth colour, hard edges, single points, noise, flat black and white: something for
    /// every part of the metric, up to the borders.
    fn scene(width: u32, height: u32) -> Picture {
        drawn(width, height, |x, y| {
            let noise = (x.wrapping_mul(2_654_435_761) ^ y.wrapping_mul(2_246_822_519)) >> 13;
            match (x / 12 + y / 9 * 3) % 6 {
                0 => [(x * 5) as u8, (y * 7) as u8, 128],
                1 => [noise as u8, (noise >> 8) as u8, (noise >> 3) as u8],
                2 => [if x % 4 < 2 { 240 } else { 20 }; 3],
                3 if x % 7 == 3 && y % 5 == 2 => [255, 250, 180],
                3 => [12, 10, 40],
                4 => [255; 3],
                _ => [0, 0, (x + y) as u8],
            }
        })
    }

    fn by_nvidia(a: &Picture, b: &Picture) -> Vec<f32> {
        let image = |picture: &Picture| {
            let values = picture.rgb.iter().flatten();
            let bytes: Vec<u8> = values.map(|value| (value * 255.0).round() as u8).collect();
            FlipImageRgb8::with_data(picture.width, picture.height, &bytes)
        };
        nv_flip::flip(image(a), image(b), PIXELS_PER_DEGREE as f32).to_vec()
    }

    fn quantised(picture: &Picture, change: impl Fn(usize, [f32; 3]) -> [f32; 3]) -> Picture {
        let changed = picture.rgb.iter().enumerate().map(|(i, &rgb)| {
            change(i, rgb).map(|value| (value.clamp(0.0, 1.0) * 255.0).round() / 255.0)
        });
        Picture {
            rgb: changed.collect(),
            ..picture.clone()
        }
    }

    /// Pairs of pictures, each with the fault that sets them apart.
    fn pairs() -> Vec<(&'static str, Picture, Picture)> {
        let sound = scene(97, 61);
        let mut shifted = sound.clone();
        shifted.rgb.rotate_right(1);
        let mut pairs = vec![
            ("shifted", shifted),
            (
                "darkened",
                quantised(&sound, |_, rgb| rgb.map(|value| value * 0.9)),
            ),
            ("swapped", quantised(&sound, |_, [r, g, b]| [b, g, r])),
            (
                "inverted",
                quantised(&sound, |_, rgb| rgb.map(|value| 1.0 - value)),
            ),
            (
                "one pixel",
                quantised(
                    &sound,
                    |i, rgb| if i == 3000 { [1.0, 0.0, 1.0] } else { rgb },
                ),
            ),
            (
                "corner",
                quantised(&sound, |i, rgb| if i == 0 { [0.0; 3] } else { rgb }),
            ),
        ]
        .into_iter()
        .map(|(name, other)| (name, sound.clone(), other))
        .collect::<Vec<_>>();
        // Smaller than the filters, and of one row or column.
        for (width, height) in [(5, 3), (40, 1), (1, 33), (1, 1)] {
            let small = scene(width, height);
            let dim = quantised(&small, |_, rgb| rgb.map(|value| value * 0.5));
            pairs.push(("small", small, dim));
        }
        pairs
    }

    #[test]
    fn every_pixel_agrees_with_nvidias_implementation() {
        for (name, a, b) in pairs() {
            let ours = flip(&a, &b, PIXELS_PER_DEGREE).expect("comparable");
            let theirs = by_nvidia(&a, &b);
            assert_eq!(ours.len(), theirs.len());
            let worst = ours.iter().zip(&theirs).map(|(a, b)| (a - b).abs());
            let worst = worst.fold(0.0, f32::max);
            assert!(worst < 1e-4, "{name}: {worst}");
            assert!(theirs.iter().any(|&value| value > 0.01), "{name} shows");
        }
    }

    #[test]
    fn the_comparison_with_nvidias_would_find_a_wrong_observer() {
        let (_, a, b) = &pairs()[0];
        let ours = flip(a, b, PIXELS_PER_DEGREE * 1.02).expect("comparable");
        let worst = ours.iter().zip(by_nvidia(a, b)).map(|(a, b)| (a - b).abs());
        assert!(worst.fold(0.0, f32::max) > 2e-3);
    }

    #[test]
    fn a_picture_looks_like_itself_and_black_unlike_white() {
        let sound = scene(33, 20);
        let same = flip(&sound, &sound, PIXELS_PER_DEGREE).expect("comparable");
        assert!(same.iter().all(|&value| value == 0.0));
        let black = drawn(9, 9, |_, _| [0; 3]);
        let white = drawn(9, 9, |_, _| [255; 3]);
        let far = flip(&black, &white, PIXELS_PER_DEGREE).expect("comparable");
        let (green, blue) = (
            drawn(9, 9, |_, _| [0, 255, 0]),
            drawn(9, 9, |_, _| [0, 0, 255]),
        );
        let farthest = flip(&green, &blue, PIXELS_PER_DEGREE).expect("comparable");
        // By hand: HyAB of black and white is 100; 100^0.7 = 25.12, of green and blue 41.28.
        assert!((far[40] - 0.9684).abs() < 2e-3, "{}", far[40]);
        assert!((farthest[40] - 1.0).abs() < 1e-4, "{}", farthest[40]);
    }

    #[test]
    fn the_order_makes_no_difference() {
        let (_, a, b) = &pairs()[2];
        let there = flip(a, b, PIXELS_PER_DEGREE);
        assert_eq!(there, flip(b, a, PIXELS_PER_DEGREE));
    }

    #[test]
    fn pictures_that_cannot_be_compared_are_refused() {
        let sound = scene(4, 3);
        let turned = flip(&sound, &scene(3, 4), PIXELS_PER_DEGREE);
        assert!(matches!(turned, Err(MetricError::Size { .. })));
        let mut faulty = sound.clone();
        faulty.rgb[6][1] = f32::NAN;
        let refused = flip(&faulty, &sound, PIXELS_PER_DEGREE);
        assert!(matches!(
            refused,
            Err(MetricError::NotFinite { x: 2, y: 1, .. })
        ));
    }
}
