//! Lamps whose power goes up and down or whose hue turns, each for itself: `shaders/light/rhythms.wesl`.

use glam::DVec3;
use grotto::{
    gpu::Gpu,
    lights::Lights,
    measure::picture::Picture,
    parameters::{FinalGather, ProbeParameters},
    world::{LayoutSpec, View, World},
};

use crate::support::{self, Fault, frames::Drawn};

/// A room with a wall in it and coloured stone, under two lamps that pulse, of which one turns its hue, and one that is steady:
/// their light has different colours and comes over different ways.
const ROOM: &str = "(
    title: \"Two pulses.\",
    size: (32, 16, 24),
    origin: (-16, -8, -12),
    shape: Union([
        Subtraction([Box(half: (16, 8, 12)), Box(half: (14, 6, 10))]),
        Translate(by: (0, 0, 4), of: Box(half: (1, 6, 6))),
    ]),
    materials: {\"stone\": (a: Flat(0.7, 0.6, 0.5))},
    lamps: [
    (name: \"few\", lamps: [
        (position: (-9, 3, 5), power: 900, colour: (1, 0.3, 0.2), motion: [Pulse(amount: 0.95, rate: 3), HueCycle(rate: 0.4)]),
        (position: (9, 3, 5), power: 900, colour: (0.2, 0.4, 1), motion: [Pulse(amount: 0.9, rate: 5, phase: 2)]),
        (position: (6, -2, -7), power: 200),
    ]),
    (name: \"many\", lamps: [
        (position: (-9, 3, 5), power: 500, colour: (1, 0.6, 0.4), motion: [Pulse(amount: 0.95, rate: 3)]),
        (position: (9, 3, 5), power: 500, colour: (0.5, 0.7, 1), motion: [Pulse(amount: 0.9, rate: 5, phase: 2)]),
        (position: (6, -2, -7), power: 300, motion: [Flicker(amount: 0.8, rate: 6)]),
        (position: (-6, 3, -7), power: 300, motion: [Flicker(amount: 0.8, rate: 4)]),
        (position: (11, 4, -5), power: 300, colour: (1, 0.8, 0.6), motion: [Pulse(amount: 0.9, rate: 4)]),
    ])],
    sky: (zenith: (0, 0, 0)),
    cameras: [(name: \"corner\", position: (-12, 1, -8), look_at: (4, -3, 4), fov_deg: 90)],
    layouts: [
        (name: \"lattice\", counts: (8, 4, 6), spacing: 4.5),
        (name: \"tree\", octree: (depth: 3)),
    ],
)";
const SIZE: [u32; 2] = [36, 24];
/// Pictures are compared by blocks of so many pixels along an edge.
const BLOCK: usize = 6;
const FRAMES: u32 = 32;

/// Pixels know nothing of where the light of faces comes from.
const UNTOLD: Fault = (
    "surface_cache/shares.wesl",
    "return vec3f(unpack2x16float(packed.x), unpack2x16float(packed.y).x);",
    "return vec3f(1.0);",
);
/// Rays bring light, but not whose it is.
const FORGOTTEN: Fault = (
    "probes/incident_light.wesl",
    "of_rhythms += light_of_rhythm(of_lamp.lamp, direct);",
    "of_rhythms = OfRhythms();",
);

struct Case {
    preset: usize,
    layout: usize,
    final_gather: FinalGather,
    view: View,
}

fn room(gpu: Gpu, case: &Case) -> Drawn {
    let world = world(case);
    let layout: LayoutSpec = world.layouts[case.layout].clone();
    let probes = ProbeParameters {
        rays: 96,
        warmup_frames: 12,
        final_gather: case.final_gather,
        ..ProbeParameters::default()
    };
    let mut drawn = Drawn::new(gpu, world, &layout, probes, SIZE);
    drawn.shot.view = case.view;
    drawn
}

fn at(world: &World, time_s: f64) -> Lights {
    Lights::at(world, &world.lamp_presets[0], time_s)
}

/// The room under the lamps of one preset alone: kernels know what these need.
fn world(case: &Case) -> World {
    let mut world: World = support::parsed(ROOM);
    world.lamp_presets = vec![world.lamp_presets[case.preset].clone()];
    world
}

/// Linear RGB of each block.
fn blocks(picture: &Picture) -> Vec<DVec3> {
    let columns = SIZE[0] as usize / BLOCK;
    let mut blocks = vec![DVec3::ZERO; columns * (SIZE[1] as usize / BLOCK)];
    for (index, rgb) in picture.rgb.iter().enumerate() {
        let (x, y) = (index % SIZE[0] as usize, index / SIZE[0] as usize);
        let rgb = DVec3::from_array(rgb.map(f64::from));
        blocks[x / BLOCK + columns * (y / BLOCK)] += rgb / (BLOCK * BLOCK) as f64;
    }
    blocks
}

/// The blocks under each lamp alone, at full power and at rest.
fn alone(case: &Case) -> Vec<Vec<DVec3>> {
    let lamps = 0..at(&world(case), 0.0).lamps.len();
    let of_lamp = |number| {
        let mut drawn = room(support::gpu(), case);
        for (other, lamp) in drawn.lights.lamps.iter_mut().enumerate() {
            let full = lamp.rhythm.map_or(lamp.intensity, |rhythm| rhythm.full);
            *lamp = lamp.dark();
            if other == number {
                lamp.intensity = full;
            }
        }
        drawn.draw(FRAMES);
        blocks(&drawn.radiance())
    };
    lamps.map(of_lamp).collect()
}

/// The greatest mean difference from the sum of the lamps' pictures, each times its gain, of a frame right after each jump in time;
/// relative to the mean of the sum.
fn worst(gpu: Gpu, case: &Case, alone: &[Vec<DVec3>]) -> f64 {
    let mut drawn = room(gpu, case);
    drawn.draw(FRAMES);
    let mut worst = 0.0f64;
    for time_s in [0.52, 1.57, 0.9, 2.6, 1.1] {
        drawn.lights = at(&drawn.world, time_s);
        drawn.draw(1);
        let found = blocks(&drawn.radiance());
        let gains = drawn
            .lights
            .lamps
            .iter()
            .map(|lamp| lamp.rhythm.map_or(DVec3::ONE, |rhythm| rhythm.gain));
        let mut expected = vec![DVec3::ZERO; found.len()];
        for (gain, of_lamp) in gains.zip(alone) {
            for (sum, block) in expected.iter_mut().zip(of_lamp) {
                *sum += gain * *block;
            }
        }
        let apart: f64 = (found.iter().zip(&expected))
            .map(|(found, expected)| (*found - *expected).abs().element_sum())
            .sum();
        let all: f64 = expected.iter().map(|block| block.element_sum()).sum();
        worst = worst.max(apart / all);
    }
    worst
}

/// Light is linear: in every frame, the picture under lamps that pulse is the sum of their pictures, each times its gain.
#[test]
fn light_is_the_sum_of_that_of_each_lamp_times_its_gain_in_every_frame() {
    let cases = [
        (0, 0, FinalGather::On, View::Full, 0.03),
        (0, 1, FinalGather::Off, View::Indirect, 0.04),
        // Told apart by brightness alone.
        (1, 0, FinalGather::On, View::Indirect, 0.05),
    ];
    for (preset, layout, final_gather, view, most) in cases {
        let case = Case {
            preset,
            layout,
            final_gather,
            view,
        };
        let alone = alone(&case);
        let found = worst(support::gpu(), &case, &alone);
        println!("preset {preset}, layout {layout}, {final_gather:?}: {found:.4}");
        assert!(
            found < most,
            "preset {preset}, layout {layout}, {final_gather:?}: {found}"
        );
        if preset == 0 && layout == 0 {
            for fault in [UNTOLD, FORGOTTEN] {
                let faulty = worst(
                    support::with_faults(&support::gpu(), &[fault]),
                    &case,
                    &alone,
                );
                println!("{}: {faulty:.4}", fault.0);
                assert!(faulty > 3.0 * most, "{}: {faulty}", fault.0);
            }
        }
    }
}
