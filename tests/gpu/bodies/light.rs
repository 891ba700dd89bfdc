//! The stored light of faces of bodies.

use glam::Vec3;
use grotto::{
    gpu::Gpu,
    lights::Lights,
    parameters::ProbeParameters,
    world::{Lamp, View},
};

use super::{SIZE, room, shown, with_block};
use crate::support::{self, Fault, frames::Drawn};

/// The light of before a great change is kept for as long as if nothing had changed.
const KEEPS_LIGHT: Fault = (
    "probes/body_light.wesl",
    "let most = clamp(share * f32(update_schedule.since_great), FEWEST_UPDATES, of_rest);",
    "let most = of_rest;",
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
