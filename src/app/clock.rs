//! World time, and the frame rate of the window.

use std::{
    collections::VecDeque,
    time::{Duration, Instant},
};

use crate::measure::frame_times::FrameStatistics;

/// Longest step of world time (seconds), so that lamps do not leap after a stall.
const LONGEST_STEP_S: f64 = 0.25;

/// World time: it can be paused, and run slower or faster.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorldClock {
    pub time_s: f64,
    pub paused: bool,
    /// Seconds of world time per second of real time.
    pub rate: f32,
}

impl Default for WorldClock {
    fn default() -> Self {
        Self {
            time_s: 0.0,
            paused: false,
            rate: 1.0,
        }
    }
}

impl WorldClock {
    /// Advances by this many seconds of real time.
    pub fn advance(&mut self, elapsed_s: f64) {
        self.time_s = self.time_after(elapsed_s);
    }

    /// World time (seconds) after this many seconds of real time.
    fn time_after(&self, elapsed_s: f64) -> f64 {
        match self.paused {
            true => self.time_s,
            false => self.time_s + elapsed_s.min(LONGEST_STEP_S) * f64::from(self.rate),
        }
    }
}

/// What the clock showed at a simulated time: it says what it will show.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ClockReading {
    /// Nanoseconds of the run.
    pub at_ns: u64,
    pub clock: WorldClock,
}

impl ClockReading {
    /// World time (seconds) at a simulated time (nanoseconds), which is not before this.
    pub fn time_s(&self, at_ns: u64) -> f64 {
        let elapsed_ns = at_ns.saturating_sub(self.at_ns);
        self.clock.time_after(elapsed_ns as f64 * 1e-9)
    }
}

/// The frames of the last seconds.
#[derive(Default)]
pub struct FrameRate {
    /// Milliseconds, the latest last.
    frames_ms: VecDeque<f64>,
    /// When the previous frame began; `None` if the time since then belongs to no frame.
    last: Option<Instant>,
    /// The statistics, and when they were computed.
    figures: Option<(Instant, FrameStatistics)>,
}

impl FrameRate {
    /// Number of frames that the statistics cover.
    pub const KEPT: usize = 300;
    /// Time between two updates of the statistics, so that they can be read.
    const LOOKED_AT: Duration = Duration::from_millis(250);
    /// Milliseconds of frames that the rate covers, so that it can be read.
    const SMOOTHED_MS: f64 = 500.0;

    /// A frame begins. The time since the previous one counts, if there was one.
    pub fn tick(&mut self, now: Instant) {
        if let Some(last) = self.last.replace(now) {
            self.push(now.saturating_duration_since(last).as_secs_f64() * 1e3);
        }
        let is_fresh = self
            .figures
            .is_some_and(|(at, _)| now.saturating_duration_since(at) < Self::LOOKED_AT);
        if !is_fresh {
            self.figures = FrameStatistics::of(&self.frames_ms()).map(|figures| (now, figures));
        }
    }

    /// The time from now until the next frame belongs to no frame.
    pub fn interrupt(&mut self) {
        self.last = None;
    }

    fn push(&mut self, frame_ms: f64) {
        if self.frames_ms.len() == Self::KEPT {
            self.frames_ms.pop_front();
        }
        self.frames_ms.push_back(frame_ms);
    }

    /// Forgets all frames, for when they say nothing about those to come.
    pub fn clear(&mut self) {
        self.frames_ms.clear();
        self.figures = None;
        self.interrupt();
    }

    /// Frames per second of the last half second; `None` before the first frame.
    pub fn fps(&self) -> Option<f64> {
        let (mut frames, mut total_ms) = (0.0, 0.0);
        for ms in self.frames_ms.iter().rev() {
            frames += 1.0;
            total_ms += ms;
            if total_ms >= Self::SMOOTHED_MS {
                break;
            }
        }
        (total_ms > 0.0).then(|| 1e3 * frames / total_ms)
    }

    /// Milliseconds of the frames, the latest last.
    pub fn frames_ms(&self) -> Vec<f64> {
        self.frames_ms.iter().copied().collect()
    }

    /// Statistics of the frames, updated every quarter of a second; `None` before the first frame.
    pub fn figures(&self) -> Option<&FrameStatistics> {
        self.figures.as_ref().map(|(_, figures)| figures)
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn only_the_time_between_frames_counts() {
        let start = Instant::now();
        let after = |ms| start + Duration::from_millis(ms);
        let mut rate = FrameRate::default();
        rate.tick(after(0));
        assert_eq!(rate.fps(), None, "one frame has no duration yet");
        rate.tick(after(100));
        rate.interrupt();
        rate.tick(after(900));
        rate.tick(after(1000));
        assert!((rate.fps().expect("two frames") - 10.0).abs() < 1e-9);
        rate.clear();
        rate.tick(after(1001));
        assert_eq!(rate.fps(), None, "nor has the first after a stall");
    }

    #[test]
    fn time_runs_stands_and_does_not_leap() {
        let mut clock = WorldClock::default();
        clock.advance(0.1);
        clock.rate = 0.5;
        clock.advance(0.1);
        assert!((clock.time_s - 0.15).abs() < 1e-9);
        clock.paused = true;
        clock.advance(0.1);
        assert!((clock.time_s - 0.15).abs() < 1e-9);
        clock.paused = false;
        clock.advance(60.0);
        assert!((clock.time_s - 0.275).abs() < 1e-9);
    }

    #[test]
    fn the_rate_is_that_of_the_last_half_second() {
        let mut rate = FrameRate::default();
        assert_eq!(rate.fps(), None);
        for _ in 0..200 {
            rate.push(50.0);
        }
        for _ in 0..100 {
            rate.push(10.0);
        }
        assert!((rate.fps().expect("frames") - 100.0).abs() < 1e-9);
    }

    #[test]
    fn figures_are_of_the_last_frames_and_stand_still_for_a_moment() {
        let start = Instant::now();
        let mut rate = FrameRate::default();
        rate.tick(start);
        assert!(rate.figures().is_none());
        let mut now = start;
        for frame in 0..400 {
            now += Duration::from_millis(if frame < 350 { 50 } else { 10 });
            rate.tick(now);
        }
        assert_eq!(rate.frames_ms().len(), FrameRate::KEPT);
        let figures = *rate.figures().expect("frames");
        assert_eq!((figures.median, figures.low1_fps), (50.0, 20.0));
        rate.tick(now + Duration::from_millis(1));
        assert_eq!(rate.figures(), Some(&figures));
        rate.clear();
        assert!(rate.figures().is_none());
    }
}
