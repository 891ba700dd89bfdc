//! The trees that the tests sample.

use glam::{DVec3, Vec3};

use super::super::Sdf;
use crate::world::noise::{Basis, Fractal, NoiseField};

pub fn noises() -> Vec<NoiseField> {
    let field = |basis, fractal, frequency: f64| NoiseField {
        name: String::new(),
        basis,
        fractal,
        frequency: DVec3::splat(frequency),
        offset: DVec3::new(0.2, 0.4, 0.6),
        seed: 11,
    };
    vec![
        field(
            Basis::Perlin,
            Fractal::Fbm {
                octaves: 4,
                lacunarity: 2.0,
                persistence: 0.5,
            },
            0.07,
        ),
        field(
            Basis::OpenSimplex,
            Fractal::Ridged {
                octaves: 3,
                lacunarity: 2.0,
                persistence: 0.5,
            },
            0.05,
        ),
        field(Basis::Worley, Fractal::None, 0.1),
        field(
            Basis::Value,
            Fractal::Billow {
                octaves: 2,
                lacunarity: 2.0,
                persistence: 0.5,
            },
            0.09,
        ),
    ]
}

pub fn sphere(radius: f32) -> Sdf {
    Sdf::Sphere { radius }
}

pub fn moved(by: [f32; 3], of: Sdf) -> Sdf {
    Sdf::Translate {
        by: by.into(),
        of: Box::new(of),
    }
}

pub fn scattered(of: Sdf, cell: f32, jitter: f32, scale: (f32, f32), reach: f32) -> Sdf {
    Sdf::Scatter {
        min: Vec3::splat(-20.0),
        max: Vec3::new(20.0, 9.0, 25.0),
        cell,
        probability: 0.6,
        jitter,
        scale,
        reach,
        seed: 5,
        of: Box::new(of),
    }
}

/// One tree per node kind, then combinations.
pub fn trees() -> Vec<Sdf> {
    let rounded = Sdf::RoundedBox {
        half: Vec3::new(5.0, 2.0, 3.0),
        radius: 1.5,
    };
    let capsule = Sdf::Capsule {
        from: Vec3::new(-4.0, 0.0, 2.0),
        to: Vec3::new(6.0, 5.0, 0.0),
        radius: 2.0,
    };
    let pair = || {
        vec![
            moved([-3.0, 0.0, 1.0], sphere(6.0)),
            moved([4.0, 2.0, 0.0], sphere(5.0)),
        ]
    };
    let turned = Sdf::Rotate {
        degrees: Vec3::new(30.0, 40.0, 50.0),
        of: Box::new(rounded.clone()),
    };
    vec![
        sphere(7.0),
        Sdf::Box {
            half: Vec3::new(3.0, 6.0, 2.0),
        },
        rounded.clone(),
        capsule.clone(),
        Sdf::Cylinder {
            radius: 4.0,
            half_height: 7.0,
        },
        Sdf::Torus {
            major: 8.0,
            minor: 2.5,
        },
        Sdf::Plane {
            normal: Vec3::new(1.0, 2.0, -0.5),
            offset: 3.0,
        },
        Sdf::HeightField {
            noise: 0,
            base: -2.0,
            amplitude: 6.0,
            step: 0.0,
        },
        Sdf::HeightField {
            noise: 0,
            base: -2.0,
            amplitude: 6.0,
            step: 1.0,
        },
        Sdf::Union(pair()),
        Sdf::Intersection(pair()),
        Sdf::Subtraction(pair()),
        Sdf::SmoothUnion { k: 3.0, of: pair() },
        Sdf::SmoothIntersection { k: 3.0, of: pair() },
        Sdf::SmoothSubtraction { k: 3.0, of: pair() },
        turned.clone(),
        Sdf::Scale {
            by: 2.5,
            of: Box::new(capsule.clone()),
        },
        Sdf::Repeat {
            period: Vec3::new(18.0, 0.0, 15.0),
            of: Box::new(turned.clone()),
        },
        Sdf::Repeat {
            period: Vec3::splat(12.0),
            of: Box::new(moved([3.0, -2.0, 4.0], sphere(5.0))),
        },
        Sdf::Displace {
            noise: 0,
            amplitude: 3.0,
            of: Box::new(sphere(9.0)),
        },
        Sdf::Displace {
            noise: 1,
            amplitude: 2.0,
            of: Box::new(sphere(9.0)),
        },
        Sdf::Warp {
            noise: 3,
            amplitude: 2.0,
            of: Box::new(capsule.clone()),
        },
        scattered(sphere(3.0), 8.0, 0.3, (0.5, 1.5), 3.0),
        scattered(
            moved(
                [1.0, 1.0, 0.0],
                Sdf::Cylinder {
                    radius: 1.0,
                    half_height: 3.0,
                },
            ),
            14.0,
            0.5,
            (1.0, 1.4),
            5.0,
        ),
        // Its own function crawls far from the copy: the cut-off must hold all the same.
        scattered(
            Sdf::Intersection(vec![
                sphere(2.5),
                Sdf::HeightField {
                    noise: 0,
                    base: 0.0,
                    amplitude: 9.0,
                    step: 0.0,
                },
            ]),
            7.0,
            0.2,
            (0.8, 1.2),
            2.5,
        ),
        Sdf::Subtraction(vec![
            Sdf::Union(vec![
                rounded,
                Sdf::Plane {
                    normal: Vec3::Y,
                    offset: -4.0,
                },
            ]),
            Sdf::Warp {
                noise: 2,
                amplitude: 1.5,
                of: Box::new(moved([2.0, 3.0, 0.0], capsule)),
            },
            scattered(
                Sdf::Displace {
                    noise: 3,
                    amplitude: 0.5,
                    of: Box::new(sphere(2.0)),
                },
                6.0,
                0.1,
                (1.0, 1.5),
                2.6,
            ),
        ]),
    ]
}
