//! Storms on a small room: each storm passes, each can be repeated, and each check finds the fault that it is for.

use std::{
    collections::BTreeSet,
    sync::atomic::{AtomicBool, Ordering},
};

use grotto::{
    commands::stress::storms::{
        Found, Kind, Kinds, Length, Now, Plan, Planted, Scene, StormRecord, run_plan,
    },
    parameters::Parameters,
};
use indicatif::ProgressBar;

use crate::support::{
    self,
    binary::{grotto, output},
};

const ROOM: &str = "(
    title: \"A small room with two lamps that move and a block that glows.\",
    size: (40, 24, 32),
    origin: (-20, -4, -16),
    shape: Union([
        Subtraction([
            Translate(by: (0, 8, 0), of: Box(half: (20, 12, 16))),
            Translate(by: (0, 7, 0), of: Box(half: (15, 7, 12))),
        ]),
        Translate(by: (4, 2, -3), of: Box(half: (2, 2, 2))),
    ]),
    materials: {
        \"plaster\": (a: Flat(0.7, 0.65, 0.6)),
        \"red\": (a: Flat(0.7, 0.2, 0.1)),
        \"glow\": (a: Flat(0.5, 0.5, 0.5), emission: (2, 1, 0.5)),
    },
    rules: [
        (material: \"glow\", when: InBox(min: (2, 3, -5), max: (6, 4, -1))),
        (material: \"red\", when: InBox(min: (-20, 0, -16), max: (-15, 14, 16))),
        (material: \"plaster\"),
    ],
    lamps: [(name: \"two\", lamps: [
        (position: (-6, 9, 3), power: 300, motion: [Orbit(radius: (3, 2, 3), rate: 2)]),
        (position: (8, 8, 2), power: 200, colour: (0.4, 0.7, 1), motion: [Bob(amplitude: (0, 3, 0), rate: 1)]),
    ])],
    sky: (zenith: (0, 0, 0)),
    cameras: [
        (name: \"a\", position: (11, 8, 8), look_at: (-6, 3, -6), fov_deg: 80),
        (name: \"b\", position: (-10, 6, 6), look_at: (6, 2, -6), fov_deg: 75),
    ],
    layouts: [
        (name: \"fine\", counts: (5, 3, 4), spacing: 6, centre: (0.5, 6.5, 0.5)),
        (name: \"coarse\", counts: (3, 2, 3), spacing: 10, centre: (0.5, 6.5, 0.5)),
    ],
)";

static RUNNING: AtomicBool = AtomicBool::new(false);

fn storm(kinds: &[Kind], frames: u32, planted: Planted) -> Found {
    stoppable(kinds, frames, planted, &RUNNING)
}

fn stoppable(kinds: &[Kind], frames: u32, planted: Planted, stop: &AtomicBool) -> Found {
    let world = support::parsed(ROOM);
    let mut parameters = Parameters::default();
    for assignment in ["probes.rays=16", "probes.final_gather=off"] {
        parameters.set(assignment).expect("allowed");
    }
    let start = Now {
        layout: world.layouts[0].clone(),
        parameters,
        size: [32, 24],
        time_s: 0.0,
        camera: world.cameras[0].clone(),
        seed: 5,
    };
    let scene = Scene {
        lamps: world.lamp_presets[0].clone(),
        world,
    };
    let plan = Plan {
        scene: &scene,
        start,
        kinds: Kinds::new(kinds),
        length: Length::Frames(frames),
        settling: 32,
        seed: 5,
        planted,
    };
    let gpu = support::gpu();
    run_plan(gpu, &plan, stop, &ProgressBar::hidden()).expect("the adapter holds a small room")
}

/// The names of the checks that failed.
fn failed(found: &Found) -> BTreeSet<&str> {
    assert!(found.complete && !found.checks.is_empty());
    let failed = found.checks.iter().filter(|check| !check.passed);
    failed.map(|check| check.name.as_str()).collect()
}

/// Asserts that the storm passes and made at least these changes.
fn passes(kinds: &[Kind], frames: u32, changed: &[(&str, u64)]) {
    let found = storm(kinds, frames, Planted::Nothing);
    assert_eq!(failed(&found), BTreeSet::new(), "{:#?}", found.checks);
    for (what, least) in changed {
        let count = found.changes.get(what).copied().unwrap_or(0);
        assert!(count >= *least, "{what}: {count}");
    }
    assert_eq!(found.frames, frames);
}

#[test]
fn voxels_survive_an_edit_storm() {
    // 10 000 voxels per second.
    passes(&[Kind::Edit], 60, &[("strokes", 60), ("voxels", 9_500)]);
}

#[test]
fn probes_survive_a_layout_storm() {
    passes(&[Kind::Layout], 60, &[("layouts", 4)]);
}

#[test]
fn pictures_survive_a_resize_storm() {
    passes(&[Kind::Resize], 60, &[("sizes", 10)]);
}

#[test]
fn light_survives_a_time_storm() {
    passes(&[Kind::Time], 60, &[("jumps", 3)]);
}

#[test]
fn drawing_survives_the_loss_of_its_device() {
    // The storm loses the device once more at the end.
    passes(&[Kind::Loss], 70, &[("losses", 2)]);
}

#[test]
fn a_soak_finds_no_leak() {
    passes(&[Kind::Soak], 120, &[("strokes", 4)]);
}

#[test]
fn all_storms_run_at_once() {
    passes(
        &Kind::ALL,
        66,
        &[
            ("strokes", 60),
            ("layouts", 3),
            ("sizes", 10),
            ("jumps", 3),
            ("losses", 2),
        ],
    );
}

/// Asserts that all checks in `by` find the planted fault, and no others but those in `and`.
fn finds(kinds: &[Kind], frames: u32, planted: Planted, by: &[&str], and: &[&str]) {
    let found = storm(kinds, frames, planted);
    let failed = failed(&found);
    let wanted: BTreeSet<&str> = by.iter().copied().collect();
    let allowed: BTreeSet<&str> = by.iter().chain(and).copied().collect();
    assert!(
        wanted.is_subset(&failed) && failed.is_subset(&allowed),
        "{planted:?}: {failed:?} of {:#?}",
        found.checks
    );
}

#[test]
fn an_edit_that_does_not_reach_the_gpu_is_found() {
    let light = ["light.flip", "light.mean_block", "light.worst_block"];
    let by = ["voxels.gpu_differs"];
    // The fresh pictures show the CPU's copy.
    finds(&[Kind::Edit], 10, Planted::EditOnCpuOnly, &by, &light);
}

#[test]
fn edits_that_a_new_device_forgets_are_found() {
    let by = ["voxels.gpu_differs", "loss.voxels.gpu_differs"];
    let kinds = [Kind::Edit, Kind::Loss];
    let found = storm(&kinds, 66, Planted::LostEdits);
    let failed = failed(&found);
    assert!(by.iter().all(|name| failed.contains(name)), "{failed:?}");
}

#[test]
fn stale_light_is_found() {
    let by = ["light.flip", "light.mean_block"];
    let and = ["light.worst_block"];
    finds(&[Kind::Time], 10, Planted::StaleLight, &by, &and);
}

#[test]
fn lamps_that_are_late_are_found() {
    finds(
        &[Kind::Time],
        10,
        Planted::LateLamps,
        &["time.lamps_differ"],
        &[],
    );
}

#[test]
fn a_leak_is_found_after_a_storm() {
    let by = ["memory.objects", "memory.adapter_bytes"];
    finds(&[Kind::Resize], 60, Planted::LeakedBuffer, &by, &[]);
}

#[test]
fn a_leak_is_found_while_it_grows() {
    let growth = ["soak.adapter_growth_bytes", "soak.object_growth"];
    let found = storm(&[Kind::Soak], 120, Planted::LeakedBuffer);
    let failed = failed(&found);
    assert!(
        growth.iter().all(|name| failed.contains(name)),
        "{failed:?}"
    );
}

#[test]
fn nan_is_found() {
    finds(
        &[Kind::Resize],
        4,
        Planted::NotANumber,
        &["light.not_finite"],
        &[],
    );
}

#[test]
fn what_the_device_refuses_is_found() {
    finds(
        &[Kind::Resize],
        4,
        Planted::InvalidCall,
        &["device.errors"],
        &[],
    );
}

#[test]
fn probes_that_are_not_replaced_are_found() {
    finds(
        &[Kind::Layout],
        10,
        Planted::KeptProbes,
        &["layout.pixels_differ"],
        &[],
    );
}

#[test]
fn a_seed_and_a_number_of_frames_repeat_a_storm() {
    let kinds = [Kind::Edit, Kind::Layout, Kind::Resize, Kind::Time];
    let once = storm(&kinds, 16, Planted::Nothing);
    let again = storm(&kinds, 16, Planted::Nothing);
    assert_eq!(once.changes, again.changes);
    assert_eq!(once.checks, again.checks);
}

#[test]
fn a_storm_that_is_stopped_says_so_and_judges_nothing() {
    let stop = AtomicBool::new(false);
    stop.store(true, Ordering::Relaxed);
    let found = stoppable(&[Kind::Edit], 1000, Planted::Nothing, &stop);
    assert!(!found.complete && found.checks.is_empty());
    assert_eq!(found.frames, 1);
}

#[test]
fn the_command_writes_records_and_refuses_what_makes_no_sense() {
    let folder = support::folder();
    let world = folder.path().join("room.ron");
    std::fs::write(&world, ROOM).expect("writable");
    let stress = |arguments: &[&str]| {
        let mut command = grotto();
        command
            .args([
                "stress",
                "--set",
                "probes.rays=8",
                "--set",
                "probes.final_gather=off",
            ])
            .args(arguments)
            .arg("--out")
            .arg(folder.path().join("out"))
            .arg(&world);
        output(&mut command)
    };
    let output = stress(&[
        "--edit-storm",
        "--resize-storm",
        "--storm-frames",
        "8",
        "--storm-settling",
        "8",
        "--storm-size",
        "32x24",
        "--seed",
        "3",
        "--json",
    ]);
    let stderr = String::from_utf8_lossy(&output.stderr);
    // Too few frames to settle: this test does not judge the light.
    let code = output.status.code();
    assert!(matches!(code, Some(0 | 4)), "{stderr}");
    let written = std::fs::read(folder.path().join("out/storms.json")).expect("it is there");
    let records: serde_json::Value = serde_json::from_slice(&written).expect("JSON");
    let printed: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(records, printed["storms"]);
    let record = &records[0];
    assert_eq!(record["storm"], "edit-storm+resize-storm");
    assert_eq!((&record["frames"], &record["seed"]), (&8.into(), &3.into()));
    assert_eq!(record["complete"], true);
    let repeat = record["repeat"].as_str().expect("a command");
    assert!(
        repeat.contains("--edit-storm --resize-storm --storm-frames 8"),
        "{repeat}"
    );
    for (wrong, said) in [
        (
            &["--edit-storm", "--storm-frames", "8"][..],
            "storms of another run",
        ),
        (&["--soak", "-1"], "minutes"),
        (&["--edit-storm", "--storm-minutes", "0"], "minutes"),
        (&["--edit-storm", "--storm-frames", "0"], "storm-frames"),
        (&["--edit-storm", "--storm-size", "0x9"], "WIDTHxHEIGHT"),
    ] {
        let output = stress(wrong);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{stderr}");
        assert!(stderr.contains(said), "{stderr}");
    }
}

#[test]
fn records_serialise() {
    // Readers of storms.json rely on these names.
    let keys = |record: &StormRecord| serde_json::to_value(record).expect("serialises");
    let record = StormRecord {
        storm: "time-storm".to_owned(),
        world: "room".to_owned(),
        seed: 1,
        frames: 2,
        settling: 3,
        size: [4, 5],
        complete: true,
        changes: Default::default(),
        checks: Vec::new(),
        repeat: String::new(),
        measured: Default::default(),
    };
    let value = keys(&record);
    for key in [
        "storm", "world", "seed", "frames", "complete", "checks", "repeat", "measured",
    ] {
        assert!(value.get(key).is_some(), "{key}");
    }
}
