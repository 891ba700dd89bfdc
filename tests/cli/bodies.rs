//! Bodies that a player lifts out of the world, pushes and sets into it, played from records; and in saves.

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    sync::Arc,
};

use glam::{UVec3, Vec3};
use grotto::world::{
    bodies::{BodyModel, ChangedBodies, PlacedBody},
    save::{self, Save},
};
use serde_json::{Value, json};

use crate::{
    folder,
    replay::{header, replayed, written},
    root,
    saves::save_of,
    support::binary::{end, grotto, output, text as text_of},
};

const MS: u64 = 1_000_000;

/// A room with a floor at y = −3 and walls at x and z = ±8. A pillar of 1 × 3 × 1 voxels stands before its middle.
const ROOM: &str = "(
    title: \"A room with a pillar.\",
    size: (24, 16, 24),
    origin: (-12, -8, -12),
    shape: Union([
        Subtraction([Box(half: (12, 8, 12)), Box(half: (8, 3, 8))]),
        Translate(by: (0.5, -1.5, -2.5), of: Box(half: (0.5, 1.5, 0.5))),
    ]),
    materials: {\"plaster\": (a: Flat(0.7, 0.7, 0.7))},
    sky: (zenith: (0, 0, 0)),
    layouts: [(name: \"few\", counts: (2, 2, 2), spacing: 12)],
)";

/// The record of a run in a room with these bodies, which begins before the pillar and looks at its foot.
fn record(folder: &Path, bodies: &str, end_ms: u64, inputs: &[(u64, Value)]) -> PathBuf {
    let world = folder.join("room.ron");
    let end = ROOM.rfind(')').expect("a world");
    fs::write(
        &world,
        format!("{}    bodies: [{bodies}],\n)", &ROOM[..end]),
    )
    .expect("writable");
    let mut header = header(&world, [0.5, -1.375, 0.5]);
    header["layout"] = json!("few");
    header["camera"]["yaw_deg"] = json!(0.0);
    header["camera"]["pitch_deg"] = json!(-20.0);
    let at = |(ms, inputs): &(u64, Value)| json!({"t": ms * MS + 3, "do": inputs});
    let mut moments: Vec<Value> = inputs.iter().map(at).collect();
    moments.push(json!({"t": end_ms * MS, "end": true}));
    written(folder, &header, &moments)
}

/// The figures of a run without other bodies.
fn played_at(fps: &str, end_ms: u64, inputs: &[(u64, Value)]) -> Value {
    let folder = folder();
    replayed(&record(folder.path(), "", end_ms, inputs), fps, "0").0
}

/// The figures of a run in a room with these bodies, and what it said, with the errors of its inputs.
fn told_with(bodies: &str, end_ms: u64, inputs: &[(u64, Value)]) -> (Value, String) {
    let folder = folder();
    let mut command = grotto();
    command.args(["play", "--json", "--fps", "10", "--every", "0"]);
    command
        .arg("--replay")
        .arg(record(folder.path(), bodies, end_ms, inputs));
    command.arg("--out").arg(folder.path().join("out"));
    command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY");
    let ended = end(&mut command);
    assert_eq!(ended.code, 0, "{}", ended.stderr);
    (ended.json(), ended.stderr)
}

/// Errors of inputs begin with the frame in which they came.
fn has_errors(told: &str) -> bool {
    told.contains("frame ")
}

/// Marks the pillar's foot, looks up to its top, and lifts what lies between.
fn lift() -> (u64, Value) {
    let inputs = json!([{"clip": "mark"}, {"look": [0.0, -390.0]}, {"clip": "lift"}]);
    (5, inputs)
}

#[test]
fn a_pillar_is_lifted_pushed_and_set_again_and_all_of_it_undone_at_any_frame_rate() {
    let plain = played_at("10", 100, &[]);
    assert_eq!(plain["bodies"], json!([]));
    let lifted = played_at("10", 100, &[lift()]);
    let body = &lifted["bodies"][0];
    assert_eq!(body["position"], json!([0.0, -3.0, -3.0]), "{lifted}");
    assert_eq!(body["size"], json!([1, 3, 1]));
    assert_ne!(lifted["voxels_crc32"], plain["voxels_crc32"]);

    let walk = (100, json!([{"press": "forward"}]));
    let stay = (1300, json!([{"release": "forward"}]));
    let pushed = |fps: &str| played_at(fps, 1500, &[lift(), walk.clone(), stay.clone()]);
    let slow = pushed("20");
    let at = slow["bodies"][0]["position"].as_array().expect("a place");
    let z = at[2].as_f64().expect("a number");
    assert!((-5.0..-3.5).contains(&z), "{slow}");
    assert_eq!((&at[0], &at[1]), (&json!(0.0), &json!(-3.0)));
    let fast = pushed("250");
    for key in ["bodies", "eye", "steps", "voxels_crc32"] {
        assert_eq!(slow[key], fast[key], "{key}");
    }

    let more = |inputs: Value| {
        let inputs = [lift(), walk.clone(), stay.clone(), (1400, inputs)];
        played_at("10", 1500, &inputs)
    };
    let settled = more(json!([{"clip": "settle"}]));
    assert_eq!(settled["bodies"], json!([]), "{settled}");
    assert_ne!(settled["voxels_crc32"], plain["voxels_crc32"]);
    assert_ne!(settled["voxels_crc32"], lifted["voxels_crc32"]);
    let unset = more(json!([{"clip": "settle"}, "undo"]));
    assert_eq!(unset["bodies"], slow["bodies"]);
    assert_eq!(unset["voxels_crc32"], lifted["voxels_crc32"]);
    let all_undone = more(json!([{"clip": "settle"}, "undo", "undo"]));
    assert_eq!(all_undone["bodies"], json!([]));
    assert_eq!(all_undone["voxels_crc32"], plain["voxels_crc32"]);
    let redone = more(json!([{"clip": "settle"}, "undo", "undo", "redo", "redo"]));
    assert_eq!(redone["voxels_crc32"], settled["voxels_crc32"]);
}

#[test]
fn an_undo_waits_until_no_body_is_in_the_way() {
    // The floor before the pillar, and with a ball of radius 1 the floor below it.
    let dig = json!([
        {"look": [0.0, 580.0]}, {"brush": {"shape": "ball", "radius": 1.0}}, {"stroke": "dig"},
    ]);
    let (fallen, told) = told_with("", 1500, &[lift(), (100, dig.clone())]);
    assert!(!has_errors(&told), "{told}");
    let at = &fallen["bodies"][0]["position"];
    assert_eq!(*at, json!([0.0, -4.0, -3.0]), "it fell into the hole");
    let undo = |times: usize| (1400, json!(vec!["undo"; times]));
    let (refused, told) = told_with("", 1500, &[lift(), (100, dig.clone()), undo(1)]);
    assert!(told.contains("A body is in the way"), "{told}");
    assert_eq!(refused["bodies"], fallen["bodies"]);
    assert_eq!(refused["voxels_crc32"], fallen["voxels_crc32"]);
    // Set into the world it is no longer in the way; that stroke is undone first.
    let set = (1200, json!([{"look": [0.0, -390.0]}, {"clip": "settle"}]));
    let (set_and_undone, told) = told_with("", 1500, &[lift(), (100, dig), set, undo(2)]);
    assert!(told.contains("A body is in the way"), "{told}");
    assert_eq!(set_and_undone["voxels_crc32"], fallen["voxels_crc32"]);
}

/// A slab that stands in the air before the pillar, at this angle, with this motion.
fn slab(degrees: f32, motion: &str) -> String {
    format!(
        "(name: \"slab\", model: Shape(size: (2, 3, 1), shape: Box(half: (1, 1.5, 0.5)), \
         material: \"plaster\"), position: (0.5, -1.25, -1.5), degrees: (0, {degrees}, 0), motion: [{motion}])"
    )
}

#[test]
fn strokes_stop_at_bodies_that_move_or_stand_at_an_angle() {
    let strokes = json!([{"stroke": "dig"}, {"clip": "mark"}, {"clip": "settle"}]);
    let untouched = told_with(&slab(0.0, ""), 100, &[]).0;
    let turns = "Turn(axis: (0, 0, 1), rate: 0.2)";
    for (degrees, motion) in [(0.0, ""), (30.0, ""), (0.0, turns)] {
        let strokes = match (degrees, motion) {
            // A free body would be set into the world.
            (0.0, "") => json!([{"stroke": "dig"}, {"clip": "mark"}]),
            _ => strokes.clone(),
        };
        let (figures, told) = told_with(&slab(degrees, motion), 100, &[(20, strokes)]);
        assert!(!has_errors(&told), "{told}");
        let same = (&figures["voxels_crc32"], &figures["bodies"]);
        let before = (&untouched["voxels_crc32"], &untouched["bodies"]);
        assert_eq!(same, before, "{degrees}°, {motion}");
    }
    let dug = told_with("", 100, &[(20, json!([{"stroke": "dig"}]))]).0;
    assert_ne!(dug["voxels_crc32"], untouched["voxels_crc32"], "the pillar");
}

#[test]
fn a_body_of_the_world_file_is_set_into_the_world_and_undone() {
    for degrees in [0.0, 90.0] {
        let slab = slab(degrees, "");
        let settle = (20, json!([{"clip": "settle"}]));
        let run = |more: &[(u64, Value)]| {
            let (figures, told) = told_with(&slab, 200, more);
            assert!(!has_errors(&told), "{told}");
            figures
        };
        let untouched = run(&[]);
        let set = run(std::slice::from_ref(&settle));
        assert_ne!(set["voxels_crc32"], untouched["voxels_crc32"]);
        let undone = run(&[settle.clone(), (50, json!(["undo"]))]);
        assert_eq!(undone["voxels_crc32"], untouched["voxels_crc32"]);
        let again = run(&[settle, (50, json!(["undo", {"clip": "settle"}]))]);
        assert_eq!(again["voxels_crc32"], set["voxels_crc32"], "it was back");
    }
}

#[test]
fn a_saved_body_is_seen_by_every_command_as_the_same_voxels() {
    let folder = folder();
    let file = |name: &str| folder.path().join(name);
    let text = fs::read_to_string(root().join(crate::MINIMAL)).expect("readable");
    fs::write(file("plain.ron"), text).expect("writable");
    let picture = |save: &Save, name: &str| {
        let path = file(name).with_extension("grotto");
        let mut save = save.clone();
        save.belongs_to(&file("plain.ron"), &path);
        save::write(&path, &save).expect("writable");
        let out = file(name).with_extension("exr");
        let mut command = grotto();
        command.args(["render", "--quiet", "--size", "64x36", "--frames", "2"]);
        command.args(["--camera", "front", "--view", "albedo"]);
        command.args(["--set", "picture.antialias=off"]);
        let ended = end(command.arg(&path).arg("-o").arg(&out));
        assert_eq!(ended.code, 0, "{}", ended.stderr);
        fs::read(out).expect("a picture")
    };
    let mut save = save_of(&file("any.grotto"), Default::default());
    save.state.set.clear();
    let without = picture(&save, "without");
    let size = UVec3::new(6, 5, 6);
    // In the air over the middle, at whole coordinates: as voxels of the grid, and as a body.
    let low = UVec3::new(30, 14, 40);
    let mut with_voxels = save.clone();
    for index in 0..size.element_product() {
        let offset = UVec3::new(index % 6, index / 6 % 5, index / 30);
        with_voxels.overlay.set(low + offset, 1);
    }
    let corner = low.as_vec3() + Vec3::from(save.state.origin.map(|axis| axis as f32));
    save.bodies = ChangedBodies {
        placed: vec![PlacedBody {
            name: "placed 1".into(),
            model: Arc::new(BodyModel {
                size,
                materials: vec![1; size.element_product() as usize],
            }),
            corner,
        }],
        ..Default::default()
    };
    save.head.bodies = 1;
    let as_body = picture(&save, "body");
    assert_ne!(as_body, without);
    // Colours of patterns count from the model's corner, so only a plain material could be compared to the bit.
    assert_ne!(picture(&with_voxels, "voxels"), without);
    let listed = end(grotto()
        .env(save::VARIABLE, folder.path())
        .args(["saves", "list"]));
    assert!(listed.stdout.contains(", 1 body\n"), "{}", listed.stdout);
}

/// Lifts what is ahead in a window of its own, walks against it, and ends the run. Each F2 writes a picture once all input
/// before it was taken.
const SESSION: &str = r#"
"$0" play "$@" &
window=$(xdotool search --sync --onlyvisible --name grotto | head -n 1)
xdotool windowfocus "$window"
xdotool mousemove --window "$window" 80 48
answered() {
    xdotool key F2
    for tenth in $(seq 1200); do ls *.png > /dev/null 2>&1 && break; sleep 0.1; done
    rm *.png
}
answered
xdotool click 1
xdotool key l
# The first lift comes a frame after its word.
answered
answered
xdotool keydown w
sleep 3
xdotool keyup w
answered
kill -TERM $!
wait $!
ls saves/*.grotto
"#;

#[test]
fn a_block_is_lifted_and_pushed_by_real_keys_and_is_in_the_save() {
    let folder = folder();
    let world = folder.path().join("room.ron");
    // A block before the middle, and a camera that looks at it.
    let room = ROOM.replace("Box(half: (0.5, 1.5, 0.5))", "Box(half: (0.5, 0.5, 0.5))");
    let room = room.replace("(0.5, -1.5, -2.5)", "(0.5, -2.5, -2.5)");
    let end = room.rfind(')').expect("a world");
    let camera = "(name: \"start\", position: (0.5, -1.375, 0.5), yaw_deg: 0, pitch_deg: -20)";
    let text = format!("{}    cameras: [{camera}],\n)", &room[..end]);
    fs::write(&world, text).expect("writable");
    let mut command = Command::new("xvfb-run");
    command
        .args(["--auto-servernum", "--server-args=-screen 0 640x480x24"])
        .args(["sh", "-c", SESSION])
        .arg(grotto().get_program())
        .arg(&world)
        .args([
            "--size",
            "160x96",
            "--quality",
            "low",
            "--set",
            "probes.rays=8",
        ])
        .current_dir(folder.path())
        .env("GROTTO_CONFIG", folder.path())
        .env("GROTTO_SAVES", folder.path().join("saves"))
        .env("RUST_LOG", "grotto=warn")
        .env_remove("WAYLAND_DISPLAY")
        .stdin(Stdio::null());
    let ended = output(&mut command);
    let told = text_of(&ended.stderr);
    assert!(
        ended.status.success() && !told.contains("panicked"),
        "{told}"
    );
    let saved = save::read(&folder.path().join("saves/room.grotto")).expect("a save");
    assert_eq!(
        saved.overlay.count(),
        1,
        "the block is no longer in the world"
    );
    assert_eq!(saved.bodies.placed.len(), 1);
    let Vec3 { x, y, z } = saved.bodies.placed[0].corner;
    assert_eq!((x, y), (0.0, -3.0));
    assert!((-8.0..-3.0).contains(&z), "{z}");
}
