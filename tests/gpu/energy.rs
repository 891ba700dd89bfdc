//! The default path neither loses nor creates light: whole frames as users get them, with default
//! parameters and the final gather on, in closed rooms whose light is known in closed form.

use std::f64::consts::PI;

use glam::DVec3;
use grotto::{
    gpu::Gpu,
    measure::picture::Picture,
    parameters::ProbeParameters,
    world::{LampPreset, View, World},
};

use crate::support::{
    self,
    frames::{Drawn, mean},
    scenes::{all_around, flat},
};

/// Largest relative error of a law. Frames settle within 0.4 % of the furnaces and 0.5 % of the lamp's power.
/// The error grows with the number of bounces that matter (at albedo 0.8 it is 1 % of the lamp's power).
const TOLERANCE: f64 = 0.01;

/// A closed room of 16 m. The camera stands in its middle, from where a square picture of 90° shows
/// one wall and nothing else, every part of it equally large.
const ROOM: &str = "(
    title: \"A closed room.\",
    size: (24, 24, 24),
    origin: (-12, -12, -12),
    shape: Subtraction([Box(half: (12, 12, 12)), Box(half: (8, 8, 8))]),
    lamps: [(name: \"lamp\", lamps: [(position: (1.7, 2.3, -0.9), power: 1000)])],
    sky: (zenith: (0, 0, 0)),
    cameras: [(name: \"middle\", position: (0, 0, 0), look_at: (6, -4, -8), fov_deg: 90)],
    layouts: [(name: \"lattice\", counts: (4, 4, 4), spacing: 6)],
)";
/// Power of the lamp (W).
const POWER: f64 = 1000.0;
/// Area of the walls (m²).
const AREA: f64 = 6.0 * 16.0 * 16.0;

/// Three pixels per voxel: no face is too small to have its own light.
const SIZE: [u32; 2] = [48, 48];

fn room(albedo: f32, emission: f32) -> World {
    let mut world = support::parsed(ROOM);
    world.materials = vec![flat(albedo, emission)];
    world
}

/// Drawn in its first layout, with default parameters.
fn drawn(gpu: Gpu, world: World) -> Drawn {
    let layout = world.layouts[0].clone();
    Drawn::new(gpu, world, &layout, ProbeParameters::default(), SIZE)
}

/// A furnace has no lamps.
fn furnace(gpu: Gpu, mut world: World, frames: u32) -> Picture {
    world.lamp_presets = vec![LampPreset {
        name: "none".into(),
        lamps: Vec::new(),
    }];
    let mut drawn = drawn(gpu, world);
    drawn.draw(frames);
    drawn.radiance()
}

/// Whether every pixel has this radiance.
fn is_even(picture: &Picture, expected: f64) -> Result<(), String> {
    let errors = picture.rgb.iter().flatten().map(|value| {
        assert!(value.is_finite(), "{value}");
        f64::from(*value) / expected - 1.0
    });
    let worst = errors.fold(0.0, |worst: f64, error| {
        if error.abs() > worst.abs() {
            error
        } else {
            worst
        }
    });
    if worst.abs() <= TOLERANCE {
        return Ok(());
    }
    Err(format!("off by {:.2} %", 100.0 * worst))
}

fn scaled(picture: &Picture, by: f32) -> Picture {
    let mut scaled = picture.clone();
    scaled
        .rgb
        .iter_mut()
        .flatten()
        .for_each(|value| *value *= by);
    scaled
}

/// A closed room whose walls emit e and reflect ρ has radiance e / (1 − ρ) everywhere.
#[test]
fn a_white_furnace_has_its_radiance_in_every_pixel() {
    for albedo in [0.0, 0.5, 0.8f32] {
        let picture = furnace(support::gpu(), room(albedo, 1.0), 120);
        let expected = 1.0 / (1.0 - f64::from(albedo));
        is_even(&picture, expected).unwrap_or_else(|error| panic!("albedo {albedo}: {error}"));
        for fault in [0.98, 1.02] {
            let wrong = scaled(&picture, fault);
            assert!(is_even(&wrong, expected).is_err(), "{fault} passes");
        }
    }
}

/// A room that is nearly white: light is reflected more than a hundred times.
#[test]
fn a_furnace_of_white_walls_warms_up_until_all_light_is_there() {
    let picture = furnace(support::gpu(), room(0.95, 0.05), 200);
    is_even(&picture, 1.0).unwrap_or_else(|error| panic!("{error}"));
}

/// Probes hidden by pillars, and probes inside pillars, remove no light.
#[test]
fn the_furnace_of_the_worlds_has_its_radiance_in_every_pixel() {
    let picture = furnace(support::gpu(), support::shipped("furnace"), 120);
    is_even(&picture, 2.0).unwrap_or_else(|error| panic!("{error}"));
}

#[test]
fn a_furnace_whose_bounces_lose_a_fiftieth_is_found() {
    let fault = (
        "surface_cache/trace.wesl",
        "return mean_albedo(",
        "return 0.98 * mean_albedo(",
    );
    let gpu = support::with_faults(&support::gpu(), &[fault]);
    let picture = furnace(gpu, room(0.8, 1.0), 60);
    is_even(&picture, 5.0).expect_err("what rays of faces hit reflects too little");
}

/// What the walls absorb relative to the closed form: of all light, and of bounced light alone.
struct Absorbed {
    all: f64,
    bounced: f64,
}

impl Absorbed {
    /// Shows all walls in turn, each for `settling` frames, then each again for `measured` frames.
    fn of(gpu: Gpu, albedo: f32, [settling, measured]: [u32; 2]) -> Self {
        let mut drawn = drawn(gpu, room(albedo, 0.0));
        each_wall(&mut drawn, |drawn| {
            drawn.draw(settling);
            0.0
        });
        let reflected = each_wall(&mut drawn, |drawn| {
            drawn.draw(measured);
            mean(&drawn.radiance())
        });
        drawn.shot.view = View::Irradiance;
        let bounced = each_wall(&mut drawn, |drawn| {
            drawn.draw(1);
            mean(&drawn.radiance())
        });
        let albedo = f64::from(albedo);
        // A wall absorbs its irradiance times 1 − ρ; it shows its irradiance times ρ/π.
        let all = reflected * PI / albedo * (1.0 - albedo) * AREA / POWER;
        // The first bounce absorbs the share 1 − ρ of the lamp's power.
        let bounced = bounced * PI * (1.0 - albedo) * AREA / (POWER * albedo);
        Self { all, bounced }
    }

    fn is_power_of_the_lamp(&self) -> Result<(), String> {
        for (what, share) in [("all", self.all), ("bounced", self.bounced)] {
            if (share - 1.0).abs() > TOLERANCE {
                return Err(format!("{share:.4} of {what} light"));
            }
        }
        Ok(())
    }
}

/// Mean of `measure` over the six walls.
fn each_wall(drawn: &mut Drawn, mut measure: impl FnMut(&mut Drawn) -> f64) -> f64 {
    let mut sum = 0.0;
    for camera in all_around(DVec3::ZERO) {
        drawn.shot.camera = camera;
        sum += measure(drawn);
    }
    sum / 6.0
}

/// In a closed room the walls absorb all power of a lamp, after any number of bounces.
#[test]
fn walls_absorb_the_power_of_the_lamp() {
    for albedo in [0.5, 0.6] {
        let absorbed = Absorbed::of(support::gpu(), albedo, [20, 12]);
        println!(
            "albedo {albedo}: {:.4}, {:.4}",
            absorbed.all, absorbed.bounced
        );
        absorbed
            .is_power_of_the_lamp()
            .unwrap_or_else(|error| panic!("albedo {albedo}: {error}"));
    }
}

/// After a lamp has gone on, light makes one bounce with each update of the probes. n bounces of all that there are bring the share
/// 1 − ρⁿ of the light that comes from walls of albedo ρ.
#[test]
fn light_makes_several_bounces_in_a_frame_after_a_lamp_has_gone_on() {
    const ALBEDO: f64 = 0.8;
    // White walls warm up for longer than others.
    const SETTLING: u32 = 100;
    // Bounces until the end of each frame, of which the first three have three, three and two.
    const BOUNCES: [i32; 3] = [3, 6, 8];
    let mut drawn = drawn(support::gpu(), room(ALBEDO as f32, 0.0));
    // The light of a lone lamp is scaled when its power changes. This one is never alone.
    let mut dim = drawn.lights.lamps[0];
    dim.position_ws.x -= 4.0;
    dim.intensity *= 0.01;
    drawn.lights.lamps.push(dim);
    let lit = drawn.lights.clone();
    drawn.lights.lamps[0].intensity = DVec3::ZERO;
    drawn.draw(SETTLING);
    let before = light_of_probes(&drawn);
    drawn.lights = lit;
    let light = BOUNCES.map(|_| {
        drawn.draw(1);
        light_of_probes(&drawn) - before
    });
    drawn.draw(SETTLING);
    let all = light_of_probes(&drawn) - before;
    for (light, bounces) in light.into_iter().zip(BOUNCES) {
        let (share, expected) = (light / all, 1.0 - ALBEDO.powi(bounces));
        println!("{bounces} bounces: {share:.3} of all light, expected {expected:.3}");
        assert!((share - expected).abs() < TOLERANCE, "{bounces} bounces");
    }
}

/// Mean over all directions of all probes.
fn light_of_probes(drawn: &Drawn) -> f64 {
    let maps = drawn.frame.field().irradiance(&drawn.gpu).expect("reads");
    let sum: f64 = maps.iter().map(|[_, green, _]| f64::from(*green)).sum();
    sum / maps.len() as f64
}

/// At albedo ½ bounces after the third carry a sixteenth of all light.
#[test]
fn lost_bounces_are_found() {
    let faults = [
        // Rays from faces use the light of the probes at their hits, not that of the faces that they hit.
        (
            "surface_cache/hit_light.wesl",
            "light_at_hit(surface.voxel, surface.face, stop.point_gs)",
            "LightAtHit(vec3f(0.0), false, 1.0)",
        ),
        // Probes ignore every bounce before the one that their rays see.
        (
            "probes/trace.wesl",
            "(light.direct + light.indirect)",
            "light.direct",
        ),
    ];
    let gpu = support::with_faults(&support::gpu(), &faults);
    let absorbed = Absorbed::of(gpu, 0.5, [20, 8]);
    println!("{:.4}, {:.4}", absorbed.all, absorbed.bounced);
    assert!(absorbed.is_power_of_the_lamp().is_err());
    assert!(
        (0.8..0.97).contains(&absorbed.all),
        "the fault is about as large as said: {:.4}",
        absorbed.all
    );
}
