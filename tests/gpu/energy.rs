//! What light a closed room holds, drawn by the whole frame as users get it: default parameters, final gather on.

use grotto::{gpu::Gpu, parameters::ProbeParameters};

use crate::support::{
    self,
    frames::{Drawn, mean},
};

fn room(albedo: f32, emission: f32, power: f32) -> String {
    format!("(
    title: \"A closed room of 16 m.\",
    size: (24, 24, 24),
    origin: (-12, -12, -12),
    shape: Subtraction([Box(half: (12, 12, 12)), Box(half: (8, 8, 8))]),
    materials: {{\"wall\": (a: Flat({albedo}, {albedo}, {albedo}), emission: ({emission}, {emission}, {emission}))}},
    lamps: [(name: \"lamp\", lamps: [(position: (1.7, 2.3, -0.9), power: {power})])],
    sky: (zenith: (0, 0, 0)),
    cameras: [(name: \"inside\", position: (0, 0, 0), look_at: (6, -4, -8), fov_deg: 90)],
    layouts: [(name: \"fine\", counts: (4, 4, 4), spacing: 6)],
)")
}

fn drawn(gpu: Gpu, text: &str) -> Drawn {
    let world = support::parsed(text);
    let layout = world.layouts[0].clone();
    Drawn::new(gpu, world, &layout, ProbeParameters::default(), [48, 48])
}

#[test]
fn explore_furnace() {
    let mut all = vec![];
    for albedo in [0.5f32, 0.8, 0.9] {
        all.push((
            format!("room {albedo}"),
            drawn(support::gpu(), &room(albedo, 1.0, 0.0001)),
            1.0 / (1.0 - albedo),
        ));
    }
    let world = support::shipped("furnace");
    let layout = world.layouts[0].clone();
    all.push((
        "furnace.ron".into(),
        Drawn::new(
            support::gpu(),
            world,
            &layout,
            ProbeParameters::default(),
            [64, 36],
        ),
        2.0,
    ));
    for (name, mut d, expected) in all {
        for _ in 0..8 {
            let start = std::time::Instant::now();
            d.draw(40);
            let p = d.radiance();
            let v: Vec<f32> = p.rgb.iter().map(|c| c[1] / expected).collect();
            let min = v.iter().copied().fold(9.0, f32::min);
            let max = v.iter().copied().fold(0.0, f32::max);
            println!(
                "{name} {} frames: mean {:.5} min {min:.4} max {max:.4} ({:?})",
                d.frame.frames(),
                mean(&p) / f64::from(expected),
                start.elapsed()
            );
        }
    }
}

const LOOKS: [(f32, f32); 6] = [
    (0.0, 0.0),
    (90.0, 0.0),
    (180.0, 0.0),
    (270.0, 0.0),
    (0.0, 90.0),
    (0.0, -90.0),
];

#[test]
fn explore_lamp() {
    for albedo in [0.5f32, 0.8] {
        let mut d = drawn(support::gpu(), &room(albedo, 0.0, 1000.0));
        let expected =
            f64::from(albedo / (1.0 - albedo)) / std::f64::consts::PI * 1000.0 / (6.0 * 256.0);
        for round in 0..6 {
            let mut sum = 0.0;
            let start = std::time::Instant::now();
            for (yaw, pitch) in LOOKS {
                d.view.camera.yaw_deg = yaw;
                d.view.camera.pitch_deg = pitch;
                d.draw(if round == 0 { 40 } else { 16 });
                sum += mean(&d.radiance()) / 6.0;
            }
            println!(
                "albedo {albedo} {} frames: {:.5} ({:?})",
                d.frame.frames(),
                sum / expected,
                start.elapsed()
            );
        }
    }
}
