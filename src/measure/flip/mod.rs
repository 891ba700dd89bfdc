//! LDR-FLIP: how large the difference between two pictures looks to someone who flips between them.
//!
//! After Andersson et al. 2020, "FLIP: A Difference Evaluator for Alternating Images", with the
//! constants of the paper. Deviations, both for speed and without effect on the result: filters
//! run row by row, then column by column, and the blue–yellow filter (a sum of two Gaussians) as
//! two such pairs. Beyond its edges a picture continues with the colour of its edge.

mod colour;
mod filters;

use rayon::prelude::*;

use self::{
    colour::{colour_difference, hunt_lab, most_colour_difference, ycxcz},
    filters::{Filters, Plane},
};
use super::{
    metrics::{MetricError, comparable},
    picture::Picture,
};

/// Of a screen 0.7 m wide with 3840 pixels, viewed from 0.7 m: the paper's observer.
pub const PIXELS_PER_DEGREE: f64 = 67.0;

/// FLIP of each pixel, row by row, in [0, 1]; 0 where no difference is visible. The pictures are
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

/// Exponent q_f of the paper: it stretches small feature differences.
const FEATURE_POWER: f32 = 0.5;

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

#[cfg(test)]
mod tests {
    use nv_flip::FlipImageRgb8;

    use super::*;

    /// A picture with 8-bit values, from a function of x and y.
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

    /// Pairs of pictures, each with the name of the fault between them.
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
