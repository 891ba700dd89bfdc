//! World time, and how fast the window is.

use std::{collections::VecDeque, time::Instant};

use crate::measure::statistics;

/// Longest step of world time (seconds): lamps do not leap after a stall.
const LONGEST_STEP_S: f64 = 0.25;

/// World time: it can stand still, and run slower or faster.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorldClock {
    pub time_s: f64,
    pub paused: bool,
    /// Seconds of the world to a second of ours.
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
    /// Lets this many seconds of ours pass.
    pub fn advance(&mut self, elapsed_s: f64) {
        if !self.paused {
            self.time_s += elapsed_s.min(LONGEST_STEP_S) * f64::from(self.rate);
        }
    }
}

/// The frames of the last seconds.
#[derive(Default)]
pub struct FrameRate {
    /// Milliseconds, the latest last.
    frames_ms: VecDeque<f64>,
    /// When the frame before began, if the time since then is that of a frame.
    last: Option<Instant>,
}

impl FrameRate {
    /// Frames that the slowest hundredth is taken of.
    const KEPT: usize = 600;
    /// The rate is that of the frames of so many milliseconds, so that it can be read.
    const SMOOTHED_MS: f64 = 500.0;

    /// A frame begins: the time since the one before counts, if there was one.
    pub fn tick(&mut self, now: Instant) {
        if let Some(last) = self.last.replace(now) {
            self.push(now.saturating_duration_since(last).as_secs_f64() * 1e3);
        }
    }

    /// What goes on now is no part of a frame.
    pub fn interrupt(&mut self) {
        self.last = None;
    }

    fn push(&mut self, frame_ms: f64) {
        if self.frames_ms.len() == Self::KEPT {
            self.frames_ms.pop_front();
        }
        self.frames_ms.push_back(frame_ms);
    }

    /// As when frames so far say nothing about those to come.
    pub fn clear(&mut self) {
        self.frames_ms.clear();
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

    /// Frames per second over the slowest hundredth of the frames.
    pub fn low1_fps(&self) -> Option<f64> {
        let frames: Vec<f64> = self.frames_ms.iter().copied().collect();
        statistics::low1_fps(&frames)
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
        assert_eq!((rate.fps(), rate.low1_fps()), (None, None));
        for _ in 0..200 {
            rate.push(50.0);
        }
        for _ in 0..100 {
            rate.push(10.0);
        }
        assert!((rate.fps().expect("frames") - 100.0).abs() < 1e-9);
        assert!((rate.low1_fps().expect("frames") - 20.0).abs() < 1e-9);
    }
}
