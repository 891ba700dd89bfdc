//! The maps over many updates: averages, reactions to change, and NaN.

use std::cell::Cell;

use glam::{DVec3, IVec2, IVec3};
use grotto::{
    parameters::ProbeParameters,
    passes::{probes::schedule::ProbeSchedule, scene::BODIES},
    probes::{Layout as _, octahedral, sampling},
};

use super::{Blends, Rig, texels, volume};

#[test]
fn nan_and_infinity_are_never_stored() {
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
        change_deviations: 1000.0,
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

/// Radiance that depends on the direction, and so on the rotation of an update's rays.
fn noisy(mean: f64, direction: DVec3) -> [f32; 4] {
    [(mean * (1.0 + 0.2 * (direction.x * 40.0).sin())) as f32; 4]
}

fn settled(parameters: &ProbeParameters) -> Rig {
    let mut rig = Rig::new(volume([2, 1, 1], 4.0), parameters.clone());
    for _ in 0..100 {
        rig.update(|_, d| noisy(1.0, d));
    }
    rig
}

fn centre(rig: &Rig, slot: u32) -> f64 {
    rig.irradiance(slot)(IVec2::new(4, 4))[0]
}

#[test]
fn light_that_is_known_to_change_is_followed_at_once_and_only_where_it_arrives() {
    let parameters = ProbeParameters {
        rays: 64,
        warmup_frames: 1,
        ..Default::default()
    };
    // Nobody tells this one, and it never believes that light has changed.
    let plain = ProbeParameters {
        change_deviations: 1000.0,
        ..parameters.clone()
    };
    let (mut rig, mut plain) = (settled(&parameters), settled(&plain));
    assert!((centre(&rig, 0) - 1.0).abs() < 0.05, "{}", centre(&rig, 0));
    let before = rig.irradiance(1);
    rig.field.changes.begin_frame(1.0, rig.frame as u32);
    for rig in [&mut rig, &mut plain] {
        rig.update(|slot, d| noisy([6.0, 1.0][slot as usize], d));
    }
    assert!((centre(&rig, 0) - 6.0).abs() < 0.5, "{}", centre(&rig, 0));
    assert!(centre(&plain, 0) < 1.5, "a plain average is slow");
    for place in texels(8) {
        let [then, now] = [before(place), rig.irradiance(1)(place)].map(|rgb| rgb[0]);
        assert!(
            (now / then - 1.0).abs() < 1e-3,
            "the other probe keeps its history: {then} {now}"
        );
    }
}

/// After long stillness the average takes in more updates, until the light changes.
#[test]
fn still_light_is_averaged_further_and_the_first_change_ends_that() {
    let parameters = ProbeParameters {
        rays: 16,
        warmup_frames: 1,
        ..Default::default()
    };
    let boil = |rig: &mut Rig, is_known: bool| {
        let (mut last, mut squares) = (0.0, 0.0);
        for frame in 0..360 {
            if is_known {
                rig.field.changes.begin_frame(0.0, rig.frame as u32);
            }
            rig.update(|_, d| noisy(1.0, d));
            let now = centre(rig, 0);
            if frame > 320 {
                squares += (now - last).powi(2);
            }
            last = now;
        }
        squares
    };
    let mut rig = Rig::new(volume([2, 1, 1], 4.0), parameters.clone());
    let mut unaware = Rig::new(volume([2, 1, 1], 4.0), parameters);
    let share = boil(&mut rig, true) / boil(&mut unaware, false);
    // A mean of 330 updates changes ten times less than one of 33.
    assert!((0.001..0.1).contains(&share), "{share}");
    for _ in 0..3 {
        rig.field.changes.begin_frame(1.0, rig.frame as u32);
        rig.update(|_, d| noisy(6.0, d));
    }
    assert!((centre(&rig, 0) - 6.0).abs() < 0.5, "{}", centre(&rig, 0));
}

#[test]
fn unannounced_light_is_followed_when_it_stays() {
    let parameters = ProbeParameters {
        rays: 64,
        warmup_frames: 1,
        ..Default::default()
    };
    let mut rig = settled(&parameters);
    rig.update(|_, d| noisy(6.0, d));
    let once = centre(&rig, 0);
    assert!(once < 1.5, "one frame alone may be noise: {once}");
    for _ in 0..7 {
        rig.update(|_, d| noisy(6.0, d));
    }
    let later = centre(&rig, 0);
    assert!((later - 6.0).abs() < 0.5, "must drop its history: {later}");
}

/// A speck of light that few rays hit, in another place for each probe, and soft light around it.
pub fn specks(slot: u32, direction: DVec3) -> [f32; 4] {
    let speck = sampling::fibonacci(slot, 16);
    [if direction.dot(speck) > 0.97 {
        60.0
    } else {
        1.0
    }; 4]
}

/// In a still scene change-aware history equals plain history: as still, and with the same mean, however
/// noisy the rays are.
#[test]
fn a_still_scene_is_as_still_and_as_bright_as_without_any_reaction() {
    for rays in [8, 16, 128] {
        let aware = ProbeParameters {
            rays,
            warmup_frames: 1,
            ..Default::default()
        };
        let plain = ProbeParameters {
            change_deviations: 1000.0,
            ..aware.clone()
        };
        let [(mean, variability), (plain_mean, plain_variability)] =
            [aware, plain].map(|parameters| {
                let mut rig = Rig::new(volume([4, 4, 1], 4.0), parameters);
                let (mut sum, mut squares, mut last) = (0.0, 0.0, Vec::<f64>::new());
                for frame in 0..180 {
                    rig.update(specks);
                    if frame < 60 {
                        continue;
                    }
                    let texels = rig.field.irradiance(&rig.gpu).expect("reads back");
                    let all: Vec<f64> = texels.iter().map(|[r, ..]| f64::from(*r)).collect();
                    sum += all.iter().sum::<f64>();
                    let steps = all.iter().zip(&last).map(|(a, b)| (a - b).powi(2));
                    squares += steps.sum::<f64>();
                    last = all;
                }
                (sum, squares)
            });
        let (bias, boil) = (mean / plain_mean, variability / plain_variability);
        assert!((bias - 1.0).abs() < 0.01, "{rays} rays: mean × {bias}");
        assert!((boil - 1.0).abs() < 0.05, "{rays} rays: variance × {boil}");
    }
}

/// After an edit the distances towards it start again, and those elsewhere stay as they are.
#[test]
fn distances_follow_an_edit_where_it_is() {
    let parameters = ProbeParameters {
        rays: 256,
        warmup_frames: 1,
        ..Default::default()
    };
    let mut rig = Rig::new(volume([1, 1, 1], 8.0), parameters);
    let longest = 1.5 * 8.0 * 3f64.sqrt();
    for _ in 0..60 {
        rig.update(|_, _| [1.0, 1.0, 1.0, 3.0]);
    }
    // They are known well enough: without an edit they are not measured any more.
    rig.update(|_, _| [1.0, 1.0, 1.0, 6.0]);
    let settled = rig.distance(0);
    for place in texels(16) {
        let found = settled(place)[0] * longest;
        assert!((found - 3.0).abs() < 0.001, "{place}: {found}");
    }
    drop(settled);
    let toward = |place: IVec2| octahedral::texel_direction(place.as_uvec2(), 16).x;
    let place = rig.field.volume().position(0).as_ivec3();
    let wall = place + IVec3::X * 3;
    let frame = rig.frame as u32;
    rig.field
        .changes
        .edit(wall - IVec3::ONE, wall + IVec3::ONE, IVec3::ZERO, frame);
    rig.field.changes.begin_frame(0.0, frame);
    let opened = |_: u32, d: DVec3| [1.0, 1.0, 1.0, if d.x > 0.7 { 12.0 } else { 3.0 }];
    // Rays that are repeated measure no distances.
    for frame in frame + 1..frame + 11 {
        rig.update(opened);
        rig.field.changes.begin_frame(0.0, frame);
    }
    let distance = rig.distance(0);
    for place in texels(16) {
        let found = distance(place)[0] * longest;
        if toward(place) > 0.95 {
            assert!((found - 12.0).abs() < 0.2, "{place}: {found}");
        }
        if toward(place) < 0.0 {
            assert!((found - 3.0).abs() < 0.02, "{place}: {found}");
        }
    }
    drop(distance);
    // Another change of distances, without an edit, is averaged in slowly.
    rig.update(|_, _| [1.0, 1.0, 1.0, 6.0]);
    let slow = rig.distance(0)(IVec2::new(0, 8))[0] * longest;
    assert!(slow < 3.3, "{slow}");
}

/// Bodies change distances without an edit: they are measured anew when a body has jumped, and only then.
#[test]
fn distances_follow_bodies() {
    let parameters = ProbeParameters {
        rays: 256,
        warmup_frames: 1,
        ..Default::default()
    };
    let mut rig = Rig::new(volume([1, 1, 1], 8.0), parameters);
    let with_bodies = [(BODIES, 1.0)];
    rig.schedule = ProbeSchedule::new(&rig.gpu, &rig.field, &with_bodies).expect("compiles");
    rig.blend = Blends::new(&rig.gpu, &rig.field, &with_bodies);
    let longest = 1.5 * 8.0 * 3f64.sqrt();
    for (length, jumps, expected) in [(3.0, true, 3.0), (9.0, false, 3.0), (6.0, true, 6.0)] {
        if jumps {
            rig.field.changes.bodies_jump(rig.frame as u32);
        }
        for _ in 0..100 {
            rig.update(|_, _| [1.0, 1.0, 1.0, length]);
        }
        let distance = rig.distance(0);
        for place in texels(16) {
            let found = distance(place)[0] * longest;
            assert!((found - expected).abs() < 0.01, "{place}: {found}");
        }
    }
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
        // Every probe has its speck in another place.
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

/// A bright speck keeps its energy unless the clamp is on.
#[test]
fn the_firefly_clamp_bites_only_when_it_is_on() {
    let speck = |_: u32, d: DVec3| [if d.z > 0.995 { 1000.0 } else { 1.0 }; 4];
    let mean_of = |firefly_clamp: f32| {
        let parameters = ProbeParameters {
            warmup_frames: 0,
            firefly_clamp,
            change_deviations: 1000.0,
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
    // The cap z > 0.995 covers 0.25 % of the sphere; texels weight the sphere nearly evenly.
    assert!((free / 3.5 - 1.0).abs() < 0.3, "{free}");
    // Measured: 0.41.
    assert!(clamped < 0.6 * free, "{clamped} {free}");
}

/// Of a probe's rays only the share that is traced counts: the rest of the buffer holds old ones. The light stays when
/// the share changes.
#[test]
fn a_share_of_the_rays_lights_a_probe_and_a_change_of_it_forgets_nothing() {
    let parameters = ProbeParameters {
        rays: 64,
        ray_share: 0.25,
        warmup_frames: 1,
        ..Default::default()
    };
    let mut rig = Rig::new(volume([2, 1, 1], 4.0), parameters);
    let nth = Cell::new(0);
    for _ in 0..20 {
        rig.update(|_, _| {
            let ray = nth.replace(nth.get() + 1) % 64;
            if ray < 16 { [1.0; 4] } else { [50.0; 4] }
        });
    }
    assert!((centre(&rig, 1) - 1.0).abs() < 0.01, "{}", centre(&rig, 1));
    let before = rig.field.updates(&rig.gpu).expect("reads back");
    rig.parameters.ray_share = 1.0;
    rig.update(|_, _| [1.0; 4]);
    assert!((centre(&rig, 1) - 1.0).abs() < 0.01, "{}", centre(&rig, 1));
    let after = rig.field.updates(&rig.gpu).expect("reads back");
    assert_eq!(after[1], before[1] + 1);
}
