//! Noise fields: a base noise of the `noise` crate under an optional fractal.

use glam::DVec3;
use serde::Deserialize;

/// A named scalar field over space. The GPU evaluates the same field from the same permutation
/// tables (`shaders/sdf/noise.wesl`).
#[derive(Clone, Debug, PartialEq)]
pub struct NoiseField {
    pub name: String,
    pub basis: Basis,
    pub fractal: Fractal,
    /// Multiplies the coordinates, per axis (0 makes the field constant along that axis).
    pub frequency: DVec3,
    /// Added to the coordinates after the frequency.
    pub offset: DVec3,
    pub seed: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum Basis {
    Perlin,
    OpenSimplex,
    /// Euclidean distance to the nearest feature point.
    Worley,
    Value,
}

#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Fractal {
    None,
    Fbm {
        octaves: u32,
        #[serde(default = "two")]
        lacunarity: f64,
        #[serde(default = "half")]
        persistence: f64,
    },
    Ridged {
        octaves: u32,
        #[serde(default = "two")]
        lacunarity: f64,
        #[serde(default = "half")]
        persistence: f64,
    },
    Billow {
        octaves: u32,
        #[serde(default = "two")]
        lacunarity: f64,
        #[serde(default = "half")]
        persistence: f64,
    },
}

fn two() -> f64 {
    2.0
}

fn half() -> f64 {
    0.5
}
