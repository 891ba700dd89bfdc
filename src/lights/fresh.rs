//! Which lamps have moved, come or gone on lately: rays that choose among the lamps that they know to be seen cannot know
//! about these yet.

use super::{LampState, Lights, rest::is_same_place};

/// A lamp that grows by more than this factor in one frame has gone on.
const GROWTH: f64 = 2.0;

/// Until when each of the first 64 lamps is fresh.
#[derive(Clone, Debug, Default)]
pub struct FreshLamps {
    /// Each lamp in the frame before, and the first frame in which it is no longer fresh.
    lamps: Vec<(LampState, u64)>,
}

impl FreshLamps {
    /// Forgets all lamps: frames are numbered from the start again.
    pub fn forget(&mut self) {
        self.lamps.clear();
    }

    /// Of the first 64 lamps those that have moved, come or gone on in this frame or within `kept` frames before it, one bit
    /// each. Lamps of the first call are not fresh: nothing is known of any lamp then.
    pub fn follow(&mut self, lights: &Lights, frame: u64, kept: u64) -> [u32; 2] {
        let is_first = self.lamps.is_empty();
        let mut bits = [0; 2];
        self.lamps.truncate(lights.lamps.len());
        for (number, lamp) in lights.lamps.iter().take(64).enumerate() {
            let before = self.lamps.get(number);
            let was_known = before.is_some_and(|(before, _)| {
                is_same_place(lamp, before) && power(lamp) <= GROWTH * power(before)
            });
            let until = match before {
                Some((_, until)) if was_known => *until,
                _ if is_first => 0,
                _ => frame + 1 + kept,
            };
            if frame < until {
                bits[number / 32] |= 1 << (number % 32);
            }
            match self.lamps.get_mut(number) {
                Some(known) => *known = (*lamp, until),
                None => self.lamps.push((*lamp, until)),
            }
        }
        bits
    }
}

fn power(lamp: &LampState) -> f64 {
    lamp.intensity.element_sum()
}

#[cfg(test)]
mod tests {
    use super::{super::rest::tests::lights, *};

    fn on(powers: &[f64]) -> Lights {
        let lamps: Vec<(f64, f64)> = powers.iter().map(|&power| (0.0, power)).collect();
        lights(&lamps)
    }

    #[test]
    fn a_lamp_that_goes_on_is_fresh_for_a_while() {
        let mut fresh = FreshLamps::default();
        assert_eq!(fresh.follow(&on(&[1.0, 0.0]), 0, 4), [0, 0]);
        assert_eq!(fresh.follow(&on(&[1.0, 0.5]), 1, 4), [0b10, 0]);
        for frame in 2..6 {
            assert_eq!(fresh.follow(&on(&[0.0, 0.5]), frame, 4), [0b10, 0]);
        }
        assert_eq!(fresh.follow(&on(&[0.0, 0.5]), 6, 4), [0, 0]);
        assert_eq!(fresh.follow(&on(&[1.0, 0.5]), 7, 4), [0b01, 0]);
    }

    #[test]
    fn a_lamp_that_moves_is_fresh_until_it_has_rested() {
        let mut fresh = FreshLamps::default();
        fresh.follow(&lights(&[(0.0, 1.0), (1.0, 1.0)]), 0, 2);
        for frame in 1..9 {
            let lamps = [(0.0, 1.0), (1.0 + frame as f64, 1.0)];
            assert_eq!(fresh.follow(&lights(&lamps), frame, 2), [0b10, 0]);
        }
        let rests = lights(&[(0.0, 1.0), (9.0, 1.0)]);
        assert_eq!(fresh.follow(&rests, 9, 2), [0b10, 0]);
        assert_eq!(fresh.follow(&rests, 10, 2), [0b10, 0]);
        assert_eq!(fresh.follow(&rests, 11, 2), [0, 0]);
    }

    #[test]
    fn lamps_that_flicker_or_go_out_are_not_fresh() {
        let mut fresh = FreshLamps::default();
        for (frame, power) in [1.0, 0.6, 1.1, 0.2, 0.3, 0.0].into_iter().enumerate() {
            let bits = fresh.follow(&on(&[power]), frame as u64, 4);
            assert_eq!(bits, [0, 0], "{power}");
        }
    }

    #[test]
    fn a_lamp_that_is_hung_is_fresh_and_only_the_first_64_count() {
        let mut fresh = FreshLamps::default();
        fresh.follow(&on(&[1.0; 40]), 0, 4);
        assert_eq!(fresh.follow(&on(&[1.0; 70]), 1, 4), [0, 0xffff_ff00]);
        assert_eq!(fresh.follow(&on(&[1.0; 30]), 2, 4), [0, 0]);
        fresh.forget();
        assert_eq!(fresh.follow(&on(&[1.0; 70]), 0, 4), [0, 0]);
    }
}
