//! How bodies move: pure functions of world time, in f64 so that they stay precise after hours.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3, Vec3};

use super::super::Travel;

/// How a body moves with world time t (seconds). All motions of a body add up: each moves the pivot, or turns the body
/// about it.
#[derive(Clone, Debug, PartialEq)]
pub enum BodyMotion {
    /// Moves the pivot, as lamps travel.
    Travel(Travel),
    /// Turns for ever about `axis` by `rate` radians per second.
    Turn { axis: Vec3, rate: f32 },
    /// Turns once, by `degrees` from `start_s` to `end_s` (seconds).
    TurnBetween {
        axis: Vec3,
        degrees: f32,
        start_s: f32,
        end_s: f32,
        ease: Ease,
    },
    /// Turns by `degrees` and back, again and again.
    Swing {
        axis: Vec3,
        degrees: f32,
        cycle: Cycle,
    },
    /// Moves the pivot by `by` (voxels, world space) and back, again and again.
    Lift { by: Vec3, cycle: Cycle },
}

/// The speed of a motion from its beginning to its end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ease {
    /// Starts and stops gently: 3t² − 2t³.
    #[default]
    Smooth,
    /// The same speed throughout.
    Linear,
}

impl Ease {
    /// How much of the way is done after `share` of the time; both 0 … 1.
    fn apply(self, share: f64) -> f64 {
        match self {
            Self::Smooth => share * share * (3.0 - 2.0 * share),
            Self::Linear => share,
        }
    }
}

/// A way there and back that repeats: a rest, the way there, a rest, the way back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cycle {
    /// Seconds until everything repeats.
    pub period_s: f32,
    /// Seconds of each rest; less than half of the period.
    pub rest_s: f32,
    /// Seconds of the cycle that are over at t = 0.
    pub phase_s: f32,
}

impl Cycle {
    /// Share of the way that is done at a world time, 0 … 1.
    fn share(&self, time_s: f64) -> f64 {
        let [period_s, rest_s] = [self.period_s, self.rest_s].map(f64::from);
        let way_s = period_s / 2.0 - rest_s;
        let now_s = (time_s + f64::from(self.phase_s)).rem_euclid(period_s);
        // The way back is the way there in a mirror.
        let since_rest_s = now_s.min(period_s - now_s + rest_s) - rest_s;
        Ease::Smooth.apply((since_rest_s / way_s).clamp(0.0, 1.0))
    }
}

/// Where a pivot is, and how its body is turned.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moment {
    pub position: DVec3,
    /// Turns model space into world space.
    pub rotation: DQuat,
}

impl BodyMotion {
    /// Whether the body stands still with this motion at all times.
    pub fn is_still(&self) -> bool {
        match self {
            Self::Travel(Travel::Orbit {
                radius: way, rate, ..
            })
            | Self::Travel(Travel::Bob {
                amplitude: way,
                rate,
                ..
            }) => *way == Vec3::ZERO || *rate == 0.0,
            Self::Travel(Travel::Path { speed, .. }) => *speed == 0.0,
            Self::Turn { rate, .. } => *rate == 0.0,
            Self::TurnBetween { degrees, .. } | Self::Swing { degrees, .. } => *degrees == 0.0,
            Self::Lift { by, .. } => *by == Vec3::ZERO,
        }
    }

    /// Adds this motion to those before it.
    pub(super) fn apply(&self, mut now: Moment, time_s: f64) -> Moment {
        let turn = |axis: &Vec3, angle: f64| {
            DQuat::from_axis_angle(axis.as_dvec3().normalize(), angle.rem_euclid(TAU))
        };
        match self {
            Self::Travel(travel) => now.position = travel.apply(now.position, time_s),
            Self::Turn { axis, rate } => now.rotation *= turn(axis, f64::from(*rate) * time_s),
            Self::TurnBetween {
                axis,
                degrees,
                start_s,
                end_s,
                ease,
            } => {
                let [start_s, end_s] = [start_s, end_s].map(|s| f64::from(*s));
                let share = ((time_s - start_s) / (end_s - start_s)).clamp(0.0, 1.0);
                now.rotation *= turn(axis, f64::from(*degrees).to_radians() * ease.apply(share));
            }
            Self::Swing {
                axis,
                degrees,
                cycle,
            } => {
                let angle = f64::from(*degrees).to_radians() * cycle.share(time_s);
                now.rotation *= turn(axis, angle);
            }
            Self::Lift { by, cycle } => now.position += by.as_dvec3() * cycle.share(time_s),
        }
        now
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const START: Moment = Moment {
        position: DVec3::new(1.0, 2.0, 3.0),
        rotation: DQuat::IDENTITY,
    };

    /// Degrees about +Y, −180 … 180.
    fn yaw_deg(motion: &BodyMotion, time_s: f64) -> f64 {
        let x = motion.apply(START, time_s).rotation * DVec3::X;
        (-x.z).atan2(x.x).to_degrees()
    }

    #[test]
    fn a_turn_between_begins_and_ends_in_time_and_stays() {
        for ease in [Ease::Smooth, Ease::Linear] {
            let motion = BodyMotion::TurnBetween {
                axis: Vec3::Y * 3.0,
                degrees: 45.0,
                start_s: 3.5,
                end_s: 5.5,
                ease,
            };
            for (time_s, degrees) in [
                (0.0, 0.0),
                (3.5, 0.0),
                (4.5, 22.5),
                (5.5, 45.0),
                (1e5, 45.0),
            ] {
                assert!(
                    (yaw_deg(&motion, time_s) - degrees).abs() < 1e-9,
                    "{ease:?}"
                );
            }
            let quarter = if ease == Ease::Linear { 0.25 } else { 0.156_25 };
            assert!(
                (yaw_deg(&motion, 4.0) - 45.0 * quarter).abs() < 1e-9,
                "{ease:?}"
            );
        }
    }

    #[test]
    fn a_turn_goes_on_for_ever_and_stays_precise() {
        let rate = 0.75f32;
        let motion = BodyMotion::Turn {
            axis: Vec3::Y,
            rate,
        };
        let round_s = TAU / f64::from(rate);
        for rounds in [0.0, 3.0, 1e5] {
            let degrees = yaw_deg(&motion, (rounds + 0.125) * round_s);
            assert!((degrees - 45.0).abs() < 1e-5, "{degrees} after {rounds}");
        }
    }

    #[test]
    fn a_lift_waits_at_both_ends_and_a_door_shuts_again() {
        let cycle = Cycle {
            period_s: 20.0,
            rest_s: 4.0,
            phase_s: 0.0,
        };
        let lift = BodyMotion::Lift {
            by: Vec3::Y * 10.0,
            cycle,
        };
        let height = |time_s: f64| lift.apply(START, time_s).position.y - START.position.y;
        for (time_s, there) in [
            (0.0, 0.0),
            (4.0, 0.0),
            (7.0, 5.0),
            (10.0, 10.0),
            (14.0, 10.0),
            (17.0, 5.0),
            (20.0, 0.0),
            (-13.0, 5.0),
            (2e6 + 7.0, 5.0),
        ] {
            assert!(
                (height(time_s) - there).abs() < 1e-9,
                "{time_s}: {}",
                height(time_s)
            );
        }
        let door = BodyMotion::Swing {
            axis: Vec3::Y,
            degrees: -90.0,
            cycle: Cycle {
                phase_s: 10.0,
                ..cycle
            },
        };
        assert!((yaw_deg(&door, 0.0) + 90.0).abs() < 1e-9, "it begins open");
        assert!(yaw_deg(&door, 10.0).abs() < 1e-9);
    }

    /// Within a millisecond nothing goes farther than its greatest speed allows.
    #[test]
    fn nothing_jumps() {
        let cycle = Cycle {
            period_s: 6.0,
            rest_s: 1.0,
            phase_s: 0.4,
        };
        let lift = BodyMotion::Lift {
            by: Vec3::X * 8.0,
            cycle,
        };
        let at = |ms: u32| lift.apply(START, f64::from(ms) * 1e-3).position;
        // 3/2 of the mean speed of 8 voxels in 2 seconds.
        let fastest = (0..12_000).map(|ms| at(ms).distance(at(ms + 1)) * 1e3);
        let fastest = fastest.fold(0.0, f64::max);
        assert!((fastest - 6.0).abs() < 1e-3, "{fastest}");
    }
}
