//! How often the window draws: as often as the display and the user's limits allow while somebody works with it, and
//! rarely otherwise.

use std::time::{Duration, Instant};

use super::settings::Preferences;

/// Time between two checks of a window that nobody sees.
const IDLE: Duration = Duration::from_millis(250);
/// Pauses of a window that is not in use are at least REST times as long as the frames before them, so that even slow
/// frames leave most of the time free.
const REST: u32 = 3;

/// Whether somebody uses or sees the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Attention {
    /// The window has the keyboard.
    pub focused: bool,
    /// Nobody sees the window.
    pub hidden: bool,
    /// Its frames are measured by a benchmark, or counted so that the window closes after N of them.
    pub measured: bool,
}

impl Attention {
    /// The least time between the beginnings of two frames, if the last took `drawing`; `None` where the display alone
    /// sets the pace.
    pub fn interval(self, preferences: &Preferences, drawing: Duration) -> Option<Duration> {
        let Self {
            focused,
            hidden,
            measured,
        } = self;
        let of = |frames_per_s: u32| Duration::from_secs(1) / frames_per_s.max(1);
        match (hidden, measured, focused) {
            (true, ..) => Some(drawing + IDLE),
            (false, true, _) => None,
            (false, false, true) => preferences.frame_limit.map(of),
            (false, false, false) => {
                Some(of(preferences.unfocused_limit).max((1 + REST) * drawing))
            }
        }
    }
}

/// The beginnings of frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pace {
    /// When the last frame began.
    began: Instant,
    /// When it was due. The next is due an interval after this moment: what is late does not make all that follow late.
    due: Instant,
}

impl Pace {
    pub fn new(now: Instant) -> Self {
        Self {
            began: now,
            due: now,
        }
    }

    /// A frame begins, at least `interval` after the last.
    pub fn begin(&mut self, now: Instant, interval: Option<Duration>) {
        let due = interval.map(|interval| self.due + interval);
        // Whoever is late by a whole frame does not catch up.
        let is_in_time = |due: &Instant| {
            *due <= now && interval.is_some_and(|interval| now.duration_since(*due) < interval)
        };
        self.due = due.filter(is_in_time).unwrap_or(now);
        self.began = now;
    }

    /// When to request the next frame, at least `interval` after the last; `None` for at once. The last request was at
    /// `requested`: the system may delay the frame, which is not to be requested again and again.
    pub fn next(&self, interval: Option<Duration>, requested: Instant) -> Option<Instant> {
        let interval = interval?;
        Some(match requested > self.began {
            true => requested + interval,
            false => self.due + interval,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::clock::WorldClock;

    const AT_WORK: Attention = Attention {
        focused: true,
        hidden: false,
        measured: false,
    };
    const BESIDE: Attention = Attention {
        focused: false,
        ..AT_WORK
    };

    fn limits(frame_limit: Option<u32>, unfocused_limit: u32) -> Preferences {
        Preferences {
            frame_limit,
            unfocused_limit,
            ..Preferences::default()
        }
    }

    #[test]
    fn a_window_without_focus_leaves_the_machine_to_others() {
        let preferences = Preferences::default();
        let [quick, slow] = [1, 400].map(Duration::from_millis);
        assert_eq!(AT_WORK.interval(&preferences, slow), None);
        let tenth = Duration::from_millis(100);
        assert_eq!(BESIDE.interval(&preferences, quick), Some(tenth));
        let rests = BESIDE.interval(&preferences, slow);
        assert_eq!(rests, Some(4 * slow), "a quarter of the time");
        let hidden = Attention {
            hidden: true,
            ..AT_WORK
        };
        assert_eq!(hidden.interval(&preferences, quick), Some(quick + IDLE));
        let measured = Attention {
            measured: true,
            ..BESIDE
        };
        let limited = limits(Some(30), 1);
        assert_eq!(
            measured.interval(&limited, slow),
            None,
            "or its figures would measure the pause"
        );
    }

    /// Frames in ten seconds of a clock that is not real: each takes `drawing`, and the system wakes up to a
    /// millisecond late.
    fn frames(attention: Attention, preferences: &Preferences, drawing: Duration) -> u32 {
        let start = Instant::now();
        let mut now = start;
        let mut pace = Pace::new(start);
        let mut frames = 0;
        while now < start + Duration::from_secs(10) {
            let interval = attention.interval(preferences, drawing);
            pace.begin(now, interval);
            now += drawing;
            frames += 1;
            if let Some(next) = pace.next(attention.interval(preferences, drawing), start) {
                let late = Duration::from_micros(u64::from(frames * 377 % 1000));
                now = now.max(next + late);
            }
        }
        frames
    }

    #[test]
    fn frames_come_as_often_as_they_may() {
        let quick = Duration::from_millis(1);
        for limit in [30, 60, 144, 500] {
            let counted = frames(AT_WORK, &limits(Some(limit), 10), quick);
            assert!(
                counted.abs_diff(10 * limit) <= 2,
                "{counted} frames at {limit} per second"
            );
        }
        for limit in [1, 10, 60] {
            let counted = frames(BESIDE, &limits(None, limit), quick);
            assert!(
                counted.abs_diff(10 * limit) <= 2,
                "{counted} frames at {limit} per second, beside"
            );
        }
        let free = frames(AT_WORK, &limits(None, 10), quick);
        assert_eq!(free, 10_000, "nothing waits without a limit");
        let slow = frames(AT_WORK, &limits(Some(60), 10), Duration::from_millis(50));
        assert_eq!(slow, 200, "nor where frames take longer");
    }

    #[test]
    fn a_frame_that_is_late_does_not_make_the_next_ones_hurry() {
        let start = Instant::now();
        let interval = Some(Duration::from_millis(10));
        let at = |ms| start + Duration::from_millis(ms);
        let mut pace = Pace::new(start);
        pace.begin(at(14), interval);
        assert_eq!(pace.next(interval, start), Some(at(20)));
        pace.begin(at(500), interval);
        assert_eq!(pace.next(interval, start), Some(at(510)));
        // The system has not drawn what was requested.
        assert_eq!(pace.next(interval, at(510)), Some(at(520)));
        assert_eq!(pace.next(None, at(510)), None);
    }

    #[test]
    fn world_time_neither_stands_nor_leaps_while_frames_are_rare() {
        for wait in [Duration::from_millis(100), IDLE] {
            let mut clock = WorldClock::default();
            clock.advance(wait.as_secs_f64());
            assert_eq!(clock.time_s, wait.as_secs_f64());
        }
    }
}
