//! Colours as the FLIP observer distinguishes them.

use glam::{DMat3, DVec3};

use super::super::tonemap::linear_from_srgb;

/// Exponent q_c of the paper: it stretches small colour differences.
const COLOUR_POWER: f64 = 0.7;
/// This share p_c of the largest colour difference is mapped to p_t of the scale.
const COMMON_SHARE: f64 = 0.4;
const COMMON_MAPPED: f64 = 0.95;

/// Linear Rec. 709 to CIE XYZ under D65; the columns are the primaries.
const XYZ_FROM_RGB: DMat3 = DMat3::from_cols(
    DVec3::new(
        10_135_552.0 / 24_577_794.0,
        2_613_072.0 / 12_288_897.0,
        1_425_312.0 / 73_733_382.0,
    ),
    DVec3::new(
        8_788_810.0 / 24_577_794.0,
        8_788_810.0 / 12_288_897.0,
        8_788_810.0 / 73_733_382.0,
    ),
    DVec3::new(
        4_435_075.0 / 24_577_794.0,
        887_015.0 / 12_288_897.0,
        70_074_185.0 / 73_733_382.0,
    ),
);

/// XYZ relative to the white of the display, so that white is (1, 1, 1).
fn relative_xyz(linear: DVec3) -> DVec3 {
    XYZ_FROM_RGB * linear / (XYZ_FROM_RGB * DVec3::ONE)
}

/// Display values to YCxCz: CIELAB without its cube root, in which light may be averaged.
pub fn ycxcz(display: [f32; 3]) -> [f32; 3] {
    let encoded = DVec3::from_array(display.map(f64::from)).clamp(DVec3::ZERO, DVec3::ONE);
    let xyz = relative_xyz(encoded.map(linear_from_srgb));
    [
        116.0 * xyz.y - 16.0,
        500.0 * (xyz.x - xyz.y),
        200.0 * (xyz.y - xyz.z),
    ]
    .map(|value| value as f32)
}

/// YCxCz, limited to what a display can show, to CIELAB with chroma scaled by lightness (Hunt).
pub fn hunt_lab([y, cx, cz]: [f32; 3]) -> [f32; 3] {
    let y = (f64::from(y) + 16.0) / 116.0;
    let xyz = DVec3::new(y + f64::from(cx) / 500.0, y, y - f64::from(cz) / 200.0);
    let white = XYZ_FROM_RGB * DVec3::ONE;
    let linear = XYZ_FROM_RGB.inverse() * (xyz * white);
    lab_of(linear.clamp(DVec3::ZERO, DVec3::ONE)).map(|value| value as f32)
}

/// CIELAB of linear light in [0, 1], its chroma scaled by lightness.
fn lab_of(linear: DVec3) -> [f64; 3] {
    let root = |t: f64| {
        const DELTA: f64 = 6.0 / 29.0;
        if t > DELTA * DELTA * DELTA {
            t.cbrt()
        } else {
            t / (3.0 * DELTA * DELTA) + 4.0 / 29.0
        }
    };
    let f = relative_xyz(linear).map(root);
    let lightness = 116.0 * f.y - 16.0;
    let hunt = 0.01 * lightness;
    [
        lightness,
        hunt * 500.0 * (f.x - f.y),
        hunt * 200.0 * (f.y - f.z),
    ]
}

/// HyAB (Abasi et al. 2020) to the power q_c.
fn raised_hyab(a: [f64; 3], b: [f64; 3]) -> f64 {
    let difference = DVec3::from_array(a) - DVec3::from_array(b);
    (difference.x.abs() + difference.y.hypot(difference.z)).powf(COLOUR_POWER)
}

/// The difference between the green and the blue primary: no two displayed colours are farther apart.
pub fn most_colour_difference() -> f64 {
    raised_hyab(lab_of(DVec3::Y), lab_of(DVec3::Z))
}

/// In [0, 1]: common differences take most of the scale, the largest ones are compressed above.
pub fn colour_difference(a: [f32; 3], b: [f32; 3], most: f64) -> f32 {
    let difference = raised_hyab(a.map(f64::from), b.map(f64::from));
    let common = COMMON_SHARE * most;
    let mapped = if difference < common {
        COMMON_MAPPED * difference / common
    } else {
        COMMON_MAPPED + (1.0 - COMMON_MAPPED) * (difference - common) / (most - common)
    };
    mapped as f32
}
