//! How often the window draws: at the rate of the display while somebody works with it, and rarely otherwise.

use std::time::Duration;

/// Time between two frames of a window that is visible but not in use: enough to follow changes of the light.
const BESIDE: Duration = Duration::from_millis(100);
/// Time between two checks of a window that nobody sees.
const IDLE: Duration = Duration::from_millis(250);
/// Pauses are at least REST times as long as the frames before them, so that even slow frames leave most of the
/// time free.
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
    /// The pause after a frame that took `drawing`; `None` where the display alone sets the pace.
    pub fn pause(self, drawing: Duration) -> Option<Duration> {
        let Self {
            focused,
            hidden,
            measured,
        } = self;
        match (hidden, focused || measured) {
            (true, _) => Some(IDLE),
            (false, false) => Some(BESIDE.max(REST * drawing)),
            (false, true) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::clock::WorldClock;

    #[test]
    fn a_window_without_focus_leaves_the_machine_to_others() {
        let at_work = Attention {
            focused: true,
            hidden: false,
            measured: false,
        };
        let [quick, slow] = [1, 400].map(Duration::from_millis);
        assert_eq!(at_work.pause(slow), None);
        let beside = Attention {
            focused: false,
            ..at_work
        };
        assert_eq!(beside.pause(quick), Some(BESIDE));
        assert_eq!(beside.pause(slow), Some(3 * slow), "a quarter of the time");
        let hidden = Attention {
            hidden: true,
            ..at_work
        };
        assert_eq!(hidden.pause(quick), Some(IDLE));
        let measured = Attention {
            measured: true,
            ..beside
        };
        assert_eq!(
            measured.pause(slow),
            None,
            "or its figures would measure the pause"
        );
    }

    #[test]
    fn world_time_neither_stands_nor_leaps_while_frames_are_rare() {
        for wait in [BESIDE, IDLE] {
            let mut clock = WorldClock::default();
            clock.advance(wait.as_secs_f64());
            assert_eq!(clock.time_s, wait.as_secs_f64());
        }
    }
}
