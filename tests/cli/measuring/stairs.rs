//! The final gather on steps and beside a small light, against the path tracer.

use std::fs;

use super::{Bench, number};

/// A closed room with stairs of one voxel, and a glowing block on its floor: details too small for probes that
/// are several voxels apart.
const STAIRS: &str = r#"(
    title: "Stairs, and a block that glows.",
    size: (32, 16, 32),
    origin: (-16, -4, -16),
    shape: Union([
        Subtraction([
            Translate(by: (0, 4, 0), of: Box(half: (10, 6, 10))),
            Translate(by: (0, 4, 0), of: Box(half: (8, 4, 8))),
        ]),
        Translate(by: (-5, 0, 0), of: Box(half: (3, 1, 8))),
        Translate(by: (-6, 0, 0), of: Box(half: (2, 2, 8))),
        Translate(by: (-7, 0, 0), of: Box(half: (1, 3, 8))),
        Translate(by: (4.5, 0.5, 0.5), of: Box(half: (0.5, 0.5, 0.5))),
    ]),
    materials: {
        "glow": (a: Flat(0.3, 0.3, 0.3), emission: (6, 4, 2)),
        "plaster": (a: Flat(0.6, 0.6, 0.6)),
    },
    rules: [
        (material: "glow", when: InBox(min: (4, 0, 0), max: (5, 1, 1))),
        (material: "plaster"),
    ],
    lamps: [(name: "one", lamps: [(name: "lamp", position: (3, 7, 5), power: 600, radius: 0.5)])],
    cameras: [
        (name: "stairs", position: (3, 5, 6), look_at: (-7, 1.5, -2), fov_deg: 60),
        (name: "glow", position: (0, 4, -4), look_at: (4.5, 0, 1), fov_deg: 60),
    ],
    layouts: [(name: "fine", counts: (6, 4, 6), spacing: 4, centre: (0.5, 4.5, 0.5))],
)"#;

/// Both cameras with each of two values of a parameter, against the path tracer: rows of `grotto judge`.
fn stairs(vary: &str, [spp, frames, rays]: [u32; 3]) -> Vec<serde_json::Value> {
    let bench = Bench::new();
    let world = bench.path("stairs.ron");
    fs::write(&world, STAIRS).expect("writable");
    let world = world.display().to_string();
    let [spp, frames, rays] = [spp, frames, rays].map(|number| number.to_string());
    let (mut judged, _) = bench.judged(&[
        &world,
        "--vary",
        vary,
        "--skip-response",
        "--skip-stability",
        "--spp",
        &spp,
        "--frames",
        &frames,
        "--rays",
        &rays,
        "--against",
        "reference",
    ]);
    let rows = judged["rows"].as_array_mut().expect("rows");
    assert_eq!(rows.len(), 4);
    std::mem::take(rows)
}

#[test]
fn the_final_gather_is_nearer_to_the_truth_than_probes_alone() {
    let rows = stairs("probes.final_gather=off,on", [512, 64, 128]);
    let flip = |setting: &str| -> f64 {
        let chosen = rows
            .iter()
            .filter(|row| row["settings"]["probes.final_gather"] == setting);
        chosen.map(|row| number(row, "full.flip.mean")).sum()
    };
    let (off, on) = (flip("off"), flip("on"));
    assert!(on > 0.0 && on < 0.8 * off, "{on} with, {off} without");
    for row in &rows {
        let energy = number(row, "indirect.energy_ratio");
        let with_gather = row["settings"]["probes.final_gather"] == "on";
        let bounds = if with_gather { 0.96..1.04 } else { 0.8..1.25 };
        assert!(bounds.contains(&energy), "{energy}");
    }
}
