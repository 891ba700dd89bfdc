//! What the rays of bodies bring: light of the faces that they hit, sampled emissive faces, nothing of other bodies' insides.

use std::fmt::Write;

use grotto::{
    parameters::ProbeParameters,
    world::{View, World},
};

use super::blocks;
use crate::support::{
    self, Fault,
    frames::{Drawn, apart, mean},
};

/// A room of 12 × 8 × 12 with `bodies`; the camera looks along −Z from one end.
fn room(emission: u32, power: u32, spacing: u32, bodies: &str) -> World {
    support::parsed(&format!(
        "(
    title: \"Bodies in a room.\",
    size: (32, 24, 32),
    origin: (-16, -8, -16),
    shape: Subtraction([
        Translate(by: (0, 4, 0), of: Box(half: (12, 10, 12))),
        Translate(by: (0, 4, 0), of: Box(half: (6, 4, 6))),
    ]),
    materials: {{
        \"white\": (a: Flat(0.6, 0.6, 0.6)),
        \"emitter\": (a: Flat(0.6, 0.6, 0.6), emission: ({emission}, {emission}, {emission})),
    }},
    rules: [
        (material: \"emitter\", when: InBox(min: (0, 8, 3), max: (1, 9, 4))),
        (material: \"white\"),
    ],
    sky: (zenith: (0, 0, 0)),
    lamps: [(name: \"one\", lamps: [(position: (3.5, 7, 5.5), power: {power})])],
    bodies: [{bodies}],
    cameras: [
        (name: \"at one end\", position: (0.1, 4, 5.9), fov_deg: 60),
        (name: \"beside the second body\", position: (1.95, 4, 2), fov_deg: 30),
    ],
    layouts: [(name: \"lattice\", counts: (5, 5, 5), spacing: {spacing}, centre: (-0.5, 3.5, -0.5))],
)"
    ))
}

const SLAB: &str = "(model: Shape(size: (10, 8, 2), shape: Box(half: (5, 4, 1)), material: \"white\"), position: (0, 4, 0))";
/// A second one that stands in the first: its side covers a little more than half of a voxel.
const ACROSS: &str = "(model: Shape(size: (2, 8, 4), shape: Box(half: (1, 4, 2)), material: \"white\"), position: (0.6, 4, 0.6))";

/// The indirect light of what the camera sees, over that of the path tracer, and how far its blocks of pixels differ.
fn against_truth(world: &World, camera: usize, faults: &[Fault]) -> [f64; 2] {
    let layout = world.layouts[0].clone();
    let gpu = support::with_faults(&support::gpu(), faults);
    let parameters = ProbeParameters::default();
    let mut drawn = Drawn::new(gpu, world.clone(), &layout, parameters, [32, 24]);
    drawn.shot.view = View::Indirect;
    drawn.shot.camera = world.cameras[camera].clone();
    drawn.draw(120);
    let [seen, truth] = [drawn.radiance(), drawn.path_traced(View::Indirect, 512)];
    [
        mean(&seen) / mean(&truth),
        apart(&blocks(&seen), &blocks(&truth)),
    ]
}

#[test]
fn rays_of_bodies_find_the_light_of_faces_not_that_of_probes() {
    let world = room(0, 400, 8, SLAB);
    let by_probes: Fault = (
        "surface_cache/hit_light.wesl",
        "light_at_hit(surface.voxel, surface.face, stop.point_gs)",
        "LightAtHit(vec3f(0.0), false, 1.0)",
    );
    let [[right, error], [wrong, _]] =
        [&[][..], &[by_probes]].map(|faults| against_truth(&world, 0, faults));
    println!("{right:.3} of the light, blocks differ by {error:.3}; {wrong:.3} by probes");
    assert!(
        (right - 1.0).abs() < 0.03 && error < 0.06,
        "{right} {error}"
    );
    assert!((wrong - 1.0).abs() > 0.05, "{wrong}");
}

#[test]
fn a_small_emissive_face_lights_bodies_without_grain() {
    let world = room(100, 0, 4, SLAB);
    let unsampled: Fault = (
        "surface_cache/body_light.wesl",
        "let radiance = sampled + ",
        "let radiance = ",
    );
    let [[right, error], [wrong, grain]] =
        [&[][..], &[unsampled]].map(|faults| against_truth(&world, 0, faults));
    println!(
        "{right:.3} of the light, blocks differ by {error:.3}; {wrong:.3} and {grain:.3} without samples"
    );
    assert!(
        (right - 1.0).abs() < 0.04 && error < 0.05,
        "{right} {error}"
    );
    assert!(wrong < 0.6 && grain > 0.3, "{wrong} {grain}");
}

#[test]
fn a_body_in_another_takes_no_light_from_the_faces_beside_it() {
    let world = room(0, 400, 4, &format!("{SLAB}, {ACROSS}"));
    let dark: Fault = (
        "surface_cache/body_light.wesl",
        "if path.starts_inside {",
        "if path.starts_inside && path.radiance.x > 0.0 {",
    );
    let [[right, error], [wrong, _]] =
        [&[][..], &[dark]].map(|faults| against_truth(&world, 1, faults));
    println!(
        "{right:.3} of the light, blocks differ by {error:.3}; {wrong:.3} if what is inside counts"
    );
    assert!((right - 1.0).abs() < 0.06 && error < 0.1, "{right} {error}");
    assert!(wrong < 0.85, "{wrong}");
}

/// By how much the radiance of a pixel differs from 1 at most, where so many bodies along two axes float in a furnace.
fn farthest_from_furnace(along: u32, faults: &[Fault]) -> f32 {
    let mut bodies = String::new();
    for number in 0..along * along {
        let [x, y] = [number % along, number / along].map(|at| 7 * at);
        let _ = write!(
            bodies,
            "(model: Shape(size: (5, 5, 5), shape: Box(half: (3, 3, 3))), position: ({x}, {y}, 0), degrees: (20, 30, 0)),"
        );
    }
    let middle = 7.0 * f64::from(along - 1) / 2.0;
    let away = 8.0 + 6.0 * f64::from(along);
    let world: World = support::parsed(&format!(
        "(
    title: \"A furnace without walls.\",
    size: (16, 16, 16),
    shape: Empty,
    materials: {{\"half\": (a: Flat(0.5, 0.5, 0.5), emission: (0.5, 0.5, 0.5))}},
    sky: (zenith: (1, 1, 1)),
    bodies: [{bodies}],
    cameras: [(name: \"before them\", position: ({middle}, {middle}, {away}), fov_deg: 60)],
)"
    ));
    let layout = world.layouts[0].clone();
    let gpu = support::with_faults(&support::gpu(), faults);
    let mut drawn = Drawn::new(gpu, world, &layout, ProbeParameters::default(), [64, 64]);
    drawn.draw(24);
    let picture = drawn.radiance();
    let far = picture
        .rgb
        .iter()
        .flatten()
        .map(|light| (light - 1.0).abs());
    far.fold(0.0, f32::max)
}

/// Where there are more faces each sends fewer rays: here eight, four, two and one from a voxel. In a furnace every surface that is lit
/// has the radiance of the sky.
#[test]
fn all_faces_are_lit_however_many_there_are() {
    for along in [2, 5, 8, 10] {
        let far = farthest_from_furnace(along, &[]);
        println!("{along} by {along} bodies: at most {far:.4} from 1");
        assert!(far < 0.03, "{along}: {far}");
    }
    let too_many: Fault = (
        "surface_cache/body_light.wesl",
        "return 1u << firstLeadingBit(share);",
        "return BODY_THREADS / COLUMNS;",
    );
    let far = farthest_from_furnace(10, &[too_many]);
    assert!(far > 0.3, "{far}");
}
