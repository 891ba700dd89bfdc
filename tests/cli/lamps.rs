//! Lamps that a player places, played from records, and in saves.

use std::{fs, path::Path};

use grotto::world::save::{self, Save};
use serde_json::{Value, json};

use crate::{
    folder,
    replay::{header, replayed, written},
    root,
    saves::{save_of, tower},
    support::binary::{end, grotto},
};

const MS: u64 = 1_000_000;

/// A dark room with a floor at y = −3.
const ROOM: &str = "(
    title: \"A dark room.\",
    size: (24, 16, 24),
    origin: (-12, -8, -12),
    shape: Subtraction([Box(half: (12, 8, 12)), Box(half: (5, 3, 5))]),
    materials: {\"plaster\": (a: Flat(0.7, 0.7, 0.7))},
    sky: (zenith: (0, 0, 0)),
    layouts: [(name: \"few\", counts: (2, 2, 2), spacing: 10)],
)";

/// The figures of a run in the dark room, looking down to the floor.
fn played_at(fps: &str, inputs: &[(u64, Value)]) -> Value {
    let folder = folder();
    let world = folder.path().join("room.ron");
    fs::write(&world, ROOM).expect("writable");
    let mut header = header(&world, [0.5, -1.375, 0.5]);
    header["layout"] = json!("few");
    header["camera"]["yaw_deg"] = json!(0.0);
    let mut moments: Vec<Value> = inputs
        .iter()
        .map(|(ms, inputs)| json!({"t": ms * MS + 3, "do": inputs}))
        .collect();
    moments.push(json!({"t": 1000 * MS, "end": true}));
    let record = written(folder.path(), &header, &moments);
    replayed(&record, fps, "0").0
}

fn played(inputs: &[(u64, Value)]) -> Value {
    played_at("10", inputs)
}

/// A press of a button, and its release.
fn click(stroke: &str) -> Value {
    json!([{"hold": stroke}, {"let_go": stroke}])
}

/// Selects the slot of the first lamp, and hangs it.
const LAMP_SLOT: usize = 7;
fn hang() -> (u64, Value) {
    (
        5,
        json!([{"slot": LAMP_SLOT}, {"hold": "place"}, {"let_go": "place"}]),
    )
}

#[test]
fn lamps_are_placed_switched_dug_and_undone_at_any_frame_rate() {
    let dark = played(&[]);
    assert_eq!(dark["lamps"], json!([]));
    let hung = played(&[hang()]);
    let lamp = &hung["lamps"][0];
    assert_eq!(lamp["voxel"], json!([0, -3, -2]), "{hung}");
    assert_eq!(
        (&lamp["towards"], &lamp["is_on"]),
        (&json!([0, 1, 0]), &json!(true))
    );
    assert_eq!(lamp["block"]["colour"], "warm");
    assert_eq!(hung["voxels_crc32"], dark["voxels_crc32"]);

    // A held button neither hangs a second one nor switches the first.
    let held = [
        (5, json!([{"slot": LAMP_SLOT}, {"hold": "place"}])),
        (950, json!([{"let_go": "place"}])),
    ];
    assert_eq!(played(&held)["lamps"], hung["lamps"]);

    // The second press switches it off, the third on again; with a material in the hand, too.
    let off = played(&[hang(), (100, click("place"))]);
    assert_eq!(off["lamps"][0]["is_on"], false);
    let on = [
        hang(),
        (
            100,
            json!([{"slot": 0}, {"hold": "place"}, {"let_go": "place"}]),
        ),
        (200, click("place")),
    ];
    let on = played(&on);
    assert_eq!(on["lamps"], hung["lamps"]);
    assert_eq!(on["voxels_crc32"], dark["voxels_crc32"]);

    let dug = [hang(), (100, click("place")), (200, click("dig"))];
    let after = |more: Value| played(&[&dug[..], &[(300, more)]].concat());
    let gone = after(json!([]));
    assert_eq!(gone["lamps"], json!([]));
    assert_eq!(gone["voxels_crc32"], dark["voxels_crc32"]);
    assert_eq!(after(json!(["undo", "undo"]))["lamps"], hung["lamps"]);
    let redone = json!(["undo", "undo", "undo", "undo", "redo", "redo"]);
    assert_eq!(after(redone.clone())["lamps"], off["lamps"]);
    let fast = played_at("130", &[&dug[..], &[(300, redone)]].concat());
    assert_eq!(fast["lamps"], off["lamps"]);
}

#[test]
fn a_lamp_is_picked_and_another_made_for_the_hand() {
    let spot = json!({"lamp": {
        "form": "spot", "colour": "green", "power": 321.5, "radius": 0.1, "soft_radius": 0.5, "motion": "pulse",
    }});
    let picked = played(&[
        (5, json!([{"item": {"slot": 3, "item": spot}}, {"slot": 3}])),
        (50, click("place")),
        (
            100,
            json!([{"slot": 0}, {"stroke": "pick"}, {"stroke": "dig"}]),
        ),
        (150, json!([{"look": [0.0, -60.0]}])),
        (200, click("place")),
    ]);
    let lamps = picked["lamps"].as_array().expect("a list");
    assert_eq!(lamps.len(), 1);
    assert_eq!(lamps[0]["block"], spot["lamp"]);
    // The wheel goes round: three slots left of the first is the first lamp's.
    let scrolled = played(&[(5, json!([{"scroll": -3}])), (50, click("place"))]);
    assert_eq!(scrolled["lamps"][0]["block"]["colour"], "warm");
    // An empty slot and a material that the world lacks place nothing.
    let empty = played(&[
        (
            5,
            json!([{"slot": 5}, {"item": {"slot": 5, "item": {"material": 9}}}]),
        ),
        (50, click("place")),
    ]);
    assert_eq!(empty["voxels_crc32"], played(&[])["voxels_crc32"]);
}

#[test]
fn voxels_are_not_placed_into_a_lamp() {
    let ball = json!([{"slot": 0}, {"brush": {"shape": "ball", "radius": 2.0}}, {"look": [0.0, 150.0]},
                      {"hold": "place"}, {"let_go": "place"}]);
    let around = played(&[hang(), (100, ball.clone())]);
    let whole = played(&[(100, ball)]);
    assert_eq!(around["lamps"].as_array().map(Vec::len), Some(1));
    assert_ne!(around["voxels_crc32"], played(&[])["voxels_crc32"]);
    assert_ne!(around["voxels_crc32"], whole["voxels_crc32"]);
}

#[test]
fn records_with_items_that_cannot_be_are_refused() {
    let folder = folder();
    let header = header(Path::new(crate::MINIMAL), [0.0, 14.625, 0.0]);
    let bright = json!({"lamp": {
        "form": "point", "colour": "white", "power": 1e30, "radius": 0.25, "motion": "still",
    }});
    let large = json!({"lamp": {
        "form": "point", "colour": "white", "power": 100.0, "radius": 0.25, "soft_radius": 9.0, "motion": "still",
    }});
    for input in [
        json!({"slot": 10}),
        json!({"item": {"slot": 10, "item": {"material": 1}}}),
        json!({"item": {"slot": 1, "item": bright}}),
        json!({"item": {"slot": 1, "item": large}}),
        json!({"brush": {"material": 1, "radius": 1.0}}),
    ] {
        let moments = [json!({"t": 0, "do": [input]}), json!({"t": 1, "end": true})];
        let record = written(folder.path(), &header, &moments);
        let mut command = grotto();
        command.args(["play", "--out", "x", "--replay"]).arg(record);
        crate::refused(&mut command, 2, &["run.record:2: "]);
    }
}

#[test]
fn a_saved_lamp_shines_in_every_command_as_one_of_the_world_file() {
    let folder = folder();
    let file = |name: &str| folder.path().join(name);
    // Without the sun, which would come between the lamps.
    let text = fs::read_to_string(root().join(crate::MINIMAL)).expect("readable");
    let lines = text.lines().filter(|line| !line.trim().starts_with("sun:"));
    let dark = lines.collect::<Vec<_>>().join("\n");
    let lamps = "lamps: [(name: \"own\", lamps: [
        (position: (8.5, 4.5, 12.5), colour: (0.1, 0.85, 1), power: 900, radius: 0.25)])],";
    let own = dark.replacen("sky:", &format!("{lamps}\nsky:"), 1);
    assert!(dark.len() < text.len() && own.len() > dark.len());
    fs::write(file("dark.ron"), dark).expect("writable");
    fs::write(file("own.ron"), own).expect("writable");
    let picture = |world: &str, save: &Save, name: &str| {
        let path = file(name).with_extension("grotto");
        let mut save = save.clone();
        save.belongs_to(&file(world), &path);
        save::write(&path, &save).expect("writable");
        let out = file(name).with_extension("exr");
        let mut command = grotto();
        command.args(["render", "--quiet", "--size", "64x36", "--frames", "2"]);
        command.args([
            "--camera",
            "front",
            "--view",
            "direct",
            "--set",
            "picture.antialias=off",
        ]);
        let ended = end(command.arg(&path).arg("-o").arg(&out));
        assert_eq!(ended.code, 0, "{}", ended.stderr);
        fs::read(out).expect("a picture")
    };
    let mut save = save_of(&file("any.grotto"), tower());
    save.state.set.clear();
    let unlit = picture("dark.ron", &save, "unlit");
    let of_file = picture("own.ron", &save, "file");
    assert_ne!(unlit, of_file);
    let bare = save.clone();
    let lamp = json!({
        "voxel": [8, 4, 12], "towards": [0, 1, 0], "is_on": true,
        "block": {"form": "point", "colour": "cyan", "power": 900.0, "radius": 0.25, "motion": "still"},
    });
    save.lamps = vec![serde_json::from_value(lamp).expect("a lamp")];
    save.head.lamps = 1;
    assert_eq!(picture("dark.ron", &save, "placed"), of_file);
    let mut soft = save.clone();
    soft.lamps[0].block.soft_radius = 1.0;
    let own = fs::read_to_string(file("own.ron")).expect("readable");
    let sphere = own.replacen("radius: 0.25", "radius: 0.25, soft_radius: 1", 1);
    fs::write(file("sphere.ron"), sphere).expect("writable");
    let of_sphere = picture("sphere.ron", &bare, "sphere");
    assert_ne!(of_sphere, of_file);
    assert_eq!(picture("dark.ron", &soft, "soft"), of_sphere);
    save.lamps[0].is_on = false;
    assert_eq!(picture("dark.ron", &save, "off"), unlit);
    let listed = end(grotto()
        .env(save::VARIABLE, folder.path())
        .args(["saves", "list"]));
    assert!(
        listed.stdout.contains("72 voxels changed, 1 lamp\n"),
        "{}",
        listed.stdout
    );
}
