//! A picture against a reference, by every metric at once.

use serde::{Deserialize, Serialize};

use super::{
    flip::{self, flip},
    metrics::{self, MetricError},
    picture::Picture,
    picture_file::Encoding,
    selection::Selection,
    statistics,
    tonemap::{linear_from_srgb, tone_mapped},
};

/// One picture, as light and as display values.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    /// Linear Rec. 709.
    pub linear: Picture,
    /// sRGB-encoded, in [0, 1].
    pub display: Picture,
}

impl Shown {
    /// From light, tone-mapped at this exposure and rounded to 8 bits, as its PNG would be.
    pub fn from_linear(linear: Picture, exposure_ev: f32) -> Self {
        let mut display = tone_mapped(&linear, exposure_ev);
        for value in display.rgb.iter_mut().flatten() {
            *value = (*value * 255.0).round() / 255.0;
        }
        Self { linear, display }
    }

    /// From display values; the light is their sRGB decoding.
    pub fn from_display(display: Picture) -> Self {
        let decode = |value: f32| linear_from_srgb(f64::from(value)) as f32;
        let linear = Picture {
            rgb: display.rgb.iter().map(|rgb| rgb.map(decode)).collect(),
            ..display
        };
        Self { linear, display }
    }

    /// Chooses by the encoding of the file's numbers.
    pub fn from_file(picture: Picture, encoding: Encoding, exposure_ev: f32) -> Self {
        match encoding {
            Encoding::Display => Self::from_display(picture),
            Encoding::Linear => Self::from_linear(picture, exposure_ev),
        }
    }
}

/// FLIP over the pixels, each in [0, 1].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FlipSummary {
    pub mean: f64,
    pub p99: f64,
    pub max: f64,
}

/// Sum over RGB of the absolute difference of display values, in [0, 3].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AbsoluteSummary {
    pub mean: f64,
    pub max: f64,
}

/// Every metric of a pair, as `--json` prints it. Values that are not finite (light against black) are
/// `null` there.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    pub flip: FlipSummary,
    pub abs_sum: AbsoluteSummary,
    /// On linear light.
    pub rel_mse: f64,
    /// Picture over reference, on linear light.
    pub energy_ratio: f64,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Number of measured pixels.
    pub pixels: u64,
}

/// Measures the selected pixels, and also returns FLIP of every pixel. FLIP blurs, so it always runs on
/// the whole picture, whatever is then selected from its result.
///
/// # Errors
/// [`MetricError`] for pictures of different sizes, without pixels, or not finite.
pub fn compare(
    picture: &Shown,
    reference: &Shown,
    selection: &Selection,
) -> Result<(Comparison, Vec<f32>), MetricError> {
    // Checked before the selection, so that a message can name the pixel.
    metrics::comparable(&picture.linear, &reference.linear)?;
    let map = flip(
        &picture.display,
        &reference.display,
        flip::PIXELS_PER_DEGREE,
    )?;
    let pick = |shown: &Picture| selection.of_picture(shown);
    let absolute = metrics::absolute_sum(&pick(&picture.display), &pick(&reference.display))?;
    let (light, truth) = (pick(&picture.linear), pick(&reference.linear));
    let seen: Vec<f64> = selection.of(&map).into_iter().map(f64::from).collect();
    let quantile = |p| statistics::quantile(&seen, p).ok_or(MetricError::Empty);
    let comparison = Comparison {
        flip: FlipSummary {
            mean: seen.iter().sum::<f64>() / seen.len() as f64,
            p99: quantile(0.99)?,
            max: seen.iter().copied().fold(0.0, f64::max),
        },
        abs_sum: AbsoluteSummary {
            mean: absolute.mean,
            max: absolute.max,
        },
        rel_mse: metrics::relative_mse(&light, &truth)?,
        energy_ratio: metrics::energy_ratio(&light, &truth)?,
        size: [picture.display.width, picture.display.height],
        pixels: seen.len() as u64,
    };
    Ok((comparison, map))
}

impl Comparison {
    /// The names of metrics that gates accept, with a description of each.
    pub const METRICS: [(&'static str, &'static str); 8] = [
        ("flip.mean", "mean FLIP"),
        ("flip.p99", "99th percentile of FLIP"),
        ("flip.max", "greatest FLIP"),
        ("abs_sum.mean", "mean sum of absolute differences"),
        ("abs_sum.max", "greatest sum of absolute differences"),
        ("rel_mse", "relative mean squared error"),
        ("energy_ratio", "energy ratio"),
        ("energy_error", "distance of the energy ratio from 1"),
    ];

    /// A metric by its name; `None` for a name that is not in [`Self::METRICS`].
    pub fn metric(&self, name: &str) -> Option<f64> {
        Some(match name {
            "flip.mean" => self.flip.mean,
            "flip.p99" => self.flip.p99,
            "flip.max" => self.flip.max,
            "abs_sum.mean" => self.abs_sum.mean,
            "abs_sum.max" => self.abs_sum.max,
            "rel_mse" => self.rel_mse,
            "energy_ratio" => self.energy_ratio,
            "energy_error" => (self.energy_ratio - 1.0).abs(),
            _ => return None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene() -> Picture {
        let rgb = (0..24 * 16).map(|i| {
            let (x, y) = ((i % 24) as f32, (i / 24) as f32);
            [0.02 * x + 0.1, 0.05 * y, 0.3 + 0.01 * (x - y)]
        });
        Picture {
            width: 24,
            height: 16,
            rgb: rgb.collect(),
        }
    }

    fn against(change: impl Fn(&mut Picture)) -> Comparison {
        let mut faulty = scene();
        change(&mut faulty);
        let (a, b) = (
            Shown::from_linear(faulty, 0.0),
            Shown::from_linear(scene(), 0.0),
        );
        compare(&a, &b, &Selection::ALL).expect("comparable").0
    }

    #[test]
    fn every_name_has_a_value() {
        let same = against(|_| {});
        for (name, _) in Comparison::METRICS {
            let expected = f64::from(name == "energy_ratio");
            assert_eq!(same.metric(name), Some(expected), "{name}");
        }
        assert_eq!(same.metric("flip"), None);
    }

    #[test]
    fn planted_faults_show_in_every_metric_that_should_detect_them() {
        let darkened = against(|p| p.rgb.iter_mut().flatten().for_each(|v| *v *= 0.9));
        assert!((darkened.energy_ratio - 0.9).abs() < 1e-6);
        let shifted = against(|p| p.rgb.rotate_right(1));
        assert!(
            (shifted.energy_ratio - 1.0).abs() < 1e-6,
            "light only moved"
        );
        let swapped = against(|p| p.rgb.iter_mut().for_each(|rgb| rgb.swap(0, 2)));
        for (name, fault) in [
            ("darkened", darkened),
            ("shifted", shifted),
            ("swapped", swapped),
        ] {
            assert!(fault.flip.mean > 0.01, "{name}: {fault:?}");
            assert!(fault.flip.mean <= fault.flip.p99 && fault.flip.p99 <= fault.flip.max);
            assert!(fault.abs_sum.mean > 0.02, "{name}: {fault:?}");
            assert!(fault.rel_mse > 1e-3, "{name}: {fault:?}");
        }
    }

    #[test]
    fn a_selection_leaves_out_unmarked_pixels() {
        let mut faulty = scene();
        faulty.rgb[0] = [4.0; 3];
        let shown = |picture: &Picture| Shown::from_linear(picture.clone(), 0.0);
        let far = Selection::region([24, 16], [20, 12, 4, 4]).expect("inside");
        let near = Selection::region([24, 16], [0, 0, 1, 1]).expect("inside");
        let measure = |selection: &Selection| {
            let pair = compare(&shown(&faulty), &shown(&scene()), selection);
            pair.expect("comparable").0
        };
        let (far, near) = (measure(&far), measure(&near));
        assert_eq!((far.pixels, near.pixels), (16, 1));
        assert_eq!(far.abs_sum.max, 0.0);
        assert_eq!(far.energy_ratio, 1.0);
        assert!(near.abs_sum.mean > 1.0 && near.flip.mean > 0.5, "{near:?}");
    }

    #[test]
    fn a_png_compares_like_its_picture() {
        let linear = Shown::from_linear(scene(), 1.0);
        let png = Shown::from_display(linear.display.clone());
        let pair = compare(&png, &linear, &Selection::ALL).expect("comparable");
        assert_eq!(pair.0.flip.max, 0.0);
        assert_eq!(pair.0.abs_sum.max, 0.0);
        // Decoded display light is not scene light.
        assert!(pair.0.energy_ratio != 1.0);
    }

    #[test]
    fn one_nan_is_refused_wherever_it_lies() {
        let sound = Shown::from_linear(scene(), 0.0);
        let mut faulty = sound.clone();
        faulty.linear.rgb[25][2] = f32::NAN;
        let far = Selection::region([24, 16], [20, 12, 4, 4]).expect("inside");
        let refused = compare(&sound, &faulty, &far);
        let second = MetricError::NotFinite {
            picture: "second",
            x: 1,
            y: 1,
        };
        assert_eq!(refused.map(|pair| pair.0), Err(second));
    }
}
