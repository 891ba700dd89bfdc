//! The stored light of faces of bodies.

use glam::Vec3;
use grotto::{
    gpu::Gpu,
    lights::Lights,
    parameters::ProbeParameters,
    world::{Lamp, View, World},
};

use super::{SIZE, room, shown, with_block};
use crate::support::{
    self, Fault,
    frames::{Drawn, mean},
};

/// The light of before a great change is kept for as long as if nothing had changed.
const KEEPS_LIGHT: Fault = (
    "surface_cache/body_light.wesl",
    "return clamp(share * f32(update_schedule.since_great), FEWEST_UPDATES, of_rest);",
    "return MOST_UPDATES;",
);

/// The brighter one of two lamps goes out. Returns the indirect light of a body after 24 frames, each of which brings a bounce or more,
/// over what it settles to.
fn after_switch(gpu: Gpu) -> f64 {
    let mut world = with_block(0.3);
    let lamps = &mut world.lamp_presets[0].lamps;
    let weak = Lamp {
        position: Vec3::new(-6.0, -2.0, -3.0),
        power: 50.0,
        ..lamps[0].clone()
    };
    lamps.push(weak);
    let layout = world.layouts[0].clone();
    let probes = ProbeParameters::default();
    let mut with = Drawn::new(gpu, world, &layout, probes.clone(), SIZE);
    let mut without = Drawn::new(support::gpu(), room(), &layout, probes, SIZE);
    let [a, b] = [&mut with, &mut without].map(|drawn| shown(drawn, View::Depth));
    let on_body: Vec<usize> = (0..a.rgb.len())
        .filter(|&at| a.rgb[at] != b.rgb[at])
        .collect();
    assert!(on_body.len() > 50, "{}", on_body.len());
    let light = |drawn: &mut Drawn| -> f64 {
        let picture = shown(drawn, View::Indirect);
        on_body
            .iter()
            .map(|&at| f64::from(picture.rgb[at][1]))
            .sum()
    };
    with.draw(90);
    let bright = light(&mut with);
    with.world.lamp_presets[0].lamps[0].power = 0.0;
    with.lights = Lights::at(&with.world, &with.world.lamp_presets[0], 0.0);
    with.draw(23);
    let soon = light(&mut with);
    with.draw(150);
    let settled = light(&mut with);
    assert!(bright > 5.0 * settled, "{bright} becomes {settled}");
    soon / settled
}

#[test]
fn light_of_bodies_follows_a_switched_lamp() {
    let ratio = after_switch(support::gpu());
    let slow = after_switch(support::with_faults(&support::gpu(), &[KEEPS_LIGHT]));
    println!("{ratio:.3} after 24 frames, {slow:.3} if the light of before is kept");
    assert!((ratio - 1.0).abs() < 0.15, "{ratio}");
    assert!(slow > 1.5, "{slow}");
}

/// A room below a hole in its roof, and a slab `gap` voxels above the hole: all light comes through the slot between them.
fn slot(gap: u32) -> World {
    support::parsed(&format!(
        "(
    title: \"A slot.\",
    size: (64, 32, 64),
    origin: (-32, -8, -32),
    shape: Subtraction([
        Translate(by: (0, 5, 0), of: Box(half: (13, 8, 13))),
        Translate(by: (0, 5, 0), of: Box(half: (10, 5, 10))),
        Translate(by: (0, 12, 0), of: Box(half: (5, 4, 5))),
    ]),
    materials: {{\"grey\": (a: Flat(0.6, 0.6, 0.6))}},
    rules: [(material: \"grey\")],
    sky: (zenith: (0.5, 0.5, 0.5)),
    sun: (towards: (0.3, 1, 0.2), irradiance: (30, 30, 30)),
    lamps: [(name: \"the sun alone\")],
    bodies: [(model: Shape(size: (12, 1, 12), shape: Box(half: (6, 1, 6))), position: (0, {}, 0))],
    cameras: [(name: \"inside\", position: (8, 7, 8), look_at: (-6, 2, -6), fov_deg: 80)],
    layouts: [(name: \"lattice\", counts: (7, 8, 7), spacing: 4, centre: (0.5, 10.5, 0.5))],
)",
        f64::from(13 + gap) + 0.5
    ))
}

/// All rays of a face begin at one of its voxels.
const FROM_ONE_VOXEL: Fault = (
    "surface_cache/body_light.wesl",
    "path_from(surface_in(own, sender, number)",
    "path_from(surface_in(own, 0u, number)",
);
/// The columns of a quadrant have the mean of their light.
const MEAN_OF_QUADRANT: Fault = (
    "surface_cache/body_light.wesl",
    "senders[thread] == column);",
    "true);",
);

/// The light of the room, some of which comes from the slab's lower side, over that of the path tracer.
fn light_in_slot(gap: u32, faults: &[Fault]) -> f64 {
    let world = slot(gap);
    let layout = world.layouts[0].clone();
    let gpu = support::with_faults(&support::gpu(), faults);
    let mut slot = Drawn::new(gpu, world, &layout, ProbeParameters::default(), [32, 18]);
    slot.draw(80);
    mean(&slot.radiance()) / mean(&slot.path_traced(View::Full, 1024))
}

#[test]
fn light_below_a_body_in_a_slot_is_that_of_the_path_tracer() {
    let [right, wrong] = [&[][..], &[FROM_ONE_VOXEL]].map(|faults| light_in_slot(3, faults));
    println!("{right:.3} of the light, {wrong:.3} with the fault");
    assert!((right - 1.0).abs() < 0.05, "{right}");
    assert!(right - wrong > 0.03, "{right} {wrong}");
}

#[test]
fn light_below_a_body_falls_within_two_voxels_of_a_narrow_slot() {
    let [right, wrong] = [&[][..], &[MEAN_OF_QUADRANT]].map(|faults| light_in_slot(1, faults));
    println!("{right:.3} of the light, {wrong:.3} if quadrants have their mean");
    assert!((right - 1.0).abs() < 0.05, "{right}");
    assert!(wrong - right > 0.05, "{right} {wrong}");
}
