//! Ways along which lamps and bodies travel: pure functions of world time, in f64 so that they stay precise after hours.

use glam::{DVec3, Vec3};

/// How a place changes with world time t (seconds).
#[derive(Clone, Debug, PartialEq)]
pub enum Travel {
    /// Adds radius · (cos a, sin a, sin a) per axis, with a = rate·t + phase.
    Orbit { radius: Vec3, rate: f32, phase: f32 },
    /// Adds amplitude · sin(rate·t + phase).
    Bob {
        amplitude: Vec3,
        rate: f32,
        phase: f32,
    },
    /// Follows a closed Catmull–Rom path through `points` (world space) at `speed` voxels per second.
    Path { points: Vec<Vec3>, speed: f32 },
}

impl Travel {
    /// Where something is (world space) that would be at `position` without this.
    pub fn apply(&self, position: DVec3, time_s: f64) -> DVec3 {
        let angle = |rate: f32, phase: f32| f64::from(rate) * time_s + f64::from(phase);
        match self {
            Self::Orbit {
                radius,
                rate,
                phase,
            } => {
                let (sin, cos) = angle(*rate, *phase).sin_cos();
                position + radius.as_dvec3() * DVec3::new(cos, sin, sin)
            }
            Self::Bob {
                amplitude,
                rate,
                phase,
            } => position + amplitude.as_dvec3() * angle(*rate, *phase).sin(),
            Self::Path { points, speed } => {
                let points: Vec<DVec3> = points.iter().map(|p| p.as_dvec3()).collect();
                let path = ClosedPath::new(points);
                path.map_or(position, |path| path.at(time_s * f64::from(*speed)))
            }
        }
    }
}

/// A closed uniform Catmull–Rom spline (Catmull & Rom 1974), walked by arc length.
#[derive(Clone, Debug)]
pub struct ClosedPath {
    points: Vec<DVec3>,
    /// Arc length up to the end of each chord; [`CHORDS`] chords per segment.
    lengths: Vec<f64>,
}

/// Chords that measure the length of one segment. The speed varies within a chord: by a twentieth where
/// a path turns sharply.
const CHORDS: usize = 64;

impl ClosedPath {
    /// None without points.
    pub fn new(points: Vec<DVec3>) -> Option<Self> {
        let mut at = *points.first()?;
        let mut length = 0.0;
        let mut lengths = Vec::with_capacity(points.len() * CHORDS);
        for chord in 1..=points.len() * CHORDS {
            let next = spline(&points, chord as f64 / CHORDS as f64);
            length += next.distance(at);
            lengths.push(length);
            at = next;
        }
        Some(Self { points, lengths })
    }

    /// Length of one lap.
    pub fn length(&self) -> f64 {
        self.lengths.last().copied().unwrap_or(0.0)
    }

    /// The place after travelling `distance` from the first point; any real number.
    pub fn at(&self, distance: f64) -> DVec3 {
        let length = self.length();
        if length <= 0.0 {
            return self.points[0];
        }
        let along = distance.rem_euclid(length);
        let chord = self
            .lengths
            .partition_point(|&end| end <= along)
            .min(self.lengths.len() - 1);
        let start = if chord == 0 {
            0.0
        } else {
            self.lengths[chord - 1]
        };
        let within = (along - start) / (self.lengths[chord] - start);
        spline(&self.points, (chord as f64 + within) / CHORDS as f64)
    }
}

/// The closed spline at parameter s: point i is at s = i.
fn spline(points: &[DVec3], s: f64) -> DVec3 {
    let count = points.len();
    let segment = s.floor();
    let t = s - segment;
    let point = |offset: usize| points[(segment as usize + count - 1 + offset) % count];
    let [p0, p1, p2, p3] = [point(0), point(1), point(2), point(3)];
    0.5 * (2.0 * p1
        + (p2 - p0) * t
        + (2.0 * p0 - 5.0 * p1 + 4.0 * p2 - p3) * (t * t)
        + (3.0 * p1 - p0 - 3.0 * p2 + p3) * (t * t * t))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use proptest::prelude::*;

    use super::*;

    const START: DVec3 = DVec3::new(1.0, 2.0, 3.0);

    fn after(travel: Travel, time_s: f64) -> DVec3 {
        travel.apply(START, time_s)
    }

    #[test]
    fn an_orbit_keeps_its_radius_and_returns() {
        let orbit = || Travel::Orbit {
            radius: Vec3::new(4.0, 0.0, 4.0),
            rate: 0.5,
            phase: 0.3,
        };
        for step in 0..50 {
            let at = after(orbit(), f64::from(step) * 0.37);
            assert!((at.distance(START) - 4.0).abs() < 1e-9);
        }
        let round = TAU / 0.5;
        assert!(after(orbit(), 1.0).distance(after(orbit(), 1.0 + round)) < 1e-9);
    }

    #[test]
    fn a_bob_starts_at_rest_and_reaches_its_amplitude() {
        let bob = || Travel::Bob {
            amplitude: Vec3::Y * 2.0,
            rate: 1.0,
            phase: 0.0,
        };
        assert_eq!(after(bob(), 0.0), START);
        assert!((after(bob(), TAU / 4.0).y - 4.0).abs() < 1e-9);
    }

    fn square() -> ClosedPath {
        let corners = [(0.0, 0.0), (8.0, 0.0), (8.0, 6.0), (0.0, 6.0)];
        ClosedPath::new(corners.map(|(x, z)| DVec3::new(x, 1.0, z)).to_vec()).expect("four points")
    }

    #[test]
    fn a_path_passes_its_points_and_closes() {
        let path = square();
        assert!(
            path.length() > 28.0,
            "a rounded loop outside the square: {}",
            path.length()
        );
        assert_eq!(path.at(0.0), DVec3::new(0.0, 1.0, 0.0));
        assert!(
            path.at(path.length() / 2.0)
                .distance(DVec3::new(8.0, 1.0, 6.0))
                < 1e-6,
            "by symmetry"
        );
        for d in [0.0, 3.3, 17.0] {
            assert!(path.at(d).distance(path.at(d + path.length())) < 1e-9);
            assert!(path.at(d).distance(path.at(d - 3.0 * path.length())) < 1e-9);
        }
    }

    #[test]
    fn a_path_is_walked_at_an_even_speed() {
        let path = square();
        let step = path.length() / 1000.0;
        for i in 0..2000 {
            let walked = path
                .at(f64::from(i) * step)
                .distance(path.at(f64::from(i + 1) * step));
            assert!(
                (walked / step - 1.0).abs() < 0.1,
                "{walked} instead of {step} at {i}"
            );
        }
    }

    #[test]
    fn a_path_of_one_point_stands_still() {
        let motion = Travel::Path {
            points: vec![Vec3::X],
            speed: 2.0,
        };
        assert_eq!(after(motion, 9.0), DVec3::X);
        let empty = Travel::Path {
            points: vec![],
            speed: 2.0,
        };
        assert_eq!(after(empty, 9.0), START);
    }

    proptest! {
        /// No travel jumps: within a millisecond nothing moves farther than its speed allows.
        #[test]
        fn travels_are_continuous(time_s in 0.0..1e4f64) {
            let points = vec![Vec3::ZERO, Vec3::X * 9.0, Vec3::new(3.0, 4.0, 5.0), Vec3::Y * 2.0];
            for (travel, speed) in [
                (Travel::Orbit { radius: Vec3::splat(4.0), rate: 1.0, phase: 0.0 }, 7.0),
                (Travel::Bob { amplitude: Vec3::splat(4.0), rate: 1.0, phase: 0.0 }, 7.0),
                (Travel::Path { points, speed: 3.0 }, 3.2),
            ] {
                let moved = after(travel.clone(), time_s)
                    .distance(after(travel, time_s + 1e-3));
                prop_assert!(moved <= speed * 1e-3, "{moved}");
            }
        }
    }
}
