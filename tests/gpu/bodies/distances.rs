//! Distances that probes have measured settle where bodies are, and are measured anew when a body has gone.

use glam::{Quat, UVec3, Vec3};
use grotto::{
    gpu::Gpu,
    measure::picture::Picture,
    parameters::{FinalGather, ProbeParameters, Visibility},
    world::{
        World,
        bodies::{BodyMotion, Cycle},
    },
};

use super::{body, model};
use crate::support::{
    self, Fault,
    frames::{Drawn, apart},
    scenes::flat,
};

const ROOM: &str = "(
    title: \"A high room with plates that hide parts of its floor from each other.\",
    size: (48, 80, 32),
    origin: (0, 0, 0),
    shape: Translate(by: (24, 40, 16), of: Subtraction([Box(half: (24, 40, 16)), Box(half: (22, 38, 14))])),
    lamps: [(name: \"lamps\", lamps: [(position: (6, 18, 16), power: 3000)])],
    sky: (zenith: (0, 0, 0)),
    cameras: [(name: \"floor\", position: (30, 12, 27), look_at: (24, 8, 4), fov_deg: 90)],
    layouts: [(name: \"lattice\", counts: (6, 3, 4), spacing: 8, centre: (24, 12, 16))],
)";
const SIZE: [u32; 2] = [48, 32];
/// Frames in which distances settle: 64 updates at 128 rays.
const SETTLING: u32 = 120;
/// When the plates are up.
const UP_S: f64 = 1.0;

/// Plates part the room at first. In a second they rise between planes of probes, farther than any of them measures.
fn room() -> World {
    let mut world = support::parsed(ROOM);
    world.materials = vec![flat(0.6, 0.0)];
    world
        .bodies
        .models
        .push(model(UVec3::new(2, 18, 26), |_| 1));
    for x in [15.0, 23.0, 31.0] {
        let mut plate = body(0, Vec3::ZERO, Vec3::new(x, 3.0, 3.0), Quat::IDENTITY);
        plate.motion = vec![BodyMotion::Lift {
            by: Vec3::new(0.0, 50.0, 0.0),
            cycle: Cycle {
                period_s: 4.0,
                rest_s: 1.0,
                phase_s: 1.0,
            },
        }];
        world.bodies.bodies.push(plate);
    }
    world
}

/// How the plates come to their end.
#[derive(Clone, Copy)]
enum Way {
    /// They are there from the start.
    None,
    /// They jump there from one frame to the next.
    Jump,
    /// They rise by less than a voxel in a frame.
    Rise,
}

/// The picture long after the plates have come to their end.
fn picture(gpu: Gpu, way: Way) -> Picture {
    let world = room();
    let layout = world.layouts[0].clone();
    let probes = ProbeParameters {
        visibility: Visibility::Chebyshev,
        final_gather: FinalGather::Off,
        ..ProbeParameters::default()
    };
    let mut drawn = Drawn::new(gpu, world, &layout, probes, SIZE);
    let (start_s, frames) = match way {
        Way::None => (UP_S, 1),
        Way::Jump => (0.0, 1),
        Way::Rise => (0.0, 90),
    };
    drawn.shot.time_s = start_s;
    drawn.draw(SETTLING);
    for frame in 1..=frames {
        drawn.shot.time_s = start_s + (UP_S - start_s) * f64::from(frame) / f64::from(frames);
        drawn.draw(1);
    }
    drawn.draw(SETTLING);
    drawn.radiance()
}

/// After the plates have gone this way the picture is that of a world in which they were never elsewhere, and with the fault it
/// is not.
fn forgets(way: Way, fault: Fault) {
    let gpu = support::gpu();
    let wanted = picture(gpu.clone(), Way::None);
    let found = apart(&picture(gpu.clone(), way), &wanted);
    let faulty = support::with_faults(&gpu, &[fault]);
    let stale = apart(&picture(faulty, way), &wanted);
    println!("{found:.4}, and {stale:.4} where distances count as settled");
    assert!(found < 0.004 && stale > 0.007, "{found} {stale}");
}

#[test]
fn probes_forget_what_they_saw_of_a_body_that_has_jumped() {
    let fault = (
        "probes/distance_history.wesl",
        "max(u32(probe.near_bodies), changes.bodies_jumped)",
        "u32(probe.near_bodies)",
    );
    forgets(Way::Jump, fault);
}

#[test]
fn probes_forget_what_they_saw_of_a_body_that_has_risen() {
    let fault = (
        "probes/cover.wesl",
        "near_frame = frame;",
        "near_frame = 0.0;",
    );
    forgets(Way::Rise, fault);
}
