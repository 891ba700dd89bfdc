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

fn is_same_place(lamp: &LampState, before: &LampState) -> bool {
    let placed = LampState {
        intensity: lamp.intensity,
        ..*before
    };
    *lamp == placed
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, Vec3};

    use super::*;
    use crate::{lights::LampShape, world::Sky};

    fn lights(lamps: &[(f64, f64)]) -> Lights {
        let lamp = |&(x, power): &(f64, f64)| LampState {
            shape: LampShape::Point,
            position_ws: DVec3::X * x,
            direction_ws: DVec3::ZERO,
            intensity: DVec3::splat(power),
            radius: 0.1,
            soft_radius: 0.0,
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
}
