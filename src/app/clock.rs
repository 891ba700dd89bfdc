//! World time, and how fast the window is.

use std::collections::VecDeque;

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
}

impl FrameRate {
    /// Frames that the slowest hundredth is taken of.
    const KEPT: usize = 600;
    /// The rate is that of the frames of so many milliseconds, so that it can be read.
    const SMOOTHED_MS: f64 = 500.0;

    pub fn push(&mut self, frame_ms: f64) {
        if self.frames_ms.len() == Self::KEPT {
            self.frames_ms.pop_front();
        }
        self.frames_ms.push_back(frame_ms);
    }

    /// As when the first frame after a stall would spoil the figures.
    pub fn clear(&mut self) {
        self.frames_ms.clear();
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
    use super::*;

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
