//! The trees that the tests sample.

use glam::DVec3;

use crate::world::noise::{Basis, Fractal, NoiseField};
use crate::world::sdf::{
    Capsule, Cuboid, Cylinder, Displace, HeightField, Intersection, Plane, Repeat, Rotate,
    RoundedBox, Scale, Scatter, Sdf, SmoothIntersection, SmoothSubtraction, SmoothUnion, Sphere,
    Subtraction, Torus, Translate, Union, Warp,
};

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

pub fn sphere(radius: f64) -> Sdf {
    Sdf::from(Sphere { radius })
}

pub fn moved(by: [f64; 3], of: Sdf) -> Sdf {
    Sdf::from(Translate {
        by: by.into(),
        of: Box::new(of),
    })
}

pub fn scattered(of: Sdf, cell: f64, jitter: f64, scale: (f64, f64), reach: f64) -> Sdf {
    Sdf::from(Scatter {
        min: DVec3::splat(-20.0),
        max: DVec3::new(20.0, 9.0, 25.0),
        cell,
        probability: 0.6,
        jitter,
        scale,
        reach,
        seed: 5,
        of: Box::new(of),
    })
}

/// One tree per node kind, then combinations.
pub fn trees() -> Vec<Sdf> {
    let rounded = Sdf::from(RoundedBox {
        half: DVec3::new(5.0, 2.0, 3.0),
        radius: 1.5,
    });
    let capsule = Sdf::from(Capsule {
        from: DVec3::new(-4.0, 0.0, 2.0),
        to: DVec3::new(6.0, 5.0, 0.0),
        radius: 2.0,
    });
    let pair = || {
        vec![
            moved([-3.0, 0.0, 1.0], sphere(6.0)),
            moved([4.0, 2.0, 0.0], sphere(5.0)),
        ]
    };
    let turned = Sdf::from(Rotate {
        degrees: DVec3::new(30.0, 40.0, 50.0),
        of: Box::new(rounded.clone()),
    });
    vec![
        sphere(7.0),
        Sdf::from(Cuboid {
            half: DVec3::new(3.0, 6.0, 2.0),
        }),
        rounded.clone(),
        capsule.clone(),
        Sdf::from(Cylinder {
            radius: 4.0,
            half_height: 7.0,
        }),
        Sdf::from(Torus {
            major: 8.0,
            minor: 2.5,
        }),
        Sdf::from(Plane {
            normal: DVec3::new(1.0, 2.0, -0.5),
            offset: 3.0,
        }),
        Sdf::from(HeightField {
            noise: 0,
            base: -2.0,
            amplitude: 6.0,
            step: 0.0,
        }),
        Sdf::from(HeightField {
            noise: 0,
            base: -2.0,
            amplitude: 6.0,
            step: 1.0,
        }),
        Sdf::from(Union(pair())),
        Sdf::from(Intersection(pair())),
        Sdf::from(Subtraction(pair())),
        Sdf::from(SmoothUnion { k: 3.0, of: pair() }),
        Sdf::from(SmoothIntersection { k: 3.0, of: pair() }),
        Sdf::from(SmoothSubtraction { k: 3.0, of: pair() }),
        turned.clone(),
        Sdf::from(Scale {
            by: 2.5,
            of: Box::new(capsule.clone()),
        }),
        Sdf::from(Repeat {
            period: DVec3::new(18.0, 0.0, 15.0),
            of: Box::new(turned.clone()),
        }),
        Sdf::from(Repeat {
            period: DVec3::splat(12.0),
            of: Box::new(moved([3.0, -2.0, 4.0], sphere(5.0))),
        }),
        Sdf::from(Displace {
            noise: 0,
            amplitude: 3.0,
            of: Box::new(sphere(9.0)),
        }),
        Sdf::from(Displace {
            noise: 1,
            amplitude: 2.0,
            of: Box::new(sphere(9.0)),
        }),
        Sdf::from(Warp {
            noise: 3,
            amplitude: 2.0,
            of: Box::new(capsule.clone()),
        }),
        scattered(sphere(3.0), 8.0, 0.3, (0.5, 1.5), 3.0),
        scattered(
            moved(
                [1.0, 1.0, 0.0],
                Sdf::from(Cylinder {
                    radius: 1.0,
                    half_height: 3.0,
                }),
            ),
            14.0,
            0.5,
            (1.0, 1.4),
            5.0,
        ),
        // Its own function crawls far from the copy: the cut-off must hold all the same.
        scattered(
            Sdf::from(Intersection(vec![
                sphere(2.5),
                Sdf::from(HeightField {
                    noise: 0,
                    base: 0.0,
                    amplitude: 9.0,
                    step: 0.0,
                }),
            ])),
            7.0,
            0.2,
            (0.8, 1.2),
            2.5,
        ),
        Sdf::from(Subtraction(vec![
            Sdf::from(Union(vec![
                rounded,
                Sdf::from(Plane {
                    normal: DVec3::Y,
                    offset: -4.0,
                }),
            ])),
            Sdf::from(Warp {
                noise: 2,
                amplitude: 1.5,
                of: Box::new(moved([2.0, 3.0, 0.0], capsule)),
            }),
            scattered(
                Sdf::from(Displace {
                    noise: 3,
                    amplitude: 0.5,
                    of: Box::new(sphere(2.0)),
                }),
                6.0,
                0.1,
                (1.0, 1.5),
                2.6,
            ),
        ])),
    ]
}
