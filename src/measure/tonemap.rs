//! From linear HDR to display values: exposure, a filmic curve, the sRGB encoding. The GPU does the
//! same in `shaders/color/tonemap.wesl`; a test compares the two.
//!
//! The curve is AgX (Troy Sobotka 2022, <https://github.com/sobotka/AgX>): log2 encoding, a sigmoid
//! about middle grey, between an inset and an outset of the primaries. It was chosen because these
//! worlds feature coloured lamps: the inset lets a bright red or blue light pass through its own tints
//! towards white, where per-channel curves (Reinhard, Hable, ACES fits) turn orange to yellow and blue
//! to violet. Two deviations: the sigmoid is in closed form, not the published table; and a look
//! (saturation and contrast) restores the depth that the base curve removes and leaves to a colourist.

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use super::picture::Picture;

/// A linear picture as display values: sRGB-encoded, in [0, 1]. `exposure_ev` doubles the light per
/// unit. NaN and negative light become black, infinite light white.
pub fn tone_mapped(linear: &Picture, exposure_ev: f32) -> Picture {
    let gain = f64::from(exposure_ev).exp2();
    let map = |rgb: &[f32; 3]| {
        let light = DVec3::from_array(rgb.map(f64::from)) * gain;
        tone_map(light).to_array().map(|value| value as f32)
    };
    Picture {
        width: linear.width,
        height: linear.height,
        rgb: linear.rgb.par_iter().map(map).collect(),
    }
}

/// Values that are not light, such as an albedo, as display values: sRGB-encoded and clamped, but
/// neither exposed nor tone-mapped.
pub fn encoded(data: &Picture) -> Picture {
    let encode = |value: f32| srgb_from_linear(guarded(f64::from(value)).min(1.0)) as f32;
    Picture {
        width: data.width,
        height: data.height,
        rgb: data.rgb.iter().map(|rgb| rgb.map(encode)).collect(),
    }
}

/// One exposed linear colour to sRGB-encoded display values in [0, 1].
pub fn tone_map(light: DVec3) -> DVec3 {
    agx(light.map(guarded)).map(srgb_from_linear)
}

crate::shared! {
    in color;

    /// Brighter light counts as this: 16 stops above white, far beyond the end of the curve.
    const BRIGHTEST: f64 = 65504.0;

    /// The curve works between these stops relative to 1: from 10 stops below middle grey (0.18) to 6.5
    /// above.
    const LOG2_MIN: f64 = -12.473_931_188_332_413;
    const LOG2_MAX: f64 = 4.026_068_811_667_588;

    /// Saturation about the luminance: the look.
    const LOOK_SATURATION: f64 = 1.25;

    /// Luminance weights of linear Rec. 709.
    const LUMINANCE: DVec3 = DVec3::new(0.2126, 0.7152, 0.0722);

    /// Stops between the darkest and the brightest light.
    use LOG2_MAX - LOG2_MIN => LOG2_RANGE: f64;

    /// Rec. 709 to the inset primaries; each row sums to 1, so greys stay grey.
    const INSET: DMat3 = DMat3::from_cols(
        DVec3::new(0.842_401_071, 0.042_401_071, 0.042_401_071),
        DVec3::new(0.078_436_502, 0.878_436_502, 0.078_436_502),
        DVec3::new(0.079_162_427, 0.079_162_427, 0.879_162_427),
    );

    /// The inverse.
    use INSET.inverse() => OUTSET: DMat3;

    /// Pieces of each of the [`curves`].
    const CURVE_PIECES: u32 = 1024;
}

/// Power on the encoded values: the rest of the look.
const LOOK_POWER: f64 = 1.15;

/// Where middle grey lies on the log2 scale, and the slope there; powers of toe and shoulder.
const PIVOT: f64 = 10.0 / 16.5;
const SLOPE: f64 = 2.0;
const TOE: f64 = 3.0;
const SHOULDER: f64 = 3.25;

fn guarded(light: f64) -> f64 {
    if light.is_nan() {
        0.0
    } else {
        light.clamp(0.0, BRIGHTEST)
    }
}

/// Luminance of linear Rec. 709.
pub fn luminance([r, g, b]: [f32; 3]) -> f64 {
    LUMINANCE.dot(DVec3::new(r.into(), g.into(), b.into()))
}

/// Linear light to linear display light in [0, 1].
fn agx(light: DVec3) -> DVec3 {
    let log2 = (INSET * light).map(|value| value.max(1e-10).log2());
    let encoded = ((log2 - LOG2_MIN) / (LOG2_MAX - LOG2_MIN)).clamp(DVec3::ZERO, DVec3::ONE);
    let curved = encoded.map(contrast);
    let grey = DVec3::splat(curved.dot(LUMINANCE));
    let looked = grey.lerp(curved, LOOK_SATURATION);
    let display = (INSET.inverse() * looked).clamp(DVec3::ZERO, DVec3::ONE);
    display.map(linear_display)
}

/// The curves of single channels, which all are powers of something, as the GPU reads them: first that from the log2 scale to the
/// look, then that from there to the sRGB encoding. Each begins at 0, ends at 1, and is straight in `CURVE_PIECES` pieces; of
/// each piece the value at its beginning, and by how much it grows. Off by less than 1e-5.
pub fn curves() -> Vec<[f32; 2]> {
    let encoding = |x| srgb_from_linear(linear_display(x));
    let pieces = |curve: &dyn Fn(f64) -> f64| -> Vec<[f32; 2]> {
        let at = |piece: u32| curve(f64::from(piece) / f64::from(CURVE_PIECES));
        let piece = |piece| [at(piece), at(piece + 1) - at(piece)];
        (0..CURVE_PIECES)
            .map(|number| piece(number).map(|value| value as f32))
            .collect()
    };
    [pieces(&contrast), pieces(&encoding)].concat()
}

/// From the log2 scale in [0, 1].
fn contrast(x: f64) -> f64 {
    sigmoid(x).powf(LOOK_POWER)
}

/// What is looked at to linear display light.
fn linear_display(x: f64) -> f64 {
    x.powf(2.2)
}

/// From (0, 0) through (PIVOT, ½) with slope SLOPE to (1, 1):
/// ½ + s·d·(1 + k·|d|^p)^(−1/p), d = x − PIVOT, where k makes the curve meet its corner.
fn sigmoid(x: f64) -> f64 {
    let offset = x - PIVOT;
    let (reach, power) = if offset < 0.0 {
        (PIVOT, TOE)
    } else {
        (1.0 - PIVOT, SHOULDER)
    };
    let k = bend(reach, power);
    let value = 0.5 + SLOPE * offset * (1.0 + k * offset.abs().powf(power)).powf(-1.0 / power);
    value.clamp(0.0, 1.0)
}

/// `k` of [`sigmoid`], for a distance `reach` between the pivot and the corner.
fn bend(reach: f64, power: f64) -> f64 {
    ((SLOPE * reach / 0.5).powf(power) - 1.0) / reach.powf(power)
}

/// Linear display light to its sRGB encoding (IEC 61966-2-1).
pub fn srgb_from_linear(linear: f64) -> f64 {
    if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    }
}

/// The inverse of [`srgb_from_linear`].
pub fn linear_from_srgb(encoded: f64) -> f64 {
    if encoded <= 0.040_45 {
        encoded / 12.92
    } else {
        ((encoded + 0.055) / 1.055).powf(2.4)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_sigmoid_meets_its_corners_and_its_pivot() {
        assert!(sigmoid(0.0).abs() < 1e-12);
        assert!((sigmoid(1.0) - 1.0).abs() < 1e-12);
        assert_eq!(sigmoid(PIVOT), 0.5);
        let slope = (sigmoid(PIVOT + 1e-6) - sigmoid(PIVOT - 1e-6)) / 2e-6;
        assert!((slope - SLOPE).abs() < 1e-4, "{slope}");
    }

    #[test]
    fn straight_pieces_are_as_good_as_the_curves() {
        let curves = curves();
        let encoding = |x| srgb_from_linear(linear_display(x));
        let all: [&dyn Fn(f64) -> f64; 2] = [&contrast, &encoding];
        for (number, curve) in all.into_iter().enumerate() {
            for step in 0..=20_000 {
                let x = f64::from(step) / 20_000.0;
                let place = x * f64::from(CURVE_PIECES);
                let piece = (place as usize).min(CURVE_PIECES as usize - 1);
                let [first, growth] = curves[number * CURVE_PIECES as usize + piece].map(f64::from);
                let found = first + growth * (place - piece as f64);
                assert!((found - curve(x)).abs() < 1e-5, "{number} at {x}");
            }
        }
    }

    #[test]
    fn greys_stay_grey_and_grow_with_the_light() {
        let mut last = -1.0;
        for step in 0..=200 {
            let value = tone_map(DVec3::splat(0.001 * 1.1f64.powi(step)));
            assert!(value.max_element() - value.min_element() < 1e-6, "{value}");
            assert!(value.x >= last, "darker with more light at step {step}");
            last = value.x;
        }
        assert!(last > 0.999);
        assert_eq!(tone_map(DVec3::ZERO), DVec3::ZERO);
    }

    #[test]
    fn middle_grey_stays_near_the_middle() {
        let display = tone_map(DVec3::splat(0.18)).x;
        assert!((0.35..0.5).contains(&display), "{display}");
    }

    #[test]
    fn a_bright_lamp_keeps_its_hue_on_the_way_to_white() {
        for (colour, strongest) in [(DVec3::X, 0), (DVec3::Y, 1), (DVec3::Z, 2)] {
            for ev in -6..=4 {
                let value = tone_map(colour * f64::from(ev).exp2());
                for channel in (0..3).filter(|&channel| channel != strongest) {
                    assert!(
                        value[strongest] > value[channel],
                        "{colour} at {ev} EV gives {value}"
                    );
                }
            }
            assert!(
                tone_map(colour * 1e4).min_element() > 0.7,
                "{colour} never turns pale"
            );
        }
    }

    #[test]
    fn nan_light_is_black_and_infinite_light_white() {
        let bad = Picture {
            width: 4,
            height: 1,
            rgb: vec![
                [f32::NAN; 3],
                [f32::INFINITY; 3],
                [f32::NEG_INFINITY; 3],
                [-1.0; 3],
            ],
        };
        let shown = tone_mapped(&bad, 0.0);
        assert_eq!(shown.rgb[0], [0.0; 3]);
        assert!(shown.rgb[1][0] > 0.999);
        assert_eq!(shown.rgb[2], [0.0; 3]);
        assert_eq!(shown.rgb[3], [0.0; 3]);
    }

    #[test]
    fn one_stop_doubles_the_light() {
        let grey = |value: f32| Picture {
            width: 1,
            height: 1,
            rgb: vec![[value; 3]],
        };
        assert_eq!(tone_mapped(&grey(0.25), 1.0), tone_mapped(&grey(0.5), 0.0));
        assert_ne!(tone_mapped(&grey(0.25), 0.9), tone_mapped(&grey(0.5), 0.0));
    }

    proptest! {
        #[test]
        fn srgb_there_and_back(value in 0.0..=1.0f64) {
            prop_assert!((linear_from_srgb(srgb_from_linear(value)) - value).abs() < 1e-6);
        }

        #[test]
        fn every_light_is_shown_within_the_display(r in -1e9..1e9f64, g in -1e3..1e3f64, b in -1.0..1.0f64) {
            let value = tone_map(DVec3::new(r, g, b));
            prop_assert!(value.cmpge(DVec3::ZERO).all() && value.cmple(DVec3::ONE).all());
        }
    }
}
