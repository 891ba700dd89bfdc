//! Statistics of frame times: median, tails, and a confidence interval.

use serde::{Deserialize, Serialize};

use super::statistics::{MeanEstimate, median, quantile};

/// A frame that takes more than this many medians is a stutter (CapFrameX's threshold, but of the
/// median instead of the mean, because stutters move the mean).
const STUTTER: f64 = 2.5;
/// The share of frames, or of time, that the lows describe.
const LOW: f64 = 0.01;

/// Statistics of frame times in milliseconds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FrameStatistics {
    /// Number of frames.
    pub count: u32,
    pub median: f64,
    pub mean: f64,
    pub p95: f64,
    pub p99: f64,
    pub p999: f64,
    pub worst: f64,
    /// Frames per second over the slowest hundredth of the frames: their number divided by their total
    /// time.
    pub low1_fps: f64,
    /// The frame rate of the slowest hundredth of the *time*: slow frames weigh by their duration.
    pub low1_integral_fps: f64,
    /// Frames that took more than 2.5 medians.
    pub stutters: u32,
    /// Share of the time that was spent in stutters.
    pub stutter_share: f64,
}

impl FrameStatistics {
    /// `None` for no frames.
    pub fn of(frames_ms: &[f64]) -> Option<Self> {
        let middle = median(frames_ms)?;
        let total: f64 = frames_ms.iter().sum();
        let slow = frames_ms.iter().filter(|&&ms| ms > STUTTER * middle);
        let at = |p| quantile(frames_ms, p);
        Some(Self {
            count: frames_ms.len() as u32,
            median: middle,
            mean: total / frames_ms.len() as f64,
            p95: at(0.95)?,
            p99: at(0.99)?,
            p999: at(0.999)?,
            worst: at(1.0)?,
            low1_fps: super::statistics::low1_fps(frames_ms)?,
            low1_integral_fps: low_integral_fps(frames_ms)?,
            stutters: slow.clone().count() as u32,
            stutter_share: if total > 0.0 {
                // Not `sum`: an empty sum is −0.
                slow.fold(0.0, |so_far, ms| so_far + ms) / total
            } else {
                0.0
            },
        })
    }

    /// Frames per second at the median.
    pub fn fps(&self) -> f64 {
        1e3 / self.median
    }
}

/// Counts time, not frames: takes the slowest frames until they fill a hundredth of all the time, and
/// returns the rate of the last of them.
fn low_integral_fps(frames_ms: &[f64]) -> Option<f64> {
    let mut slowest_first = frames_ms.to_vec();
    slowest_first.sort_by(|a, b| b.total_cmp(a));
    let wanted = LOW * frames_ms.iter().sum::<f64>();
    let mut spent = 0.0;
    let reached = slowest_first.iter().find(|&&ms| {
        spent += ms;
        spent >= wanted
    });
    reached.map(|ms| 1e3 / ms)
}

/// An interval that holds the true value in 95 of 100 cases, from independent values.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    pub mean: f64,
    /// Half of its width, in the unit of the mean. `None` for fewer than two values, which have no
    /// interval.
    pub half_width: Option<f64>,
}

impl Interval {
    /// Student's t interval of the mean; `None` for no values.
    pub fn of(values: &[f64]) -> Option<Self> {
        let estimate = MeanEstimate::of(values.iter().copied())?;
        Some(Self {
            mean: estimate.mean,
            half_width: (values.len() > 1)
                .then(|| student_t(values.len()) * estimate.standard_error),
        })
    }

    /// The half width to expect from `more` values with the spread of these `values` values, relative
    /// to the mean.
    pub fn relative_after(&self, values: usize, more: usize) -> f64 {
        let shrunk = (values as f64 / more as f64).sqrt();
        self.relative() * shrunk * student_t(more) / student_t(values)
    }

    /// Half width relative to the mean; infinite if unknown.
    pub fn relative(&self) -> f64 {
        self.half_width
            .map_or(f64::INFINITY, |half| half / self.mean.abs())
    }
}

/// The factor of the standard error for a two-sided 95 % interval of `values` values (Student 1908).
pub fn student_t(values: usize) -> f64 {
    /// For 1, 2, … degrees of freedom.
    const T: [f64; 30] = [
        12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228, 2.201, 2.179, 2.160,
        2.145, 2.131, 2.120, 2.110, 2.101, 2.093, 2.086, 2.080, 2.074, 2.069, 2.064, 2.060, 2.056,
        2.052, 2.048, 2.045, 2.042,
    ];
    match values {
        0 | 1 => f64::INFINITY,
        n => T.get(n - 2).copied().unwrap_or(1.960),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_of_a_run_with_one_hitch() {
        let mut frames = vec![10.0; 199];
        frames.push(210.0);
        let statistics = FrameStatistics::of(&frames).expect("frames");
        assert_eq!(statistics.count, 200);
        assert_eq!(statistics.median, 10.0);
        assert_eq!(statistics.mean, 11.0);
        assert_eq!(statistics.p95, 10.0);
        assert_eq!(statistics.worst, 210.0);
        assert_eq!(statistics.stutters, 1);
        assert!((statistics.stutter_share - 210.0 / 2200.0).abs() < 1e-12);
        // Two frames are a hundredth of the frames; the hitch alone is more than a hundredth of the time.
        assert!((statistics.low1_fps - 2.0 / 0.22).abs() < 1e-9);
        assert!((statistics.low1_integral_fps - 1e3 / 210.0).abs() < 1e-9);
        assert_eq!(statistics.fps(), 100.0);
        assert!(FrameStatistics::of(&[]).is_none());
    }

    #[test]
    fn even_frames_have_no_tail() {
        let statistics = FrameStatistics::of(&[2.0; 100]).expect("frames");
        assert_eq!(statistics.low1_fps, 500.0);
        assert_eq!(statistics.low1_integral_fps, 500.0);
        assert_eq!((statistics.stutters, statistics.stutter_share), (0, 0.0));
    }

    #[test]
    fn intervals_narrow_with_more_values() {
        let few = Interval::of(&[9.0, 10.0, 11.0]).expect("values");
        assert_eq!(few.mean, 10.0);
        let half = few.half_width.expect("three values");
        assert!((half - 4.303 / 3f64.sqrt()).abs() < 1e-9);
        let expected = few.relative_after(3, 30);
        let many: Vec<f64> = [9.0, 10.0, 11.0].repeat(10);
        let many = Interval::of(&many).expect("values");
        assert!(
            (many.relative() / expected - 0.83).abs() < 0.02,
            "n − 1 for n"
        );
        let one = Interval::of(&[1.0]).expect("a value");
        assert_eq!(one.half_width, None);
        assert!(one.relative().is_infinite());
        assert_eq!(student_t(5), 2.776);
        assert_eq!(student_t(1000), 1.960);
    }
}
