//! How much light changes from one picture to the next of the same surfaces.

use serde::Serialize;

use super::{
    metrics::{MetricError, comparable},
    picture::Picture,
    tonemap::luminance,
};

/// Changes in [0, 1]: of luminance, relative to the greater of the two values; or of display values,
/// relative to white.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Changes {
    pub median: f64,
    pub p99: f64,
    /// 999 of 1000 changes are at most this.
    pub p999: f64,
    pub max: f64,
    /// Number of measured changes.
    pub count: u64,
}

/// Collects any number of changes.
#[derive(Clone, Debug)]
pub struct ChangeMeter {
    scale: Scale,
    max: f64,
    /// Histogram of change sizes, in steps of 1/[`STEPS`].
    counts: Vec<u64>,
}

/// The value that a change is relative to.
#[derive(Clone, Copy, Debug)]
enum Scale {
    /// The brighter of the two luminances. Pixels that are darker than the floor in both pictures are
    /// left out: they show no surface, or a surface too dark to measure.
    Brighter { floor: f64 },
    /// White: the change is the greatest change of a channel.
    White,
}

impl Scale {
    fn change(self, before: [f32; 3], after: [f32; 3]) -> Option<f64> {
        match self {
            Self::Brighter { floor } => {
                let (before, after) = (luminance(before), luminance(after));
                let brighter = before.max(after);
                (brighter > floor).then(|| (before - after).abs() / brighter)
            }
            Self::White => {
                let channels = before.iter().zip(&after);
                let changes = channels.map(|(before, after)| f64::from((before - after).abs()));
                changes.reduce(f64::max)
            }
        }
    }
}

/// Resolution of the percentiles.
const STEPS: f64 = 10_000.0;

impl ChangeMeter {
    /// For pictures in linear light. `floor`: least luminance that counts.
    pub fn new(floor: f64) -> Self {
        Self::with(Scale::Brighter { floor })
    }

    /// For display values in [0, 1]: the visible size of a change.
    pub fn of_display() -> Self {
        Self::with(Scale::White)
    }

    fn with(scale: Scale) -> Self {
        Self {
            scale,
            max: 0.0,
            counts: vec![0; STEPS as usize + 1],
        }
    }

    /// Adds the changes between two pictures of the same surfaces.
    ///
    /// # Errors
    /// [`MetricError`] for pictures of different sizes, and for values that are not finite.
    pub fn add(&mut self, before: &Picture, after: &Picture) -> Result<(), MetricError> {
        comparable(before, after)?;
        for (before, after) in before.rgb.iter().zip(&after.rgb) {
            if let Some(change) = self.scale.change(*before, *after) {
                self.max = self.max.max(change);
                self.counts[(change * STEPS).ceil().min(STEPS) as usize] += 1;
            }
        }
        Ok(())
    }

    /// The changes collected so far.
    pub fn result(&self) -> Changes {
        let count = self.counts.iter().sum();
        let quantile = |share: f64| {
            let within = (count as f64 * share).ceil() as u64;
            let mut seen = 0;
            let step = self.counts.iter().position(|one| {
                seen += one;
                seen >= within
            });
            step.unwrap_or_default() as f64 / STEPS
        };
        Changes {
            median: quantile(0.5),
            p99: quantile(0.99),
            p999: quantile(0.999),
            max: self.max,
            count,
        }
    }
}

/// Mean luminance of the pixels that are not black; 0 if all are black.
pub fn mean_lit(picture: &Picture) -> f64 {
    let lit: Vec<f64> = picture
        .rgb
        .iter()
        .map(|rgb| luminance(*rgb))
        .filter(|luminance| *luminance > 0.0)
        .collect();
    lit.iter().sum::<f64>() / lit.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(values: &[f32]) -> Picture {
        Picture {
            width: values.len() as u32,
            height: 1,
            rgb: values.iter().map(|value| [*value; 3]).collect(),
        }
    }

    #[test]
    fn changes_are_relative_to_the_brighter_and_dark_pixels_are_left_out() {
        let mut meter = ChangeMeter::new(0.1);
        let mut before = vec![1.0; 2000];
        let mut after = vec![1.01; 2000];
        // Three pixels that jump, one black and one dark pixel.
        after[..3].fill(2.0);
        (before[3], after[3]) = (0.0, 0.0);
        (before[4], after[4]) = (0.02, 0.08);
        meter
            .add(&grey(&before), &grey(&after))
            .expect("comparable");
        let found = meter.result();
        assert_eq!(found.count, 1998);
        assert!((found.median - 0.01).abs() < 2e-4, "{found:?}");
        assert!((found.p99 - 0.01).abs() < 2e-4, "{found:?}");
        assert!((found.p999 - 0.5).abs() < 2e-4, "{found:?}");
        assert!((found.max - 0.5).abs() < 1e-6, "{found:?}");
        let other = grey(&[1.0]);
        assert!(meter.add(&grey(&before), &other).is_err());
    }

    #[test]
    fn changes_of_display_values_are_relative_to_white() {
        let picture = |rgb: [f32; 3]| Picture {
            width: 1,
            height: 1,
            rgb: vec![rgb],
        };
        let mut meter = ChangeMeter::of_display();
        let (before, after) = (picture([0.1, 0.5, 0.9]), picture([0.1, 0.45, 0.93]));
        meter.add(&before, &after).expect("comparable");
        meter.add(&before, &before).expect("comparable");
        let found = meter.result();
        assert_eq!((found.count, found.median), (2, 0.0));
        assert!((found.max - 0.05).abs() < 1e-6, "{found:?}");
        assert!((found.p99 - 0.05).abs() < 2e-4, "{found:?}");
    }

    #[test]
    fn the_mean_of_lit_pixels_ignores_the_sky() {
        assert!((mean_lit(&grey(&[0.0, 2.0, 4.0])) - 3.0).abs() < 1e-6);
        assert_eq!(mean_lit(&grey(&[0.0])), 0.0);
        assert_eq!(ChangeMeter::new(0.0).result(), Changes::default());
    }
}
