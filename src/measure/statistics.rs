//! Statistics of frame times and of samples.

/// Mean of a sample and the standard error of that mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeanEstimate {
    pub mean: f64,
    /// Sample standard deviation / √n; infinite for fewer than two values, which cannot give one.
    pub standard_error: f64,
}

impl MeanEstimate {
    /// `None` for an empty sample. Welford 1962: one pass, no cancellation.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let (mut count, mut mean, mut squares) = (0.0, 0.0, 0.0);
        for value in values {
            count += 1.0;
            let before = value - mean;
            mean += before / count;
            squares += before * (value - mean);
        }
        let standard_error = if count > 1.0 {
            (squares / (count - 1.0) / count).sqrt()
        } else {
            f64::INFINITY
        };
        (count > 0.0).then_some(Self {
            mean,
            standard_error,
        })
    }

    /// Whether `truth` lies within `errors` standard errors of the mean, or within `share` of
    /// `truth` (0.01 = 1 %), whichever is wider. False for NaN.
    pub fn agrees_with(&self, truth: f64, errors: f64, share: f64) -> bool {
        (self.mean - truth).abs() <= (errors * self.standard_error).max(share * truth.abs())
    }
}

/// The p-quantile, p in [0, 1], by linear interpolation between closest ranks (type 7 of Hyndman & Fan
/// 1996). `None` for an empty sample.
///
/// # Panics
/// If p lies outside [0, 1].
pub fn quantile(values: &[f64], p: f64) -> Option<f64> {
    assert!(
        (0.0..=1.0).contains(&p),
        "a quantile lies in [0, 1], not {p}"
    );
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().checked_sub(1)?;
    let rank = p * last as f64;
    let (low, high) = (sorted[rank.floor() as usize], sorted[rank.ceil() as usize]);
    // Equal neighbours are returned unchanged: infinity minus infinity would be NaN.
    Some(if low == high {
        low
    } else {
        low + (high - low) * rank.fract()
    })
}

/// Half of the values lie on either side. `None` for an empty sample.
pub fn median(values: &[f64]) -> Option<f64> {
    quantile(values, 0.5)
}

/// 99 of 100 values are at most this. `None` for an empty sample.
pub fn p99(values: &[f64]) -> Option<f64> {
    quantile(values, 0.99)
}

/// Frames per second over the slowest hundredth of the frames (at least one frame): their number
/// divided by their total time. `frame_ms` in milliseconds. `None` for an empty sample.
pub fn low1_fps(frame_ms: &[f64]) -> Option<f64> {
    let mut slowest_first = frame_ms.to_vec();
    slowest_first.sort_by(|a, b| b.total_cmp(a));
    let count = frame_ms.len().div_ceil(100);
    let total_ms: f64 = slowest_first[..count].iter().sum();
    (count > 0).then(|| count as f64 * 1000.0 / total_ms)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_of_a_known_list() {
        let values = [4.0, 1.0, 3.0, 2.0];
        assert_eq!(median(&values), Some(2.5));
        assert_eq!(quantile(&values, 0.0), Some(1.0));
        assert_eq!(quantile(&values, 1.0), Some(4.0));
        assert_eq!(quantile(&values, 0.25), Some(1.75));
        assert_eq!(median(&[7.0]), Some(7.0));
        assert_eq!(median(&[]), None);
        assert_eq!(median(&[f64::INFINITY; 2]), Some(f64::INFINITY));
    }

    #[test]
    fn p99_sees_the_slow_tail_that_the_median_hides() {
        let values: Vec<f64> = (0..=100).map(f64::from).collect();
        assert_eq!(p99(&values), Some(99.0));
        let mut hitch = vec![10.0; 100];
        hitch[50] = 90.0;
        assert_eq!(median(&hitch), Some(10.0));
        assert!(p99(&hitch).is_some_and(|value| value > 10.0));
    }

    #[test]
    fn low1_fps_is_the_rate_of_the_slowest_hundredth() {
        let mut frames = vec![5.0; 198];
        frames.extend([20.0, 30.0]);
        assert_eq!(low1_fps(&frames), Some(2.0 / 0.05));
        assert_eq!(low1_fps(&[4.0, 8.0]), Some(125.0), "one frame at least");
        assert_eq!(low1_fps(&[]), None);
    }

    #[test]
    fn standard_error_of_a_known_sample() {
        let estimate =
            MeanEstimate::of([2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0]).expect("not empty");
        assert_eq!(estimate.mean, 5.0);
        assert!((estimate.standard_error - (32.0f64 / 7.0 / 8.0).sqrt()).abs() < 1e-15);
        assert!(MeanEstimate::of([]).is_none());
        assert_eq!(
            MeanEstimate::of([3.0]).map(|e| e.standard_error),
            Some(f64::INFINITY)
        );
    }

    #[test]
    fn values_outside_both_bounds_do_not_agree() {
        let estimate = MeanEstimate {
            mean: 1.0,
            standard_error: 0.01,
        };
        assert!(estimate.agrees_with(1.029, 3.0, 0.0));
        assert!(!estimate.agrees_with(1.031, 3.0, 0.01));
        assert!(estimate.agrees_with(1.05, 0.0, 0.05));
        let broken = MeanEstimate {
            mean: f64::NAN,
            standard_error: 0.01,
        };
        assert!(!broken.agrees_with(1.0, 3.0, 0.01));
    }
}
