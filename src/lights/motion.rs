//! How lamps change with world time: pure functions of t, in f64 so that they stay precise after hours.

use std::f64::consts::TAU;

use glam::{DMat3, DVec3};

use crate::world::Motion;
use crate::world::materials::hash::hash;

/// The properties of a lamp that motions change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    pub position_ws: DVec3,
    /// Linear RGB.
    pub colour: DVec3,
    /// Multiplies the lamp's power.
    pub gain: f64,
}

/// Applies motions in order. `seed` gives this lamp a flicker of its own.
pub fn apply(motions: &[Motion], start: Moment, time_s: f64, seed: u32) -> Moment {
    motions
        .iter()
        .fold(start, |now, motion| step(motion, now, time_s, seed))
}

/// The seed of one lamp of a preset.
pub fn lamp_seed(world_seed: u32, index: u32) -> u32 {
    hash(world_seed ^ hash(index))
}

fn step(motion: &Motion, mut now: Moment, time_s: f64, seed: u32) -> Moment {
    let angle = |rate: f32, phase: f32| f64::from(rate) * time_s + f64::from(phase);
    match motion {
        Motion::Orbit {
            radius,
            rate,
            phase,
        } => {
            let (sin, cos) = angle(*rate, *phase).sin_cos();
            now.position_ws += radius.as_dvec3() * DVec3::new(cos, sin, sin);
        }
        Motion::Bob {
            amplitude,
            rate,
            phase,
        } => {
            now.position_ws += amplitude.as_dvec3() * angle(*rate, *phase).sin();
        }
        Motion::Flicker { amount, rate } => {
            now.gain *= 1.0 - f64::from(*amount) * flicker(time_s * f64::from(*rate), seed);
        }
        Motion::Pulse {
            amount,
            rate,
            phase,
        } => {
            now.gain *= 1.0 - f64::from(*amount) * (0.5 + 0.5 * angle(*rate, *phase).sin());
        }
        Motion::Path { points, speed } => {
            let points: Vec<DVec3> = points.iter().map(|p| p.as_dvec3()).collect();
            if let Some(path) = ClosedPath::new(points) {
                now.position_ws = path.at(time_s * f64::from(*speed));
            }
        }
        Motion::HueCycle { rate } => now.colour = turn_hue(now.colour, time_s * f64::from(*rate)),
    }
    now
}

/// Smooth noise in [0, 1] over time (in periods): a slow sway and a quick tremble.
fn flicker(t: f64, seed: u32) -> f64 {
    0.65 * value_noise(t, seed) + 0.35 * value_noise(2.7 * t, hash(seed))
}

/// One-dimensional value noise in [0, 1] with continuous second derivative (Perlin's 2002 fade).
fn value_noise(t: f64, seed: u32) -> f64 {
    let cell = t.floor();
    let f = t - cell;
    let fade = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    // Wrapping to 32 bits repeats the noise after 4 billion periods.
    let value = |cell: i64| f64::from(hash(seed ^ hash(cell as u32))) / f64::from(u32::MAX);
    let cell = cell as i64;
    value(cell) * (1.0 - fade) + value(cell + 1) * fade
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

/// Luminance weights of linear Rec. 709.
const LUMINANCE: DVec3 = DVec3::new(0.2126, 0.7152, 0.0722);

/// Turns the hue of a linear colour by `turns` full turns in Oklab (Ottosson 2020), so that the
/// perceived lightness stays about the same. Values outside Rec. 709 are clipped, and the luminance (Y)
/// is restored exactly.
fn turn_hue(colour: DVec3, turns: f64) -> DVec3 {
    let luminance = colour.dot(LUMINANCE);
    if luminance <= 0.0 {
        return colour;
    }
    let mut lab = OKLAB_FROM_CONES * (CONES_FROM_RGB * colour).map(f64::cbrt);
    let (sin, cos) = (turns.rem_euclid(1.0) * TAU).sin_cos();
    (lab.y, lab.z) = (cos * lab.y - sin * lab.z, sin * lab.y + cos * lab.z);
    let cones = (OKLAB_FROM_CONES.inverse() * lab).map(|c| c * c * c);
    let turned = (CONES_FROM_RGB.inverse() * cones).max(DVec3::ZERO);
    turned * (luminance / turned.dot(LUMINANCE))
}

const CONES_FROM_RGB: DMat3 = DMat3::from_cols(
    DVec3::new(0.412_221_470_8, 0.211_903_498_2, 0.088_302_461_9),
    DVec3::new(0.536_332_536_3, 0.680_699_545_1, 0.281_718_837_6),
    DVec3::new(0.051_445_992_9, 0.107_396_956_6, 0.629_978_700_5),
);

const OKLAB_FROM_CONES: DMat3 = DMat3::from_cols(
    DVec3::new(0.210_454_255_3, 1.977_998_495_1, 0.025_904_037_1),
    DVec3::new(0.793_617_785_0, -2.428_592_205_0, 0.782_771_766_2),
    DVec3::new(-0.004_072_046_8, 0.450_593_709_9, -0.808_675_766_0),
);

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use proptest::prelude::*;

    const START: Moment = Moment {
        position_ws: DVec3::new(1.0, 2.0, 3.0),
        colour: DVec3::ONE,
        gain: 1.0,
    };

    fn after(motion: Motion, time_s: f64) -> Moment {
        apply(&[motion], START, time_s, 5)
    }

    #[test]
    fn an_orbit_keeps_its_radius_and_returns() {
        let orbit = || Motion::Orbit {
            radius: Vec3::new(4.0, 0.0, 4.0),
            rate: 0.5,
            phase: 0.3,
        };
        for step in 0..50 {
            let at = after(orbit(), f64::from(step) * 0.37).position_ws;
            assert!((at.distance(START.position_ws) - 4.0).abs() < 1e-9);
        }
        let round = TAU / 0.5;
        assert!(
            after(orbit(), 1.0)
                .position_ws
                .distance(after(orbit(), 1.0 + round).position_ws)
                < 1e-9
        );
    }

    #[test]
    fn a_bob_starts_at_rest_and_reaches_its_amplitude() {
        let bob = || Motion::Bob {
            amplitude: Vec3::Y * 2.0,
            rate: 1.0,
            phase: 0.0,
        };
        assert_eq!(after(bob(), 0.0).position_ws, START.position_ws);
        assert!((after(bob(), TAU / 4.0).position_ws.y - 4.0).abs() < 1e-9);
    }

    #[test]
    fn flicker_and_pulse_stay_within_their_bounds_and_use_them() {
        for motion in [
            Motion::Flicker {
                amount: 0.4,
                rate: 5.0,
            },
            Motion::Pulse {
                amount: 0.4,
                rate: 2.0,
                phase: 0.0,
            },
        ] {
            let gains: Vec<f64> = (0..5000)
                .map(|i| after(motion.clone(), f64::from(i) * 0.011).gain)
                .collect();
            let lowest = gains.iter().copied().fold(f64::INFINITY, f64::min);
            let highest = gains.iter().copied().fold(0.0, f64::max);
            assert!(
                lowest >= 0.6 - 1e-7 && highest <= 1.0 + 1e-7,
                "{motion:?}: {lowest}..{highest}"
            );
            assert!(
                highest - lowest > 0.3,
                "{motion:?} hardly moves: {lowest}..{highest}"
            );
            let jump = gains
                .windows(2)
                .map(|w| (w[1] - w[0]).abs())
                .fold(0.0, f64::max);
            assert!(jump < 0.1, "{motion:?} jumps by {jump}");
        }
    }

    #[test]
    fn flicker_is_continuous_across_its_cells_and_before_zero() {
        for cell in -3..4 {
            let edge = f64::from(cell);
            assert!((value_noise(edge - 1e-6, 1) - value_noise(edge + 1e-6, 1)).abs() < 1e-9);
        }
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
        let motion = Motion::Path {
            points: vec![Vec3::X],
            speed: 2.0,
        };
        assert_eq!(after(motion, 9.0).position_ws, DVec3::X);
        let empty = Motion::Path {
            points: vec![],
            speed: 2.0,
        };
        assert_eq!(after(empty, 9.0).position_ws, START.position_ws);
    }

    #[test]
    fn a_third_of_a_turn_makes_red_greenish_and_a_whole_turn_gives_it_back() {
        let red = DVec3::new(1.0, 0.05, 0.02);
        let third = turn_hue(red, 1.0 / 3.0);
        assert!(third.y > third.x && third.y > third.z, "{third}");
        assert!(
            turn_hue(red, 1.0).distance(red) < 1e-5,
            "{}",
            turn_hue(red, 1.0)
        );
    }

    #[test]
    fn white_has_no_hue_to_turn() {
        assert!(turn_hue(DVec3::ONE, 0.4).distance(DVec3::ONE) < 1e-3);
    }

    proptest! {
        #[test]
        fn a_hue_cycle_keeps_luminance_and_stays_in_gamut(
            r in 0.0..2.0f64, g in 0.0..2.0f64, b in 0.0..2.0f64, turns in -3.0..3.0f64,
        ) {
            let colour = DVec3::new(r, g, b);
            let turned = turn_hue(colour, turns);
            prop_assert!((turned.dot(LUMINANCE) - colour.dot(LUMINANCE)).abs() < 1e-9);
            prop_assert!(turned.cmpge(DVec3::ZERO).all() && turned.is_finite());
        }

        /// No motion jumps: within a millisecond nothing moves farther than its speed allows.
        #[test]
        fn motions_are_continuous(time_s in 0.0..1e4f64) {
            let points = vec![Vec3::ZERO, Vec3::X * 9.0, Vec3::new(3.0, 4.0, 5.0), Vec3::Y * 2.0];
            for (motion, speed) in [
                (Motion::Orbit { radius: Vec3::splat(4.0), rate: 1.0, phase: 0.0 }, 7.0),
                (Motion::Bob { amplitude: Vec3::splat(4.0), rate: 1.0, phase: 0.0 }, 7.0),
                (Motion::Path { points, speed: 3.0 }, 3.2),
            ] {
                let moved = after(motion.clone(), time_s).position_ws
                    .distance(after(motion, time_s + 1e-3).position_ws);
                prop_assert!(moved <= speed * 1e-3, "{moved}");
            }
        }
    }
}
