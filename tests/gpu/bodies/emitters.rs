//! Emissive faces of bodies, from which rays choose points.

use std::sync::atomic::AtomicBool;

use glam::{Quat, UVec3, Vec3};
use grotto::{
    gpu::Gpu,
    lights::Lights,
    parameters::ProbeParameters,
    reference::{self, FilmOptions, RenderOptions},
    world::{Lamp, LampPreset, Travel, View, World, bodies::BodyMotion, generate},
};

use super::{blocks, body, model, room};
use crate::support::{
    self, Fault,
    frames::{Drawn, apart, mean},
    scenes::flat,
};

const SIZE: [u32; 2] = [48, 36];

/// A dark room with a body that glows, of which most faces lie along no axis of the world.
fn lantern() -> World {
    let mut world = room();
    world.materials = vec![flat(0.6, 0.0), flat(0.4, 20.0)];
    world.lamp_presets = vec![LampPreset {
        name: "none".into(),
        lamps: Vec::new(),
    }];
    let size = UVec3::new(2, 1, 3);
    world.bodies.models.push(model(size, |_| 2));
    let turned = Quat::from_rotation_y(0.4) * Quat::from_rotation_x(0.3);
    let at = Vec3::new(-2.0, -3.0, 1.0);
    (world.bodies.bodies).push(body(0, size.as_vec3() / 2.0, at, turned));
    world
}

fn drawn(gpu: Gpu, world: World) -> Drawn {
    let layout = world.layouts[0].clone();
    Drawn::new(gpu, world, &layout, ProbeParameters::default(), SIZE)
}

/// The GPU's path tracer chooses points of the body, the CPU's finds it by chance.
#[test]
fn light_of_chosen_points_and_of_faces_found_by_chance_adds_up_to_all() {
    let world = lantern();
    let film = FilmOptions {
        camera: &world.cameras[0],
        size: SIZE,
        samples: 400,
        seed: 3,
        view: View::Full,
        antialias: false,
        max_bounces: u32::MAX,
    };
    let options = RenderOptions {
        lamps: &world.lamp_presets[0],
        time_s: 0.0,
        lamp_time_s: 0.0,
        textures: true,
        film,
    };
    let voxels = generate::generate(&world);
    let stop = AtomicBool::new(false);
    let by_chance = reference::render(&world, &voxels, &options, &|_, _| {}, &stop);
    let traced = |gpu: Gpu| drawn(gpu, world.clone()).path_traced(View::Full, 400);
    let chosen = traced(support::gpu());
    let ratio = mean(&chosen) / mean(&by_chance);
    let differs = apart(&blocks(&chosen), &blocks(&by_chance));
    println!("{ratio:.4} of the light, blocks differ by {differs:.4}");
    assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
    assert!(differs < 0.1, "{differs}");
    let twice: Fault = (
        "path_trace/trace.wesl",
        "let share = emitter_share(emitter_density(emitted, facing_of(vertex)), cosines, hit.t * hit.t);",
        "let share = 1.0;",
    );
    let wrong = traced(support::with_faults(&support::gpu(), &[twice]));
    assert!(mean(&wrong) > 1.1 * mean(&by_chance), "{}", mean(&wrong));
}

/// Drawn until 40 frames after the body has set out.
fn in_motion(gpu: Gpu) -> Drawn {
    let mut world = lantern();
    world.bodies.bodies[0].motion = vec![BodyMotion::Travel(Travel::Path {
        points: vec![Vec3::new(-2.0, -3.0, 1.0), Vec3::new(4.0, -3.0, -3.0)],
        speed: 6.0,
    })];
    let mut drawn = drawn(gpu, world);
    drawn.draw(64);
    for _ in 0..40 {
        drawn.shot.time_s += 1.0 / 60.0;
        drawn.draw(1);
    }
    drawn
}

#[test]
fn light_follows_a_body_that_glows_without_grain() {
    let by_chance: Fault = (
        "light/body_emitters.wesl",
        "return glowing_body(count - 1u).weight_until;",
        "return 0.0;",
    );
    let sound = in_motion(support::gpu());
    let faulty = in_motion(support::with_faults(&support::gpu(), &[by_chance]));
    let truth = sound.path_traced(View::Full, 400);
    let [error, grain] = [sound, faulty].map(|drawn| apart(&drawn.radiance(), &truth));
    println!("{error:.4}, {grain:.4} where rays find the body by chance");
    assert!(error < 0.12, "{error}");
    assert!(grain > 1.5 * error, "{grain}");
}

/// Bodies go on shining with their own power when the only lamp, deep in the stone, changes its power.
#[test]
fn the_gain_of_a_lone_lamp_is_not_that_of_bodies() {
    let mut world = lantern();
    world.lamp_presets[0].lamps = vec![Lamp {
        position: Vec3::new(10.0, 0.0, 0.0),
        power: 100.0,
        ..room().lamp_presets[0].lamps[0].clone()
    }];
    let mut drawn = drawn(support::gpu(), world);
    drawn.draw(48);
    let before = mean(&drawn.radiance());
    drawn.world.lamp_presets[0].lamps[0].power = 300.0;
    drawn.lights = Lights::at(&drawn.world, &drawn.world.lamp_presets[0], 0.0);
    drawn.draw(1);
    let after = mean(&drawn.radiance());
    assert!((after / before - 1.0).abs() < 0.05, "{before}, {after}");
}
