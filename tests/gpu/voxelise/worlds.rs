//! The worlds that these tests voxelise.

use glam::{DVec3, IVec3, UVec3, Vec3};
use grotto::world::materials::Condition;
use grotto::world::noise::{Basis, Fractal, NoiseField};
use grotto::world::sdf::{
    Capsule, Cuboid, Cylinder, Displace, Empty, HeightField, Intersection, Plane, Repeat, Rotate,
    RoundedBox, Scale, Scatter, Sdf, SmoothIntersection, SmoothSubtraction, SmoothUnion, Sphere,
    Subtraction, Torus, Translate, Union, Warp,
};
use grotto::world::{FeaturePart, ResponseSpec, Rule, Sky, World};

pub fn noises() -> Vec<NoiseField> {
    let field = |basis, fractal, frequency: f64| NoiseField {
        name: String::new(),
        basis,
        fractal,
        frequency: DVec3::splat(frequency),
        offset: DVec3::new(0.2, 0.4, 0.6),
        seed: 11,
    };
    let (lacunarity, persistence) = (2.0, 0.5);
    vec![
        field(
            Basis::Perlin,
            Fractal::Fbm {
                octaves: 4,
                lacunarity,
                persistence,
            },
            0.07,
        ),
        field(
            Basis::OpenSimplex,
            Fractal::Ridged {
                octaves: 3,
                lacunarity,
                persistence,
            },
            0.05,
        ),
        field(Basis::Worley, Fractal::None, 0.1),
        field(
            Basis::Value,
            Fractal::Billow {
                octaves: 2,
                lacunarity,
                persistence,
            },
            0.09,
        ),
        field(Basis::OpenSimplex, Fractal::None, 0.2),
        field(Basis::Value, Fractal::None, 0.3),
    ]
}

pub fn world(size: UVec3, shape: Sdf, rules: Vec<Rule>, features: Vec<FeaturePart>) -> World {
    let noises = noises();
    shape.check(&noises).expect("a sound tree");
    World {
        name: "test".into(),
        title: "A world for one test.".into(),
        size,
        origin: IVec3::new(-20, -12, -24),
        voxel_m: 1.0,
        seed: 1,
        shape,
        noises,
        materials: Vec::new(),
        rules,
        features,
        player_height: 1.77,
        sky: Sky {
            zenith: Vec3::ONE,
            horizon: Vec3::ONE,
            ground: Vec3::ZERO,
        },
        sun: None,
        lamp_presets: Vec::new(),
        response: ResponseSpec::default(),
        bodies: Default::default(),
        restored: Default::default(),
        cameras: Vec::new(),
        layouts: Vec::new(),
    }
}

pub fn moved(by: [f64; 3], of: Sdf) -> Sdf {
    Sdf::from(Translate {
        by: by.into(),
        of: Box::new(of),
    })
}

pub fn sphere(radius: f64) -> Sdf {
    Sdf::from(Sphere { radius })
}

/// Rock with caves, pillars and a stepped floor: every node kind once.
pub fn everything() -> Sdf {
    let scattered = Sdf::from(Scatter {
        min: DVec3::new(-20.0, -12.0, -24.0),
        max: DVec3::new(20.0, 14.0, 24.0),
        cell: 9.0,
        probability: 0.5,
        jitter: 0.3,
        scale: (0.6, 1.4),
        reach: 4.2,
        seed: 77,
        of: Box::new(Sdf::from(SmoothUnion {
            k: 1.0,
            of: vec![
                sphere(2.0),
                Sdf::from(Capsule {
                    from: DVec3::ZERO,
                    to: DVec3::new(0.0, 3.0, 1.0),
                    radius: 1.0,
                }),
            ],
        })),
    });
    let tiles = Sdf::from(Repeat {
        period: DVec3::new(13.0, 0.0, 11.0),
        of: Box::new(Sdf::from(Rotate {
            degrees: DVec3::new(20.0, 30.0, 40.0),
            of: Box::new(Sdf::from(RoundedBox {
                half: DVec3::new(1.5, 3.0, 1.0),
                radius: 0.5,
            })),
        })),
    });
    let rock = Sdf::from(Subtraction(vec![
        Sdf::from(Plane {
            normal: DVec3::new(0.1, 1.0, 0.0),
            offset: 6.0,
        }),
        Sdf::from(Displace {
            noise: 0,
            amplitude: 4.0,
            of: Box::new(sphere(11.0)),
        }),
        moved(
            [-9.0, 2.0, 8.0],
            Sdf::from(Warp {
                noise: 2,
                amplitude: 2.0,
                of: Box::new(Sdf::from(Torus {
                    major: 8.0,
                    minor: 3.0,
                })),
            }),
        ),
        moved(
            [10.0, 4.0, -12.0],
            Sdf::from(Displace {
                noise: 4,
                amplitude: 2.0,
                of: Box::new(Sdf::from(Cylinder {
                    radius: 5.0,
                    half_height: 6.0,
                })),
            }),
        ),
    ]));
    Sdf::from(Union(vec![
        Sdf::from(SmoothSubtraction {
            k: 2.0,
            of: vec![
                rock,
                moved(
                    [0.0, 8.0, 0.0],
                    Sdf::from(Scale {
                        by: 2.0,
                        of: Box::new(Sdf::from(Cuboid {
                            half: DVec3::new(3.0, 2.0, 4.0),
                        })),
                    }),
                ),
            ],
        }),
        Sdf::from(HeightField {
            noise: 1,
            base: -6.0,
            amplitude: 3.0,
            step: 0.0,
        }),
        Sdf::from(Intersection(vec![
            Sdf::from(HeightField {
                noise: 3,
                base: -4.0,
                amplitude: 3.0,
                step: 1.0,
            }),
            Sdf::from(Cuboid {
                half: DVec3::new(9.0, 30.0, 9.0),
            }),
        ])),
        Sdf::from(SmoothIntersection {
            k: 1.5,
            of: vec![scattered, moved([0.0, 3.0, 0.0], sphere(22.0))],
        }),
        moved([0.0, 12.0, 0.0], tiles),
        Sdf::from(Empty),
    ]))
}

pub fn rules() -> Vec<Rule> {
    let rule = |material, when| Rule { material, when };
    vec![
        rule(
            1,
            Condition::All(vec![
                Condition::FacesUp,
                Condition::NoiseBelow {
                    noise: 5,
                    value: 0.1,
                },
            ]),
        ),
        rule(
            2,
            Condition::Any(vec![
                Condition::FacesDown,
                Condition::InBox {
                    min: Vec3::splat(-6.0),
                    max: Vec3::splat(-1.0),
                },
            ]),
        ),
        rule(
            3,
            Condition::All(vec![
                Condition::Below(-3.0),
                Condition::Not(Box::new(Condition::Above(-8.0))),
            ]),
        ),
        rule(4, Condition::Inside(moved([4.0, 0.0, 4.0], sphere(9.0)))),
        rule(5, Condition::ShallowerThan(2.5)),
        rule(6, Condition::Always),
    ]
}

pub fn features() -> Vec<FeaturePart> {
    let part = |min: [i32; 3], max: [i32; 3], material, without_corners| FeaturePart {
        min: min.into(),
        max: max.into(),
        material,
        without_corners,
    };
    vec![
        part([-2, -9, -2], [-2, 3, -2], 7, false),
        part([-5, 3, -5], [2, 4, 2], 8, true),
        part([-4, 3, -4], [-1, 3, -1], 9, false),
        part([-40, -3, 0], [-18, -2, 5], 9, false),
        part([14, 0, 14], [60, 2, 60], 7, true),
    ]
}
