//! Colours for data that has no order: states of probes, levels of a field.
//!
//! Seven colours of Okabe & Ito 2008 (*Color Universal Design*) and of P. Tol 2021 (*Colour Schemes*, muted), chosen so
//! that every two of them differ for eyes that lack one kind of cone: a test simulates those. Data that has an order is
//! shown in [magma](super::magma), whose lightness alone tells the order.

use super::tonemap::linear_from_srgb;

crate::shared! {
    in color;

    pub const PALETTE_COLOURS: usize = 7;

    /// Display values (sRGB-encoded): indigo, light blue, green, yellow, pink, wine, olive.
    pub const PALETTE: [[f32; 3]; PALETTE_COLOURS] = [
        display(0x33_2288),
        display(0x88_ccee),
        display(0x11_7733),
        display(0xf0_e442),
        display(0xcc_79a7),
        display(0x88_2255),
        display(0x99_9933),
    ];
}

const fn display(hex: u32) -> [f32; 3] {
    let [_, r, g, b] = hex.to_be_bytes();
    [r as f32 / 255.0, g as f32 / 255.0, b as f32 / 255.0]
}

/// Linear light of a colour of the palette, as shaders work with it.
pub fn linear(index: usize) -> [f32; 3] {
    PALETTE[index].map(|value| linear_from_srgb(f64::from(value)) as f32)
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, DVec3};

    use super::*;

    /// What eyes without one kind of cone see of linear light: Machado, Oliveira & Fernandes 2009 (*A Physiologically-based
    /// Model for Simulation of Color Vision Deficiency*), table 1, severity 1. Rows.
    const DEFICIENCIES: [(&str, [[f64; 3]; 3]); 3] = [
        (
            "protanopia",
            [
                [0.152_286, 1.052_583, -0.204_868],
                [0.114_503, 0.786_281, 0.099_216],
                [-0.003_882, -0.048_116, 1.051_998],
            ],
        ),
        (
            "deuteranopia",
            [
                [0.367_322, 0.860_646, -0.227_968],
                [0.280_085, 0.672_501, 0.047_413],
                [-0.011_820, 0.042_940, 0.968_881],
            ],
        ),
        (
            "tritanopia",
            [
                [1.255_528, -0.076_749, -0.178_779],
                [-0.078_411, 0.930_809, 0.147_602],
                [0.004_733, 0.691_367, 0.303_900],
            ],
        ),
    ];

    /// CIE 1976 L*a*b* of linear Rec. 709 light, with its white.
    fn lab(linear: DVec3) -> DVec3 {
        let xyz = DMat3::from_cols_array_2d(&[
            [0.412_456, 0.212_673, 0.019_334],
            [0.357_576, 0.715_152, 0.119_192],
            [0.180_437, 0.072_175, 0.950_304],
        ]) * linear;
        let white = DVec3::new(0.950_47, 1.0, 1.088_83);
        let f = (xyz / white).map(|t| {
            if t > 216.0 / 24389.0 {
                t.cbrt()
            } else {
                (24389.0 / 27.0 * t + 16.0) / 116.0
            }
        });
        DVec3::new(116.0 * f.y - 16.0, 500.0 * (f.x - f.y), 200.0 * (f.y - f.z))
    }

    /// The smallest ΔE (CIE 1976) of two of these colours, as an eye with this deficiency sees them.
    fn least_difference(colours: &[DVec3], rows: &[[f64; 3]; 3]) -> f64 {
        let seen = DMat3::from_cols_array_2d(rows).transpose();
        let labs: Vec<DVec3> = colours
            .iter()
            .map(|colour| lab((seen * *colour).clamp(DVec3::ZERO, DVec3::ONE)))
            .collect();
        let pairs = labs
            .iter()
            .enumerate()
            .flat_map(|(index, a)| labs[..index].iter().map(move |b| a.distance(*b)));
        pairs.fold(f64::INFINITY, f64::min)
    }

    fn palette() -> Vec<DVec3> {
        (0..PALETTE.len())
            .map(|index| DVec3::from(linear(index).map(f64::from)))
            .collect()
    }

    /// Ten times what a practised eye tells apart side by side.
    const APART: f64 = 23.0;

    #[test]
    fn the_colours_differ_for_every_eye() {
        let identity = DMat3::IDENTITY.to_cols_array_2d();
        assert!(least_difference(&palette(), &identity) > APART);
        for (name, rows) in DEFICIENCIES {
            let least = least_difference(&palette(), &rows);
            assert!(least > APART, "{name}: {least:.1}");
        }
    }

    #[test]
    fn the_colours_that_states_had_before_fail_the_same_test() {
        let before = [
            [0.05, 0.52, 0.08],
            [0.89, 0.43, 0.01],
            [0.62, 0.08, 0.75],
            [0.04, 0.48, 0.58],
            [0.03, 0.11, 0.63],
            [0.53, 0.02, 0.02],
        ]
        .map(DVec3::from);
        let least = DEFICIENCIES.map(|(_, rows)| least_difference(&before, &rows));
        assert!(least.iter().any(|least| *least < 10.0), "{least:?}");
    }

    #[test]
    fn lightness_of_magma_rises_for_every_eye() {
        for (name, rows) in DEFICIENCIES {
            let seen = DMat3::from_cols_array_2d(&rows).transpose();
            let mut before = -1.0;
            for step in 0..=32 {
                let display = super::super::magma::magma(step as f32 / 32.0);
                let light = DVec3::from(display.map(|value| linear_from_srgb(f64::from(value))));
                let lightness = lab((seen * light).clamp(DVec3::ZERO, DVec3::ONE)).x;
                assert!(lightness > before, "{name}: step {step}");
                before = lightness;
            }
        }
    }

    #[test]
    fn differences_are_those_of_the_standard() {
        assert!(lab(DVec3::ONE).distance(DVec3::new(100.0, 0.0, 0.0)) < 0.05);
        let red = lab(DVec3::X);
        assert!(
            red.distance(DVec3::new(53.24, 80.09, 67.20)) < 0.05,
            "{red}"
        );
    }
}
