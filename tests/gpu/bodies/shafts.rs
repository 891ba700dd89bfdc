//! Which lamps bodies may hide from a cell: leaving out the search for bodies changes no pixel.

use glam::Vec3;
use grotto::{
    gpu::Gpu,
    lights::Lights,
    measure::picture::Picture,
    parameters::ProbeParameters,
    world::{View, World, bodies::BodyMotion},
};

use super::{SIZE, differing, scattered};
use crate::support::{self, Fault, frames::Drawn, scenes::flat};

/// A yard of several cells along each axis, under the sun, with lamps of every kind.
pub const YARD: &str = "(
    title: \"A yard with lamps of every kind.\",
    size: (64, 48, 64),
    origin: (-32, -24, -32),
    shape: Union([
        Translate(by: (0, -20, 0), of: Box(half: (32, 4, 32))),
        Translate(by: (-20, 0, 0), of: Box(half: (3, 24, 32))),
    ]),
    lamps: [(name: \"lamps\", lamps: [
        (position: (1.7, 15.3, -0.9), power: 4000),
        (position: (24.5, 2.5, -20), power: 4000),
        (position: (-10, -12, 26), power: 3000),
        (position: (12, 20, 12), power: 9000, motion: [Orbit(radius: (9, 3, 9), rate: 2)]),
        (position: (0, 18, 22), power: 6000, soft_radius: 2.5),
        (position: (20, 20, -20), power: 9000, kind: Spot(direction: (-0.6, -1, 0.6), inner_deg: 20, outer_deg: 30)),
    ])],
    sun: (towards: (0.35, 1, 0.3), irradiance: (9, 7.8, 6.3)),
    sky: (zenith: (0, 0, 0)),
    cameras: [(name: \"corner\", position: (26, 10, -26), look_at: (-8, -14, 6), fov_deg: 80)],
    layouts: [(name: \"lattice\", counts: (3, 2, 3), spacing: 20)],
)";
const FILE: &str = "scene/bodies.wesl";
const FOUND: &str = "return fact(fact_of_cell(";

/// A world of more lamps than a list has slots, so that lamps have numbers of every size: weak ones come first.
pub fn yard(text: &str) -> World {
    let mut world = support::parsed(text);
    let lamps = &mut world.lamp_presets[0].lamps;
    let weak = |number: u8| {
        let at = Vec3::new(
            f32::from(number) * 1.5 - 25.0,
            9.5,
            f32::from(number % 7) * 6.0 - 20.0,
        );
        let mut lamp = lamps[0].clone();
        lamp.position = at;
        lamp.power = 10.0;
        lamp
    };
    let weak: Vec<_> = (0..32).map(weak).collect();
    lamps.splice(0..0, weak);
    world
}

/// Direct light at three moments, while bodies turn and a lamp orbits.
fn pictures(gpu: Gpu) -> Vec<Picture> {
    let mut world = yard(YARD);
    world.materials = vec![flat(0.6, 0.0)];
    let mut state = 11;
    world.bodies = scattered(8, Vec3::new(60.0, 34.0, 60.0), &mut state);
    for body in &mut world.bodies.bodies {
        body.rest.position += Vec3::new(-30.0, -14.0, -30.0);
        body.motion = vec![BodyMotion::Turn {
            axis: Vec3::Y,
            rate: 1.5,
        }];
    }
    let layout = world.layouts[0].clone();
    // Probes have no part in direct light.
    let probes = ProbeParameters {
        rays: 8,
        ..ProbeParameters::default()
    };
    let mut drawn = Drawn::new(gpu, world, &layout, probes, SIZE);
    drawn.shot.view = View::Direct;
    (0..3)
        .map(|moment| {
            let time_s = f64::from(moment) * 0.4;
            drawn.shot.time_s = time_s;
            drawn.lights = Lights::at(&drawn.world, &drawn.world.lamp_presets[0], time_s);
            drawn.draw(3);
            drawn.radiance()
        })
        .collect()
}

fn most_differing(a: &[Picture], b: &[Picture]) -> f64 {
    let pairs = a.iter().zip(b);
    pairs.map(|(a, b)| differing(a, b)).fold(0.0, f64::max)
}

#[test]
fn shafts_leave_out_no_body() {
    let gpu = support::gpu();
    let with = |faults: &[Fault]| pictures(support::with_faults(&gpu, faults));
    let found = pictures(gpu.clone());
    let searched = with(&[(
        FILE,
        FOUND,
        "return vec2u(0xffffffffu) | fact(fact_of_cell(",
    )]);
    assert!(
        most_differing(&found, &searched) == 0.0,
        "{} of the pixels differ from those that look for bodies on every way",
        most_differing(&found, &searched)
    );
    let never = with(&[(FILE, FOUND, "return vec2u(0u) & fact(fact_of_cell(")]);
    assert!(most_differing(&found, &never) > 0.005, "bodies hide lamps");
    let shafts = "surface_cache/body_shafts.wesl";
    let narrow = with(&[(
        shafts,
        "let half = 0.5 * (place.high_ws - place.low_ws) + MARGIN;",
        "let half = vec3f(0.0);",
    )]);
    assert!(
        most_differing(&found, &narrow) > 0.0,
        "shafts that are too narrow are found"
    );
    let few = with(&[(
        shafts,
        "if slot < list.count {",
        "if slot < min(list.count, 32u) {",
    )]);
    assert!(
        most_differing(&found, &few) > 0.0,
        "lamps with large numbers count, too"
    );
    let short = with(&[(shafts, "middle_ws - lamp.direction_ws * FAR", "middle_ws")]);
    assert!(
        most_differing(&found, &short) > 0.0,
        "shafts that end before the sun are found"
    );
}
