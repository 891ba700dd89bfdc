//! What becomes of the maps over many updates: averages, reactions, and numbers that are none.

use glam::{DVec3, IVec2};
use grotto::{
    parameters::ProbeParameters,
    probes::{octahedral, sampling},
};

use crate::{Rig, texels, volume};

#[test]
fn nothing_that_is_not_a_number_is_ever_stored() {
    let mut rig = Rig::new(volume([1, 1, 1], 4.0), ProbeParameters::default());
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30, -1.0] {
        rig.update(|_, d| {
            let value = if d.x > 0.5 { bad } else { 1.0 };
            [value, value, 1.0, if d.y > 0.9 { bad.abs() } else { 2.0 }]
        });
        for place in texels(8) {
            let texel = rig.irradiance(0)(place);
            assert!(
                texel.iter().all(|v| v.is_finite() && *v >= 0.0),
                "{bad}: {texel:?}"
            );
        }
        for place in texels(16) {
            let texel = rig.distance(0)(place);
            assert!(
                texel.iter().all(|v| v.is_finite() && *v >= 0.0),
                "{bad}: {texel:?}"
            );
        }
    }
    for _ in 0..60 {
        rig.update(|_, _| [1.0, 1.0, 1.0, 2.0]);
    }
    assert!(
        (rig.irradiance(0)(IVec2::ZERO)[0] - 1.0).abs() < 0.01,
        "it must heal"
    );
}

/// Small steps survive: an f16 average at hysteresis 0.99 would stop far from its goal.
#[test]
fn a_slow_average_reaches_its_goal() {
    let parameters = ProbeParameters {
        rays: 16,
        hysteresis: 0.99,
        warmup_frames: 0,
        change_small: 1.0,
        ..Default::default()
    };
    let mut rig = Rig::new(volume([1, 1, 1], 4.0), parameters);
    for _ in 0..100 {
        rig.update(|_, _| [1.0, 1.0, 1.0, 4.0]);
    }
    for _ in 0..600 {
        rig.update(|_, _| [1.05, 1.05, 1.05, 4.2]);
    }
    let found = rig.irradiance(0)(IVec2::new(3, 3))[0];
    assert!((found - 1.05).abs() < 0.001, "{found}");
}

#[test]
fn a_switched_lamp_is_followed_within_three_frames_and_noise_is_not() {
    let parameters = ProbeParameters {
        rays: 64,
        warmup_frames: 1,
        ..Default::default()
    };
    let mut rig = Rig::new(volume([1, 1, 1], 4.0), parameters);
    for _ in 0..100 {
        rig.update(|_, d| [1.0 + 0.2 * (d.x * 40.0).sin() as f32; 4]);
    }
    let texel = |rig: &Rig| rig.irradiance(0)(IVec2::new(4, 4))[0];
    assert!((texel(&rig) - 1.0).abs() < 0.05, "{}", texel(&rig));
    rig.update(|_, _| [6.0; 4]);
    assert!(
        texel(&rig) < 1.5,
        "one frame alone may be noise: {}",
        texel(&rig)
    );
    rig.update(|_, _| [6.0; 4]);
    rig.update(|_, _| [6.0; 4]);
    assert!(
        (texel(&rig) - 6.0).abs() < 0.02,
        "must drop its history: {}",
        texel(&rig)
    );
}

/// Small bright things make heavy-tailed noise; reacting to change must not bias the average.
#[test]
fn noise_leaves_the_average_where_it_belongs() {
    let parameters = ProbeParameters {
        rays: 200,
        warmup_frames: 1,
        ..Default::default()
    };
    let mut rig = Rig::new(volume([4, 4, 1], 4.0), parameters);
    let (mut sum, mut count) = (0.0, 0.0);
    for frame in 0..240 {
        // Every probe has its speck elsewhere.
        rig.update(|slot, d| {
            let speck = sampling::fibonacci(slot, 16);
            [if d.dot(speck) > 0.99 { 200.0 } else { 1.0 }; 4]
        });
        if frame >= 60 && frame % 20 == 0 {
            for slot in 0..16 {
                let irradiance = rig.irradiance(slot);
                for place in texels(8) {
                    let normal = octahedral::texel_direction(place.as_uvec2(), 8);
                    // A cap of 0.01 · 2π steradians of radiance 199 more than the rest.
                    let cosine = normal.dot(sampling::fibonacci(slot, 16)).max(0.0);
                    sum += irradiance(place)[0] / (1.0 + 199.0 * 0.02 * cosine);
                    count += 1.0;
                }
            }
        }
    }
    let bias = sum / count;
    assert!((bias - 1.0).abs() < 0.05, "{bias}");
}

/// A bright speck keeps its energy unless the clamp is asked for.
#[test]
fn the_firefly_clamp_bites_only_when_it_is_on() {
    let speck = |_: u32, d: DVec3| [if d.z > 0.995 { 1000.0 } else { 1.0 }; 4];
    let mean_of = |firefly_clamp: f32| {
        let parameters = ProbeParameters {
            warmup_frames: 0,
            firefly_clamp,
            change_small: 1.0,
            ..Default::default()
        };
        let mut rig = Rig::new(volume([1, 1, 1], 4.0), parameters);
        for _ in 0..30 {
            rig.update(speck);
        }
        let irradiance = rig.irradiance(0);
        texels(8).map(|place| irradiance(place)[0]).sum::<f64>() / 64.0
    };
    let (free, clamped) = (mean_of(0.0), mean_of(10.0));
    // The cap z > 0.995 covers 0.25 % of the sphere; texels weigh the sphere nearly evenly.
    assert!((free / 3.5 - 1.0).abs() < 0.3, "{free}");
    assert!(clamped < 0.5 * free, "{clamped} {free}");
}
