//! Differences between two pictures. Every metric refuses pictures of different sizes and pictures
//! with a value that is not finite: a NaN must never average itself away.

use thiserror::Error;

use super::picture::Picture;

/// Why two pictures cannot be compared.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum MetricError {
    #[error(
        "the pictures differ in size: {}×{} and {}×{}; render both with the same --size",
        .a[0], .a[1], .b[0], .b[1]
    )]
    Size { a: [u32; 2], b: [u32; 2] },
    #[error("the pictures have no pixels")]
    Empty,
    #[error("the {picture} picture is not finite (NaN or infinity) at pixel ({x}, {y})")]
    NotFinite {
        picture: &'static str,
        x: u32,
        y: u32,
    },
}

/// Sum over RGB of |difference| per pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AbsoluteSum {
    pub mean: f64,
    pub max: f64,
}

/// Sum over RGB of the absolute difference: mean and maximum over the pixels. In [0, 3] for pictures
/// tone-mapped to [0, 1], which this metric is meant for.
pub fn absolute_sum(a: &Picture, b: &Picture) -> Result<AbsoluteSum, MetricError> {
    comparable(a, b)?;
    let (mut sum, mut max) = (0.0, 0.0f64);
    for (a, b) in a.rgb.iter().zip(&b.rgb) {
        let difference: f64 = channels(a, b).map(|(a, b)| (a - b).abs()).sum();
        sum += difference;
        max = max.max(difference);
    }
    Ok(AbsoluteSum {
        mean: sum / a.rgb.len() as f64,
        max,
    })
}

/// Bounds the relative error of nearly black values.
const RELATIVE_FLOOR: f64 = 1e-2;

/// Relative mean squared error against a reference: mean over pixels and channels of
/// (value − truth)² / (truth² + 0.01), as in Rousselle et al. 2011. For linear pictures.
pub fn relative_mse(picture: &Picture, reference: &Picture) -> Result<f64, MetricError> {
    comparable(picture, reference)?;
    let sum: f64 = picture
        .rgb
        .iter()
        .zip(&reference.rgb)
        .flat_map(|(value, truth)| channels(value, truth))
        .map(|(value, truth)| (value - truth).powi(2) / (truth * truth + RELATIVE_FLOOR))
        .sum();
    Ok(sum / (3 * picture.rgb.len()) as f64)
}

/// Sum of all channels of the picture divided by that of the reference; 1 if light is neither lost nor
/// created. For linear pictures. 1 for two black pictures, infinite for light against black.
pub fn energy_ratio(picture: &Picture, reference: &Picture) -> Result<f64, MetricError> {
    comparable(picture, reference)?;
    let (value, truth) = (total(picture), total(reference));
    Ok(if value == truth { 1.0 } else { value / truth })
}

pub(super) fn comparable(a: &Picture, b: &Picture) -> Result<(), MetricError> {
    if (a.width, a.height) != (b.width, b.height) {
        return Err(MetricError::Size {
            a: [a.width, a.height],
            b: [b.width, b.height],
        });
    }
    if a.rgb.is_empty() {
        return Err(MetricError::Empty);
    }
    finite(a, "first")?;
    finite(b, "second")
}

fn finite(picture: &Picture, name: &'static str) -> Result<(), MetricError> {
    match first_not_finite(picture) {
        None => Ok(()),
        Some([x, y]) => Err(MetricError::NotFinite {
            picture: name,
            x,
            y,
        }),
    }
}

/// Column and row of the first pixel with a NaN or an infinity.
pub fn first_not_finite(picture: &Picture) -> Option<[u32; 2]> {
    let bad = |rgb: &[f32; 3]| rgb.iter().any(|value| !value.is_finite());
    let index = picture.rgb.iter().position(bad)?;
    let width = picture.width as usize;
    Some([(index % width) as u32, (index / width) as u32])
}

fn channels(a: &[f32; 3], b: &[f32; 3]) -> impl Iterator<Item = (f64, f64)> {
    let (a, b) = (*a, *b);
    (0..3).map(move |i| (f64::from(a[i]), f64::from(b[i])))
}

fn total(picture: &Picture) -> f64 {
    picture
        .rgb
        .iter()
        .flatten()
        .map(|&value| f64::from(value))
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(width: u32, rgb: &[[f32; 3]]) -> Picture {
        Picture {
            width,
            height: rgb.len() as u32 / width,
            rgb: rgb.to_vec(),
        }
    }

    /// Asymmetric in every way, so that every planted fault changes it.
    fn scene() -> Picture {
        let mut picture = Picture::new(4, 3);
        for (index, rgb) in picture.rgb.iter_mut().enumerate() {
            *rgb = [0.1 + 0.05 * index as f32, 0.3, 0.9 - 0.07 * index as f32];
        }
        picture
    }

    fn faults() -> [(&'static str, Picture); 3] {
        let sound = scene();
        let mut darkened = sound.clone();
        darkened
            .rgb
            .iter_mut()
            .flatten()
            .for_each(|value| *value *= 0.9);
        let mut shifted = sound.clone();
        shifted.rgb.rotate_right(1);
        let mut swapped = sound.clone();
        swapped.rgb.iter_mut().for_each(|rgb| rgb.swap(0, 2));
        [
            ("darkened", darkened),
            ("shifted", shifted),
            ("swapped", swapped),
        ]
    }

    #[test]
    fn hand_computed_values() {
        let a = picture(2, &[[1.0, 0.0, 0.5], [0.25, 0.25, 0.25]]);
        let b = picture(2, &[[0.0, 1.0, 0.5], [0.25, 0.5, 0.25]]);
        assert_eq!(
            absolute_sum(&a, &b),
            Ok(AbsoluteSum {
                mean: 1.125,
                max: 2.0
            })
        );
        // 1/.01 + 1/1.01 + 0.0625/0.26, over six values.
        let expected = (1.0 / 0.01 + 1.0 / 1.01 + 0.0625 / 0.26) / 6.0;
        assert!((relative_mse(&a, &b).expect("comparable") - expected).abs() < 1e-12);
        assert_eq!(energy_ratio(&a, &b), Ok(2.25 / 2.5));
        let black = Picture::new(2, 1);
        assert_eq!(energy_ratio(&black, &black), Ok(1.0));
        assert_eq!(energy_ratio(&a, &black), Ok(f64::INFINITY));
        let white = picture(2, &[[1.0; 3]; 2]);
        assert_eq!(
            absolute_sum(&white, &black),
            Ok(AbsoluteSum {
                mean: 3.0,
                max: 3.0
            })
        );
    }

    #[test]
    fn a_picture_agrees_with_itself() {
        let sound = scene();
        assert_eq!(
            absolute_sum(&sound, &sound),
            Ok(AbsoluteSum {
                mean: 0.0,
                max: 0.0
            })
        );
        assert_eq!(relative_mse(&sound, &sound), Ok(0.0));
        assert_eq!(energy_ratio(&sound, &sound), Ok(1.0));
    }

    #[test]
    fn planted_faults_show() {
        let sound = scene();
        for (name, faulty) in faults() {
            let absolute = absolute_sum(&faulty, &sound).expect("comparable");
            assert!(
                absolute.mean > 0.02 && absolute.max > 0.1,
                "{name}: {absolute:?}"
            );
            assert!(
                relative_mse(&faulty, &sound).expect("comparable") > 5e-3,
                "{name}"
            );
        }
        let darkened = &faults()[0].1;
        let ratio = energy_ratio(darkened, &sound).expect("comparable");
        assert!((ratio - 0.9).abs() < 1e-6, "{ratio}");
    }

    #[test]
    fn one_value_that_is_not_finite_is_refused_and_named() {
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let (sound, mut faulty) = (scene(), scene());
            faulty.rgb[6][1] = bad;
            let first = Err(MetricError::NotFinite {
                picture: "first",
                x: 2,
                y: 1,
            });
            assert_eq!(energy_ratio(&faulty, &sound), first);
            assert_eq!(relative_mse(&faulty, &sound), first);
            let second = MetricError::NotFinite {
                picture: "second",
                x: 2,
                y: 1,
            };
            assert_eq!(absolute_sum(&sound, &faulty), Err(second));
        }
    }

    #[test]
    fn different_sizes_and_empty_pictures_are_refused() {
        let size = absolute_sum(&Picture::new(2, 3), &Picture::new(3, 2));
        assert_eq!(
            size,
            Err(MetricError::Size {
                a: [2, 3],
                b: [3, 2]
            })
        );
        let empty = Picture::new(0, 0);
        assert_eq!(energy_ratio(&empty, &empty), Err(MetricError::Empty));
    }
}
