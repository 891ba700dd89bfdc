//! Which lamps rest: what was found out about a lamp's shadows holds until the lamp moves.

use super::{LampState, Lights};

/// Since which frame each lamp has had its present place, direction and shape.
#[derive(Clone, Debug, Default)]
pub struct RestingLamps {
    /// `None` before the first frame.
    lamps: Option<Vec<(LampState, u32)>>,
}

impl RestingLamps {
    /// Forgets all lamps: frames are numbered from the start again.
    pub fn forget(&mut self) {
        self.lamps = None;
    }

    /// For each lamp the first frame of its present place, direction and shape, whatever its power; 0 for the lamps of
    /// the first call. `frame` is the number of the next frame, at least 1.
    pub fn follow(&mut self, lights: &Lights, frame: u32) -> Vec<u32> {
        let first = if self.lamps.is_none() { 0 } else { frame };
        let mut known = self.lamps.take().unwrap_or_default().into_iter();
        let since = |lamp: &LampState| match known.next() {
            Some((before, since)) if is_same_place(lamp, &before) => since,
            _ => first,
        };
        let since: Vec<u32> = lights.lamps.iter().map(since).collect();
        let lamps = lights.lamps.iter().copied();
        self.lamps = Some(lamps.zip(since.iter().copied()).collect());
        since
    }
}

/// Lamps that have moved at most this many frames before the last that moved count as unsettled.
const LATELY_FRAMES: u32 = 8;

/// Which lamps have stood still for a while, so that nobody needs to ask about each.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Settled {
    /// Of the first 64 lamps those that have moved lately, one bit each.
    pub unsettled: [u32; 2],
    /// All others have stood still since this frame.
    pub since: u32,
    /// And all of them since this one.
    pub moved_last: u32,
}

impl Settled {
    /// Of lamps that rest since these frames ([`RestingLamps::follow`]).
    pub fn of(still_since: &[u32]) -> Self {
        let newest = still_since.iter().copied().max().unwrap_or(0);
        let is_unsettled = |since: u32| since > 0 && since + LATELY_FRAMES > newest;
        let mut settled = Self {
            moved_last: newest,
            ..Self::default()
        };
        for (lamp, &since) in still_since.iter().enumerate() {
            match settled.unsettled.get_mut(lamp / 32) {
                Some(word) if is_unsettled(since) => *word |= 1 << (lamp % 32),
                _ => settled.since = settled.since.max(since),
            }
        }
        settled
    }
}

/// Whether a lamp is where it was, whatever its power.
pub(super) fn is_same_place(lamp: &LampState, before: &LampState) -> bool {
    let placed = LampState {
        intensity: lamp.intensity,
        rhythm: lamp.rhythm,
        ..*before
    };
    *lamp == placed
}

#[cfg(test)]
pub(super) mod tests {
    use glam::{DVec3, Vec3};

    use super::*;
    use crate::{
        lights::{LampShape, Rhythm},
        world::Sky,
    };

    /// Point lamps: places along x, and powers.
    pub fn lights(lamps: &[(f64, f64)]) -> Lights {
        let lamp = |&(x, power): &(f64, f64)| LampState {
            shape: LampShape::Point,
            position_ws: DVec3::X * x,
            direction_ws: DVec3::ZERO,
            intensity: DVec3::splat(power),
            radius: 0.1,
            soft_radius: 0.0,
            rhythm: None,
        };
        Lights {
            lamps: lamps.iter().map(lamp).collect(),
            sky: Sky {
                zenith: Vec3::ZERO,
                horizon: Vec3::ZERO,
                ground: Vec3::ZERO,
            },
        }
    }

    #[test]
    fn lamps_rest_until_they_move_and_power_is_no_move() {
        let mut rest = RestingLamps::default();
        assert_eq!(rest.follow(&lights(&[(0.0, 1.0), (4.0, 1.0)]), 1), [0, 0]);
        assert_eq!(rest.follow(&lights(&[(0.0, 0.2), (4.0, 1.0)]), 2), [0, 0]);
        assert_eq!(rest.follow(&lights(&[(0.0, 0.2), (4.5, 1.0)]), 3), [0, 3]);
        assert_eq!(rest.follow(&lights(&[(0.0, 0.2), (4.5, 1.0)]), 9), [0, 3]);
        let mut pulsing = lights(&[(0.0, 0.2), (4.5, 1.0)]);
        pulsing.lamps[0].rhythm = Some(Rhythm {
            number: 7,
            gain: DVec3::splat(0.2),
            full: DVec3::ONE,
        });
        assert_eq!(rest.follow(&pulsing, 10), [0, 3]);
    }

    #[test]
    fn lamps_that_come_have_not_rested() {
        let mut rest = RestingLamps::default();
        rest.follow(&lights(&[(0.0, 1.0)]), 1);
        assert_eq!(rest.follow(&lights(&[(0.0, 1.0), (2.0, 1.0)]), 7), [0, 7]);
        assert_eq!(rest.follow(&lights(&[(2.0, 1.0)]), 8), [8]);
        // The first lamp of a world that was dark comes late, too.
        assert_eq!(rest.follow(&lights(&[]), 9), [0; 0]);
        assert_eq!(rest.follow(&lights(&[(2.0, 1.0)]), 12), [12]);
        rest.forget();
        assert_eq!(rest.follow(&lights(&[(3.0, 1.0)]), 1), [0]);
    }

    #[test]
    fn lamps_that_moved_lately_are_unsettled() {
        let mut since = vec![0, 90, 100, 40, 93, 0];
        let settled = Settled::of(&since);
        assert_eq!(settled.unsettled, [0b1_0100, 0]);
        assert_eq!(settled.since, 90);
        // Of lamps beyond the 64th there are no bits: they count for all.
        since.resize(66, 0);
        since[40] = 99;
        since[65] = 100;
        let settled = Settled::of(&since);
        assert_eq!(settled.unsettled, [0b1_0100, 1 << 8]);
        assert_eq!(settled.since, 100);
        assert_eq!(Settled::of(&[0; 3]), Settled::default());
        assert_eq!(Settled::of(&[]), Settled::default());
    }
}
