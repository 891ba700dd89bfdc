//! How lamps change with world time: pure functions of t, in f64 so that they stay precise after hours.

use std::f64::consts::TAU;

use glam::{DMat3, DVec3, Vec3};

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

/// A number that lamps of this colour share which have the same gain at all times; `None`: the gain is always 1.
pub fn rhythm(motions: &[Motion], colour: Vec3, seed: u32) -> Option<u32> {
    let of_colour = || (colour.to_array()).map(f32::to_bits);
    let numbers = motions.iter().filter_map(|motion| match *motion {
        Motion::Flicker { amount, rate } => {
            (amount != 0.0).then(|| [0, amount.to_bits(), rate.to_bits(), seed])
        }
        Motion::Pulse {
            amount,
            rate,
            phase,
        } => (amount != 0.0).then(|| [1, amount.to_bits(), rate.to_bits(), phase.to_bits()]),
        Motion::HueCycle { rate } => (rate != 0.0).then(|| {
            let [red, green, blue] = of_colour();
            [2, rate.to_bits(), red, hash(green ^ hash(blue))]
        }),
        Motion::Travel(_) => None,
    });
    numbers.flatten().fold(None, |known, number| {
        Some(hash(known.unwrap_or(0) ^ hash(number)))
    })
}

/// The colour at which the gain of a lamp is 1 in each channel. If its hue turns, a channel may be dark at first: then it is white
/// of the same luminance, which stays as it is.
pub fn colour_at_full(motions: &[Motion], colour: DVec3) -> DVec3 {
    let turns = |motion: &Motion| matches!(*motion, Motion::HueCycle { rate } if rate != 0.0);
    if motions.iter().any(turns) {
        DVec3::splat(colour.dot(LUMINANCE))
    } else {
        colour
    }
}

/// The seed of one lamp of a preset.
pub fn lamp_seed(world_seed: u32, index: u32) -> u32 {
    hash(world_seed ^ hash(index))
}

fn step(motion: &Motion, mut now: Moment, time_s: f64, seed: u32) -> Moment {
    let angle = |rate: f32, phase: f32| f64::from(rate) * time_s + f64::from(phase);
    match motion {
        Motion::Travel(travel) => now.position_ws = travel.apply(now.position_ws, time_s),
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
    }
}
