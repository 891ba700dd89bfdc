//! How much the pictures of a still scene change from one frame to the next.

use serde::{Deserialize, Serialize};

use super::{
    metrics::{MetricError, comparable},
    picture::Picture,
};

/// Change of a pixel between consecutive frames: the sum over RGB of the absolute difference of display
/// values, in [0, 3].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stability {
    pub mean: f64,
    /// 99 of 100 changes are at most this; a multiple of 1/255.
    pub p99: f64,
    /// The greatest change of any pixel between any two frames.
    pub max: f64,
    /// Number of pictures, one more than the changes of each pixel.
    pub frames: u32,
}

/// Takes the pictures one by one.
#[derive(Clone, Debug, Default)]
pub struct StabilityMeter {
    last: Option<Picture>,
    frames: u32,
    sum: f64,
    max: f64,
    /// Histogram of changes in steps of 1/255: exact for pictures of 8 bits per channel.
    counts: Vec<u64>,
}

/// Steps of an 8-bit channel.
const STEPS: f64 = 255.0;

impl StabilityMeter {
    pub fn new() -> Self {
        Self {
            counts: vec![0; 3 * STEPS as usize + 1],
            ..Self::default()
        }
    }

    /// Adds the next picture: display values in [0, 1].
    ///
    /// # Errors
    /// [`MetricError`] for a picture of another size than the one before, or not finite.
    pub fn add(&mut self, display: Picture) -> Result<(), MetricError> {
        if let Some(last) = &self.last {
            comparable(&display, last)?;
            for (now, before) in display.rgb.iter().zip(&last.rgb) {
                let channels = now.iter().zip(before);
                let change: f64 = channels.map(|(a, b)| f64::from((a - b).abs())).sum();
                self.sum += change;
                self.max = self.max.max(change);
                let step = ((change * STEPS).round() as usize).min(self.counts.len() - 1);
                self.counts[step] += 1;
            }
        }
        self.last = Some(display);
        self.frames += 1;
        Ok(())
    }

    /// The changes so far; `None` before the second picture.
    pub fn result(&self) -> Option<Stability> {
        let changes: u64 = self.counts.iter().sum();
        if changes == 0 {
            return None;
        }
        let within = (changes as f64 * 0.99).ceil() as u64;
        let mut seen = 0;
        let step = self.counts.iter().position(|count| {
            seen += count;
            seen >= within
        })?;
        Some(Stability {
            mean: self.sum / changes as f64,
            p99: step as f64 / STEPS,
            max: self.max,
            frames: self.frames,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(pixels: u32, value: f32) -> Picture {
        Picture {
            width: pixels,
            height: 1,
            rgb: vec![[value; 3]; pixels as usize],
        }
    }

    fn measured(pictures: impl IntoIterator<Item = Picture>) -> Option<Stability> {
        let mut meter = StabilityMeter::new();
        for picture in pictures {
            meter.add(picture).expect("comparable");
        }
        meter.result()
    }

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-6
    }

    #[test]
    fn a_series_computed_by_hand() {
        // Three channels change by 0.2, then by 0.4.
        let stability = measured([0.2, 0.4, 0.0].map(|value| flat(5, value))).expect("two pairs");
        assert!(close(stability.mean, 0.9), "{stability:?}");
        assert!(close(stability.max, 1.2) && close(stability.p99, 1.2));
        assert_eq!(stability.frames, 3);
    }

    #[test]
    fn one_pixel_in_two_hundred_shows_in_the_maximum_but_not_in_p99() {
        let mut flash = flat(200, 0.0);
        flash.rgb[7] = [1.0; 3];
        let stability = measured([flat(200, 0.0), flash]).expect("a pair");
        assert!(close(stability.max, 3.0) && close(stability.mean, 0.015));
        assert_eq!(stability.p99, 0.0);
        let mut more = flat(200, 0.0);
        more.rgb[..3].fill([1.0, 0.0, 0.0]);
        let stability = measured([flat(200, 0.0), more]).expect("a pair");
        assert!(close(stability.p99, 1.0), "{stability:?}");
    }

    #[test]
    fn still_pictures_do_not_change_and_one_alone_has_no_result() {
        let still = measured(std::iter::repeat_n(flat(4, 0.3), 5)).expect("pairs");
        assert_eq!((still.mean, still.p99, still.max), (0.0, 0.0, 0.0));
        assert_eq!(measured([flat(4, 0.3)]), None);
    }

    #[test]
    fn pictures_that_cannot_be_compared_are_refused() {
        let mut meter = StabilityMeter::new();
        meter.add(flat(4, 0.3)).expect("the first");
        assert!(matches!(
            meter.add(flat(5, 0.3)),
            Err(MetricError::Size { .. })
        ));
        let refused = meter.add(flat(4, f32::NAN));
        assert!(matches!(refused, Err(MetricError::NotFinite { .. })));
    }
}
