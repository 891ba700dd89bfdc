//! Signs, Lipschitz bounds and boxes of every node, by sampling.

mod trees;

use glam::DVec3;
use proptest::prelude::*;

use super::{
    Cylinder, Displace, Empty, HeightField, Intersection, Plane, Repeat, Rotate, Scale, Sdf,
    SdfError, Shape, SmoothIntersection, SmoothSubtraction, SmoothUnion, Subtraction, Torus, Union,
};
use crate::world::noise::NoiseBank;
use trees::{moved, noises, scattered, sphere, trees};

/// Points within ±30, the same in every run, that do not lie on lattice planes.
pub fn points(count: usize) -> impl Iterator<Item = DVec3> {
    (0..count).map(|i| {
        let i = i as f64 + 0.5;
        DVec3::new(i * 8.191_725_134, i * 6.710_436_067, i * 5.497_004_779) % 60.0 - 30.0
    })
}

fn direction(i: usize) -> DVec3 {
    let (turn, height) = (
        i as f64 * 2.399_963,
        (i as f64 * 0.618_034) % 1.0 * 2.0 - 1.0,
    );
    let ring = (1.0 - height * height).sqrt();
    DVec3::new(ring * turn.cos(), height, ring * turn.sin())
}

#[test]
fn values_vary_no_faster_than_stated() {
    for tree in trees() {
        tree.check(&noises()).unwrap();
        let shape = Shape::new(&tree, &noises());
        let mut share: f64 = 0.0;
        for (i, p) in points(6_000).enumerate() {
            let radius = [1e-4, 0.05, 0.7, 2.6, 6.1][i % 5];
            let (a, b) = (shape.eval(p), shape.eval(p + radius * direction(i)));
            let bound = shape.variation(radius);
            assert!(
                (a - b).abs() <= bound + 1e-9,
                "{tree:?}\nat {p}, radius {radius}: {} > {bound}",
                (a - b).abs()
            );
            share = share.max((a - b).abs() / bound);
        }
        // A bound that is never approached culls nothing.
        assert!(share > 0.25, "{tree:?}: {share}");
        assert!(
            shape.lipschitz() >= 0.99 && shape.lipschitz() < 12.0,
            "{tree:?}: {}",
            shape.lipschitz()
        );
    }
}

#[test]
fn all_solid_points_lie_within_the_bounds() {
    for tree in trees() {
        let shape = Shape::new(&tree, &noises());
        let bounds = shape.bounds();
        let mut solid = 0;
        for p in points(20_000) {
            if shape.eval(p) < 0.0 {
                solid += 1;
                assert!(
                    p.cmpge(bounds.min).all() && p.cmple(bounds.max).all(),
                    "{tree:?} at {p}: {bounds:?}"
                );
            }
        }
        assert!(solid > 0, "{tree:?} has no solid point");
    }
}

#[test]
fn signs_follow_from_the_definitions() {
    let capsule = |p: DVec3| {
        let (from, to) = (DVec3::new(-4.0, 0.0, 2.0), DVec3::new(6.0, 5.0, 0.0));
        (0..=2000).any(|i| p.distance(from.lerp(to, f64::from(i) / 2000.0)) < 2.0)
    };
    let torus = |p: DVec3| {
        (0..3000).any(|i| {
            let turn = f64::from(i) / 3000.0 * std::f64::consts::TAU;
            p.distance(8.0 * DVec3::new(turn.cos(), 0.0, turn.sin())) < 2.5
        })
    };
    let cylinder = |p: DVec3| p.y.abs() < 7.0 && p.x * p.x + p.z * p.z < 16.0;
    let cases: [(Sdf, &dyn Fn(DVec3) -> bool); 3] = [
        (trees().swap_remove(3), &capsule),
        (
            Sdf::from(Torus {
                major: 8.0,
                minor: 2.5,
            }),
            &torus,
        ),
        (
            Sdf::from(Cylinder {
                radius: 4.0,
                half_height: 7.0,
            }),
            &cylinder,
        ),
    ];
    for (tree, inside) in cases {
        let shape = Shape::new(&tree, &[]);
        for p in points(3_000).map(|p| p / 2.5) {
            let value = shape.eval(p);
            assert!(
                value.abs() < 2e-3 || (value < 0.0) == inside(p),
                "{tree:?} at {p}: {value}"
            );
        }
    }
}

#[test]
fn rotation_turns_x_then_y_then_z() {
    // A marker on +y: 90° about x brings it to +z, then 90° about y to +x, then 90° about z to +y.
    let marker = moved([0.0, 5.0, 0.0], sphere(1.0));
    let at = |degrees: [f64; 3], p: [f64; 3]| {
        let tree = Sdf::from(Rotate {
            degrees: degrees.into(),
            of: Box::new(marker.clone()),
        });
        Shape::new(&tree, &[]).eval(p.into())
    };
    assert!(at([90.0, 0.0, 0.0], [0.0, 0.0, 5.0]) < -0.99);
    assert!(at([90.0, 90.0, 0.0], [5.0, 0.0, 0.0]) < -0.99);
    assert!(at([90.0, 90.0, 90.0], [0.0, 5.0, 0.0]) < -0.99);
}

#[test]
fn a_stepped_height_field_is_flat_between_its_steps() {
    let tree = Sdf::from(HeightField {
        noise: 0,
        base: -21.0,
        amplitude: 5.0,
        step: 1.0,
    });
    let shape = Shape::new(&tree, &noises());
    for p in points(500) {
        let top = (0..20)
            .map(|i| -28.5 + f64::from(i))
            .filter(|&y| shape.eval(p.with_y(y)) < 0.0)
            .count();
        let rise = 5.0 * shape.bank().value(0, p.with_y(0.0));
        assert_eq!(-29.0 + top as f64, -21.0 + rise.floor());
    }
}

/// A lattice noise is 0 at its own points, however a device rounds.
#[test]
fn a_rise_of_almost_whole_steps_is_one_of_whole_steps() {
    let top = |amplitude: f64, p: DVec3| {
        let tree = Sdf::from(HeightField {
            noise: 0,
            base: -21.0,
            amplitude,
            step: 1.0,
        });
        let shape = Shape::new(&tree, &noises());
        let ground = |i: &i32| shape.eval(p.with_y(-30.5 + f64::from(*i))) < 0.0;
        (0..20).take_while(ground).count()
    };
    let mut tried = 0;
    for p in points(200) {
        let value = NoiseBank::new(&noises()).value(0, p.with_y(0.0));
        if value.abs() < 1e-3 {
            continue;
        }
        // A rise of two steps, and of rounding more or less.
        let [less, more] = [-1e-7, 1e-7].map(|error| top((2.0 + error) / value, p));
        assert_eq!(less, more, "{p}");
        tried += 1;
    }
    assert!(tried > 100, "{tried}");
}

#[test]
fn repeat_equals_a_union_of_its_copies() {
    let tile = moved([3.0, -2.0, 4.0], sphere(5.0));
    let shape = Shape::new(
        &Sdf::from(Repeat {
            period: DVec3::new(12.0, 0.0, 14.0),
            of: Box::new(tile),
        }),
        &[],
    );
    for p in points(3_000) {
        let mut nearest = f64::INFINITY;
        for x in -4..=4 {
            for z in -4..=4 {
                let centre = DVec3::new(3.0 + 12.0 * f64::from(x), -2.0, 4.0 + 14.0 * f64::from(z));
                nearest = nearest.min(p.distance(centre) - 5.0);
            }
        }
        let value = shape.eval(p);
        // The two copies nearest along each axis are 12 − 8 away at least.
        assert!(
            (value - nearest.min(4.0)).abs() < 1e-9,
            "at {p}: {value}, {nearest}"
        );
    }
}

#[test]
fn empty_stays_empty_in_every_operator() {
    let empty = || vec![Sdf::from(Empty), Sdf::from(Empty)];
    for tree in [
        Sdf::from(Empty),
        Sdf::from(Union(vec![])),
        Sdf::from(Union(empty())),
        Sdf::from(SmoothUnion {
            k: 2.0,
            of: empty(),
        }),
        Sdf::from(SmoothIntersection {
            k: 2.0,
            of: empty(),
        }),
        Sdf::from(Repeat {
            period: DVec3::splat(5.0),
            of: Box::new(Sdf::from(Empty)),
        }),
        Sdf::from(Displace {
            noise: 0,
            amplitude: 1.0,
            of: Box::new(Sdf::from(Empty)),
        }),
    ] {
        tree.check(&noises()).unwrap();
        let value = Shape::new(&tree, &noises()).eval(DVec3::ONE);
        assert_eq!(value, f64::INFINITY, "{tree:?}");
    }
    let untouched = Sdf::from(SmoothSubtraction {
        k: 2.0,
        of: vec![sphere(3.0), Sdf::from(Empty)],
    });
    assert_eq!(Shape::new(&untouched, &[]).eval(DVec3::X), -2.0);
}

#[test]
fn check_names_what_is_wrong() {
    let wrong = [
        (
            sphere(-1.0),
            "Sphere: radius must be finite and above 0, not -1",
        ),
        (sphere(f64::NAN), "not NaN"),
        (
            Sdf::from(HeightField {
                noise: 9,
                base: 0.0,
                amplitude: 1.0,
                step: 0.0,
            }),
            "noise field 9",
        ),
        (
            scattered(sphere(3.0), 8.0, 0.8, (0.5, 1.5), 3.0),
            "more than the cell of 8",
        ),
        (
            Sdf::from(Repeat {
                period: DVec3::X * 4.0,
                of: Box::new(sphere(5.0)),
            }),
            "along x",
        ),
        (
            Sdf::from(Repeat {
                period: DVec3::Y * 4.0,
                of: Box::new(Sdf::from(Plane {
                    normal: DVec3::Y,
                    offset: 0.0,
                })),
            }),
            "along y",
        ),
        (
            Sdf::from(Union(vec![moved([0.0, f64::INFINITY, 0.0], sphere(1.0))])),
            "Translate: by",
        ),
        (
            (0..200).fold(sphere(1.0), |of, _| {
                Sdf::from(Scale {
                    by: 1.0,
                    of: Box::new(of),
                })
            }),
            "deeper than",
        ),
    ];
    for (tree, message) in wrong {
        let error = tree.check(&noises()).unwrap_err();
        assert!(error.to_string().contains(message), "{error}");
    }
    assert!(matches!(
        sphere(0.0).check(&[]),
        Err(SdfError::Rule { node: "Sphere", .. })
    ));
}

proptest! {
    #[test]
    fn smooth_operators_stay_near_the_sharp_ones(
        x in -12.0..12.0f64, y in -12.0..12.0f64, z in -12.0..12.0f64, k in 0.0..5.0f64,
    ) {
        let pair = || vec![moved([-3.0, 0.0, 1.0], sphere(6.0)), moved([4.0, 2.0, 0.0], sphere(5.0))];
        let p = DVec3::new(x, y, z);
        let at = |tree: Sdf| Shape::new(&tree, &[]).eval(p);
        let limit = k / 4.0 + 1e-9;
        let union = at(Sdf::from(Union(pair()))) - at(Sdf::from(SmoothUnion { k, of: pair() }));
        let intersection = at(Sdf::from(SmoothIntersection { k, of: pair() })) - at(Sdf::from(Intersection(pair())));
        let subtraction = at(Sdf::from(SmoothSubtraction { k, of: pair() })) - at(Sdf::from(Subtraction(pair())));
        for difference in [union, intersection, subtraction] {
            prop_assert!((-1e-9..=limit).contains(&difference));
        }
    }
}
