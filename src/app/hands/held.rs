//! A button that is held repeats its stroke, in simulated time: at the same moments whatever the frame rate.

use super::brush::Stroke;

/// Nanoseconds between the strokes of a held button.
const DIG_EVERY_NS: u64 = 200_000_000;
const PLACE_EVERY_NS: u64 = 400_000_000;
/// No button repeats sooner than this (nanoseconds): a click that spans two of the longest frames is one stroke.
const FIRST_NS: u64 = 300_000_000;

/// The button that is down.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Held {
    /// Its stroke, and when that is due again (nanoseconds of the run).
    next: Option<(Stroke, u64)>,
}

impl Held {
    /// The button of `stroke` goes down, and its first stroke is made.
    pub fn begin(&mut self, stroke: Stroke, now_ns: u64) {
        let first = every_ns(stroke).map(|every| (stroke, now_ns + every.max(FIRST_NS)));
        self.next = first;
    }

    /// The button of `stroke` goes up. Another one that went down later stays down.
    pub fn end(&mut self, stroke: Stroke) {
        self.next.take_if(|(held, _)| *held == stroke);
    }

    /// All buttons go up.
    pub fn end_all(&mut self) {
        self.next = None;
    }

    /// When the next stroke is due, if that is not after `to_ns`.
    pub fn due_ns(&self, to_ns: u64) -> Option<u64> {
        self.next.map(|(_, due)| due).filter(|due| *due <= to_ns)
    }

    /// The stroke that is due at `now_ns`; the one after it becomes due.
    pub fn take_due(&mut self, now_ns: u64) -> Option<Stroke> {
        let (stroke, due_ns) = self.next.as_mut()?;
        if *due_ns > now_ns {
            return None;
        }
        *due_ns += every_ns(*stroke)?;
        Some(*stroke)
    }
}

/// `None` for strokes that do not repeat.
fn every_ns(stroke: Stroke) -> Option<u64> {
    match stroke {
        Stroke::Dig => Some(DIG_EVERY_NS),
        Stroke::Place | Stroke::Replace => Some(PLACE_EVERY_NS),
        Stroke::Pick => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Times (ms) of the strokes within two seconds, looked at in frames of this length (ms).
    fn strokes(stroke: Stroke, frame_ms: u64) -> Vec<u64> {
        const MS: u64 = 1_000_000;
        let mut held = Held::default();
        held.begin(stroke, 7 * MS);
        let mut times = Vec::new();
        for frame in 1..=2000 / frame_ms {
            let to_ns = frame * frame_ms * MS;
            while let Some(due_ns) = held.due_ns(to_ns) {
                assert_eq!(held.take_due(due_ns), Some(stroke));
                times.push(due_ns / MS);
            }
            assert_eq!(held.take_due(to_ns), None);
        }
        times
    }

    #[test]
    fn strokes_repeat_at_the_same_times_at_any_frame_rate() {
        let dug = [307, 507, 707, 907, 1107, 1307, 1507, 1707, 1907];
        let placed = [407, 807, 1207, 1607];
        for frame_ms in [2, 16, 250] {
            assert_eq!(strokes(Stroke::Dig, frame_ms), dug);
            assert_eq!(strokes(Stroke::Place, frame_ms), placed);
            assert_eq!(strokes(Stroke::Replace, frame_ms), placed);
            assert!(strokes(Stroke::Pick, frame_ms).is_empty());
        }
    }

    #[test]
    fn the_button_that_goes_up_ends_its_own_stroke_alone() {
        let mut held = Held::default();
        held.begin(Stroke::Dig, 0);
        held.begin(Stroke::Place, 0);
        held.end(Stroke::Dig);
        assert!(held.due_ns(u64::MAX).is_some());
        held.end(Stroke::Place);
        assert_eq!(held.due_ns(u64::MAX), None);
    }
}
