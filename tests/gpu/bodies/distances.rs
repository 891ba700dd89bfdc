//! Distances that probes have measured settle where bodies are, and are measured anew when a body has gone.

use glam::{Quat, UVec3, Vec3};
use grotto::{
    gpu::Gpu,
    measure::picture::Picture,
    parameters::{FinalGather, ProbeParameters, Visibility},
    world::{
        World,
        bodies::{BodyMotion, Ease},
    },
};

use super::{body, model};
use crate::support::{
    self,
    frames::{Drawn, apart},
    scenes::flat,
};

const ROOM: &str = "(
    title: \"A room with a plate that hides one half from the other.\",
    size: (48, 24, 32),
    origin: (0, 0, 0),
    shape: Translate(by: (24, 12, 16), of: Subtraction([Box(half: (24, 12, 16)), Box(half: (22, 10, 14))])),
    lamps: [(name: \"lamps\", lamps: [(position: (6, 18, 16), power: 3000)])],
    sky: (zenith: (0, 0, 0)),
    cameras: [(name: \"room\", position: (30, 12, 27), look_at: (24, 8, 4), fov_deg: 90)],
    layouts: [(name: \"lattice\", counts: (6, 3, 4), spacing: 8, centre: (24, 12, 16))],
)";
const SIZE: [u32; 2] = [48, 32];
/// Frames in which distances settle: 64 updates at 128 rays.
const SETTLING: u32 = 120;
/// When the plate has turned to the wall.
const AWAY_S: f64 = 1.0;

/// The plate parts the room at first, and stands at a wall after a second.
fn room() -> World {
    let mut world = support::parsed(ROOM);
    world.materials = vec![flat(0.6, 0.0)];
    world
        .bodies
        .models
        .push(model(UVec3::new(2, 18, 26), |_| 1));
    let mut plate = body(0, Vec3::ZERO, Vec3::new(15.0, 3.0, 3.0), Quat::IDENTITY);
    plate.motion = vec![BodyMotion::TurnBetween {
        axis: Vec3::Y,
        degrees: 90.0,
        start_s: 0.0,
        end_s: AWAY_S as f32,
        ease: Ease::Linear,
    }];
    world.bodies.bodies.push(plate);
    world
}

/// The picture after the plate has jumped away; or that of a world in which it was never elsewhere.
fn picture(gpu: Gpu, jumps: bool) -> Picture {
    let world = room();
    let layout = world.layouts[0].clone();
    let probes = ProbeParameters {
        visibility: Visibility::Chebyshev,
        final_gather: FinalGather::Off,
        ..ProbeParameters::default()
    };
    let mut drawn = Drawn::new(gpu, world, &layout, probes, SIZE);
    drawn.shot.time_s = if jumps { 0.0 } else { AWAY_S };
    drawn.draw(SETTLING);
    drawn.shot.time_s = AWAY_S;
    drawn.draw(SETTLING);
    drawn.radiance()
}

#[test]
fn probes_forget_what_they_saw_of_a_body_that_has_left() {
    let gpu = support::gpu();
    let wanted = picture(gpu.clone(), false);
    let found = apart(&picture(gpu.clone(), true), &wanted);
    let fault = (
        "probes/light_history.wesl",
        "    return updates_since(max(near, changes.bodies_jumped), pulse) - 2.0;",
        "    return UNCHANGED;",
    );
    let stale = apart(
        &picture(support::with_faults(&gpu, &[fault]), true),
        &wanted,
    );
    println!("{found:.4}, and {stale:.4} where distances count as settled for ever");
    assert!(found < 0.003 && stale > 0.005, "{found} {stale}");
}
