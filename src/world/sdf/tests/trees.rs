//! The trees that the tests sample.

use glam::DVec3;

use crate::world::World;
use crate::world::file::{self, Overrides};
use crate::world::noise::NoiseField;
use crate::world::sdf::{Scatter, Sdf, Sphere, Translate};

const NOISES: &str = r#"{
    "floor": (basis: Perlin, fractal: Fbm(octaves: 4), frequency: 0.07, offset: (0.2, 0.4, 0.6), seed: 11),
    "ridges": (basis: OpenSimplex, fractal: Ridged(octaves: 3), frequency: 0.05, offset: (0.2, 0.4, 0.6), seed: 11),
    "cells": (basis: Worley, frequency: 0.1, offset: (0.2, 0.4, 0.6), seed: 11),
    "clouds": (basis: Value, fractal: Billow(octaves: 2), frequency: 0.09, offset: (0.2, 0.4, 0.6), seed: 11),
}"#;

const TURNED: &str = "Rotate(degrees: (30, 40, 50), of: RoundedBox(half: (5, 2, 3), radius: 1.5))";
const CAPSULE: &str = "Capsule(from: (-4, 0, 2), to: (6, 5, 0), radius: 2)";
const PAIR: &str = "[
    Translate(by: (-3, 0, 1), of: Sphere(radius: 6)),
    Translate(by: (4, 2, 0), of: Sphere(radius: 5)),
]";
/// Box in which the scatters put their copies.
const BOX: &str = "min: (-20, -20, -20), max: (20, 9, 25), probability: 0.6, seed: 5";

fn world(shape: &str) -> World {
    let text = format!(
        "(title: \"\", size: (64, 64, 64), origin: (-32, -32, -32), noises: {NOISES}, shape: {shape})"
    );
    file::parse(&text, "test", None, &Overrides::default())
        .unwrap_or_else(|report| panic!("{shape}: {report:?}"))
}

pub fn noises() -> Vec<NoiseField> {
    world("Empty").noises
}

pub fn sphere(radius: f64) -> Sdf {
    Sphere { radius }.into()
}

pub fn moved(by: [f64; 3], of: Sdf) -> Sdf {
    let (by, of) = (by.into(), Box::new(of));
    Translate { by, of }.into()
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

/// At least one tree for every shape, then combinations.
pub fn trees() -> Vec<Sdf> {
    let shapes = [
        "Sphere(radius: 7)".to_owned(),
        "Box(half: (3, 6, 2))".to_owned(),
        "RoundedBox(half: (5, 2, 3), radius: 1.5)".to_owned(),
        CAPSULE.to_owned(),
        "Cylinder(radius: 4, half_height: 7)".to_owned(),
        "Torus(major: 8, minor: 2.5)".to_owned(),
        "Plane(normal: (1, 2, -0.5), offset: 3)".to_owned(),
        "HeightField(noise: \"floor\", base: -2, amplitude: 6)".to_owned(),
        "HeightField(noise: \"floor\", base: -2, amplitude: 6, step: 1)".to_owned(),
        format!("Union({PAIR})"),
        format!("Intersection({PAIR})"),
        format!("Subtraction({PAIR})"),
        format!("SmoothUnion(k: 3, of: {PAIR})"),
        format!("SmoothIntersection(k: 3, of: {PAIR})"),
        format!("SmoothSubtraction(k: 3, of: {PAIR})"),
        TURNED.to_owned(),
        format!("Scale(by: 2.5, of: {CAPSULE})"),
        format!("Repeat(period: (18, 0, 15), of: {TURNED})"),
        "Repeat(period: (12, 12, 12), of: Translate(by: (3, -2, 4), of: Sphere(radius: 5)))".into(),
        "Displace(noise: \"floor\", amplitude: 3, of: Sphere(radius: 9))".to_owned(),
        "Displace(noise: \"ridges\", amplitude: 2, of: Sphere(radius: 9))".to_owned(),
        format!("Warp(noise: \"clouds\", amplitude: 2, of: {CAPSULE})"),
        format!(
            "Scatter({BOX}, cell: 8, jitter: 0.3, scale: (0.5, 1.5), reach: 3, of: Sphere(radius: 3))"
        ),
        format!(
            "Scatter({BOX}, cell: 14, jitter: 0.5, scale: (1, 1.4), reach: 5, of: Translate(
                by: (1, 1, 0), of: Cylinder(radius: 1, half_height: 3)))"
        ),
        // The sub-tree's own value grows slowly away from the copy: the cut-off must still hold.
        format!(
            "Scatter({BOX}, cell: 7, jitter: 0.2, scale: (0.8, 1.2), reach: 2.5, of: Intersection([
                Sphere(radius: 2.5), HeightField(noise: \"floor\", base: 0, amplitude: 9)]))"
        ),
        format!(
            "Subtraction([
                Union([
                    RoundedBox(half: (5, 2, 3), radius: 1.5),
                    Plane(normal: (0, 1, 0), offset: -4),
                ]),
                Warp(noise: \"cells\", amplitude: 1.5, of: Translate(by: (2, 3, 0), of: {CAPSULE})),
                Scatter({BOX}, cell: 6, jitter: 0.1, scale: (1, 1.5), reach: 2.6, of: Displace(
                    noise: \"clouds\", amplitude: 0.5, of: Sphere(radius: 2))),
            ])"
        ),
    ];
    shapes.iter().map(|shape| world(shape).shape).collect()
}
