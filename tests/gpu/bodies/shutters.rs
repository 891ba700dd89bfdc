//! Bodies that let light into a room that was dark, and that shut it out again.

use grotto::{
    parameters::ProbeParameters,
    world::{View, World},
};

use crate::support::{
    self, Fault,
    frames::{Drawn, apart, mean},
};

/// A dark room below the sky, whose roof slides open within 1.5 seconds, and shut again from 1.6 seconds on.
const ROOM: &str = "(
    title: \"A shutter.\",
    size: (32, 24, 32),
    shape: Subtraction([
        Box(half: (32, 24, 32)),
        Translate(by: (16, 8, 16), of: Box(half: (8, 6, 8))),
        Translate(by: (16, 20, 16), of: Box(half: (4, 7, 4))),
    ]),
    materials: {\"grey\": (a: Flat(0.6, 0.6, 0.6))},
    rules: [(material: \"grey\")],
    sky: (zenith: (1, 1, 1)),
    lamps: [(name: \"the sky alone\")],
    bodies: [(
        model: Shape(size: (9, 1, 9), shape: Box(half: (5, 1, 5))), position: (16, 24.5, 16),
        motion: [Lift(by: (9, 0, 0), period_s: 3.2, rest_s: 0.1, phase_s: 0.1)],
    )],
    cameras: [(name: \"inside\", position: (10, 10, 10), look_at: (20, 4, 20), fov_deg: 70)],
    layouts: [(name: \"lattice\", counts: (6, 6, 6), spacing: 4)],
)";

/// The probes' estimate may lift a face's light by as much while rays are repeated as where none are.
const LIFTED: [Fault; 2] = [
    (
        "surface_cache/resolve.wesl",
        "const MOST_RATIO_OF_REPEATED: f32 = 1.25;",
        "const MOST_RATIO_OF_REPEATED: f32 = 8.0;",
    ),
    (
        "surface_cache/resolve.wesl",
        "const MOST_RATIO_BETWEEN: f32 = 2.0;",
        "const MOST_RATIO_BETWEEN: f32 = 8.0;",
    ),
];

/// The light of a picture over that of the path tracer, 36 frames after the shutter has begun to open.
fn over_truth(faults: &[Fault]) -> f64 {
    let world: World = support::parsed(ROOM);
    let layout = world.layouts[0].clone();
    let gpu = support::with_faults(&support::gpu(), faults);
    let probes = ProbeParameters::default();
    let mut room = Drawn::new(gpu, world, &layout, probes, [32, 24]);
    room.draw(60);
    for frame in 1..=36 {
        room.shot.time_s = f64::from(frame) / 60.0;
        room.draw(1);
    }
    mean(&room.radiance()) / mean(&room.path_traced(room.shot.view, 256))
}

#[test]
fn a_room_that_opens_is_as_bright_as_it_should_be() {
    let [right, wrong] = [&[][..], &LIFTED].map(over_truth);
    println!("{right:.3}, {wrong:.3} with the fault");
    // It is late in software, where faces wait longer for their rays.
    assert!((0.5..1.25).contains(&right), "{right}");
    assert!(wrong > 1.5, "{wrong}");
}

/// A change that the probes tell brings no noise to the faces whose repeated rays do not see it.
const CALM: Fault = (
    "surface_cache/resolve.wesl",
    "of_spot += 0.25 * spread * told_changes[(thread & ~3u) + i];",
    "",
);

/// How far the bounced light of the sun is from the path tracer's, relative to it, while the roof slides shut: a patch of the
/// floor lights all the room, and becomes smaller.
fn apart_while_closing(faults: &[Fault]) -> f64 {
    let sunny = ROOM.replace(
        "sky: (zenith: (1, 1, 1)),",
        "sky: (zenith: (0, 0, 0)), sun: (towards: (0.2, 1, 0.1), irradiance: (40, 40, 40)),",
    );
    let world: World = support::parsed(&sunny);
    let layout = world.layouts[0].clone();
    let gpu = support::with_faults(&support::gpu(), faults);
    let probes = ProbeParameters::default();
    let mut room = Drawn::new(gpu, world, &layout, probes, [40, 30]);
    room.shot.view = View::Indirect;
    room.shot.time_s = 1.6;
    // So long that faces have found their light by many rays.
    room.draw(110);
    for frame in 1..=44 {
        room.shot.time_s = 1.6 + f64::from(frame) / 60.0;
        room.draw(1);
    }
    apart(&room.radiance(), &room.path_traced(View::Indirect, 256))
}

#[test]
fn faces_trust_old_rays_less_while_a_room_closes() {
    let [right, wrong] = [&[][..], &[CALM]].map(apart_while_closing);
    println!("{right:.3}, {wrong:.3} with the fault");
    assert!(right < 0.92 * wrong, "{right} {wrong}");
}
