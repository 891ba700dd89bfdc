//! Bodies that a player lifts out of the world, pushes and sets into it, played from records; and in saves.

use std::{fs, sync::Arc};

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
    support::binary::{end, grotto},
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
)";

/// The figures of a run that begins before the pillar and looks at its foot.
fn played_at(fps: &str, end_ms: u64, inputs: &[(u64, Value)]) -> Value {
    let folder = folder();
    let world = folder.path().join("room.ron");
    fs::write(&world, ROOM).expect("writable");
    let mut header = header(&world, [0.5, -1.375, 0.5]);
    header["camera"]["yaw_deg"] = json!(0.0);
    header["camera"]["pitch_deg"] = json!(-20.0);
    let at = |(ms, inputs): &(u64, Value)| json!({"t": ms * MS + 3, "do": inputs});
    let mut moments: Vec<Value> = inputs.iter().map(at).collect();
    moments.push(json!({"t": end_ms * MS, "end": true}));
    let record = written(folder.path(), &header, &moments);
    replayed(&record, fps, "0").0
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
    let fast = pushed("500");
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
        moved: Vec::new(),
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
