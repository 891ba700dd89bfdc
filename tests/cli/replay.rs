//! Records of runs, played without a window.

use std::{
    fs,
    path::{Path, PathBuf},
};

use serde_json::{Value, json};

use crate::{
    CAVE, MINIMAL, folder, root,
    support::binary::{FEW_FACE_RAYS, end, grotto, refused},
};

const MS: u64 = 1_000_000;

/// The eye of who stands on the ball of `minimal.ron`.
const ON_TOP: [f32; 3] = [0.0, 14.625, 0.0];

/// `minimal.ron` with few probes, which take most of the time of a frame on a software device.
fn with_few_probes(folder: &Path) -> PathBuf {
    let text = fs::read_to_string(root().join(MINIMAL)).expect("a world");
    let end = text.rfind(')').expect("a world");
    let layouts = "layouts: [(name: \"few\", counts: (2, 2, 2), spacing: 30, centre: (0, 8, 0))],";
    let path = folder.join("minimal.ron");
    fs::write(&path, format!("{}    {layouts}\n)\n", &text[..end])).expect("writable");
    path
}

/// A header for a run in such a world, from the top of its ball.
fn header_with_few_probes(folder: &Path) -> Value {
    let mut header = header(&with_few_probes(folder), ON_TOP);
    header["layout"] = json!("few");
    header
}

/// A header for a run in this world, from a place above its rock.
pub fn header(world: &Path, position: [f32; 3]) -> Value {
    let bytes = fs::read(root().join(world)).expect("a world");
    json!({
        "grotto_record": 2,
        "world": world,
        "world_crc32": crc32fast::hash(&bytes),
        "seed": 3,
        "layout": "auto",
        "set": ["probes.rays=8", FEW_FACE_RAYS],
        "size": [12, 8],
        "camera": {
            "name": "start", "position": position, "yaw_deg": 10.0, "pitch_deg": -40.0, "fov_deg": 70.0,
        },
    })
}

/// A second and a half of everything that a player does.
fn moments() -> Vec<Value> {
    let at = |ms: u64, inputs: Value| json!({"t": ms * MS + 7, "do": inputs});
    vec![
        at(0, json!([{"press": "forward"}, {"look": [13.0, -4.5]}])),
        at(100, json!([{"press": "up"}])),
        at(130, json!([{"release": "up"}])),
        at(210, json!([{"press": "up"}, {"release": "up"}])),
        at(
            300,
            json!([{"press": "run"}, {"fly_speed": 3.0}, {"look": [120.0, 300.0]}]),
        ),
        at(
            500,
            json!([{"stroke": "dig"}, {"brush": {"shape": "ball", "radius": 2.5}}]),
        ),
        at(
            600,
            json!([{"stroke": "dig"}, {"release": "run"}, {"press": "fly"}]),
        ),
        at(
            750,
            json!([{"stroke": "place"}, {"set": "probes.rays=16"}, {"resize": [8, 12]}]),
        ),
        at(
            900,
            json!([{"release": "forward"}, {"press": "no_clip"}, {"clock":
            {"paused": true, "rate": 0.5, "time_s": 3.25}}]),
        ),
        at(
            1000,
            json!([{"focus": false}, {"camera": 0}, {"camera": 99}, {"layout": "nowhere"}]),
        ),
        at(1200, json!([{"press": "back"}, {"stroke": "pick"}])),
        json!({"t": 1500 * MS, "end": true}),
    ]
}

pub fn written(folder: &Path, header: &Value, moments: &[Value]) -> PathBuf {
    let path = folder.join("run.record");
    let lines = std::iter::once(header).chain(moments);
    let text: String = lines.map(|line| format!("{line}\n")).collect();
    fs::write(&path, text).expect("writable");
    path
}

/// The figures of a replay at this frame rate, and the number of its pictures.
pub fn replayed(record: &Path, fps: &str, every: &str) -> (Value, usize) {
    let out = folder();
    let mut command = grotto();
    command.args(["play", "--json", "--quiet", "--fps", fps, "--every", every]);
    command
        .arg("--replay")
        .arg(record)
        .arg("--out")
        .arg(out.path());
    command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY");
    let ended = end(&mut command);
    assert_eq!(ended.code, 0, "{}", ended.stderr);
    assert_eq!(ended.stderr, "");
    let pictures = fs::read_dir(out.path()).expect("readable").count();
    (ended.json(), pictures)
}

#[test]
fn a_replay_is_the_same_run_at_any_frame_rate_and_shows_inputs_at_once() {
    let folder = folder();
    let header = header_with_few_probes(folder.path());
    let record = written(folder.path(), &header, &moments());
    let (slow, pictures) = replayed(&record, "20", "4");
    assert_eq!((&slow["frames"], pictures), (&json!(30), 7));
    let (fast, pictures) = replayed(&record, "130", "0");
    assert_eq!((&fast["frames"], pictures), (&json!(195), 0));
    for key in [
        "steps",
        "time_s",
        "eye",
        "yaw_deg",
        "pitch_deg",
        "voxels_crc32",
    ] {
        assert_eq!(slow[key], fast[key], "{key}");
    }
    assert_eq!(slow["steps"], 180);
    for figures in [&slow, &fast] {
        let latency = &figures["latency"];
        assert!(latency["inputs"].as_u64() > Some(4), "{latency}");
        assert!(latency["most_frames"].as_u64() <= Some(1), "{latency}");
        assert_eq!(latency["lost"], 0, "{latency}");
    }
    // Without its strokes it is another run.
    let idle: Vec<Value> = moments().split_off(moments().len() - 1);
    let idle = written(
        folder.path(),
        &header,
        &[vec![json!({"t": 700 * MS})], idle].concat(),
    );
    let (other, _) = replayed(&idle, "20", "0");
    assert_ne!(other["voxels_crc32"], slow["voxels_crc32"]);
    assert_ne!(other["eye"], slow["eye"]);
}

/// What is heard in a replay of these moments, as the bytes of a sound file.
fn heard(moments: &[Value]) -> Vec<u8> {
    let folder = folder();
    let header = header_with_few_probes(folder.path());
    let record = written(folder.path(), &header, moments);
    let sound = folder.path().join("run.wav");
    let mut command = grotto();
    command.args(["play", "--quiet", "--fps", "10", "--every", "0"]);
    command
        .arg("--replay")
        .arg(&record)
        .arg("--sound")
        .arg(&sound);
    command.arg("--out").arg(folder.path());
    let ended = end(&mut command);
    assert_eq!(ended.code, 0, "{}", ended.stderr);
    fs::read(sound).expect("it was written")
}

#[test]
fn a_replay_writes_what_is_heard_the_same_to_the_bit() {
    let run = |dig: &str| {
        let moments = [
            json!({"t": 0, "do": [{"look": [0.0, 400.0]}]}),
            json!({"t": 500 * MS, "do": [{"stroke": dig}]}),
            json!({"t": 1000 * MS, "end": true}),
        ];
        heard(&moments)
    };
    let dug = run("dig");
    assert_eq!(dug, run("dig"));
    // One second of two channels of 16 bits, after a head of 44 bytes.
    assert_eq!(dug.len(), 44 + 48_000 * 4);
    let loudest = |wav: &[u8], from_ms: usize, to_ms: usize| {
        let samples = wav[44 + from_ms * 192..44 + to_ms * 192].chunks(2);
        let sizes = samples.map(|pair| i16::from_le_bytes([pair[0], pair[1]]).unsigned_abs());
        sizes.max().expect("samples")
    };
    // The open sky above: wind. The stroke is heard when it is made.
    let wind = loudest(&dug, 300, 500);
    assert!(wind > 10, "{wind}");
    assert!(loudest(&dug, 500, 600) > 4 * wind, "{wind}");
    let picked = run("pick");
    assert!(
        loudest(&picked, 500, 600) < 2 * wind,
        "a look makes no noise"
    );
    assert_eq!(picked[44..44 + 490 * 192], dug[44..44 + 490 * 192]);
}

/// The voxels at the end of a run of these moments, looked straight down from the top of the ball.
fn voxels_after(inputs: &[(u64, Value)], fps: &str) -> Value {
    let folder = folder();
    let mut header = header_with_few_probes(folder.path());
    header["camera"]["pitch_deg"] = json!(-89.0);
    let mut moments: Vec<Value> = inputs
        .iter()
        .map(|(ms, inputs)| json!({"t": ms * MS + 3, "do": inputs}))
        .collect();
    moments.push(json!({"t": 1900 * MS, "end": true}));
    let record = written(folder.path(), &header, &moments);
    replayed(&record, fps, "0").0["voxels_crc32"].clone()
}

#[test]
fn a_held_button_digs_the_same_shaft_at_any_frame_rate_and_every_stroke_is_undone() {
    let untouched = voxels_after(&[(5, json!(["undo", "redo"]))], "20");
    let once = voxels_after(&[(5, json!([{"stroke": "dig"}]))], "20");
    assert_ne!(once, untouched);
    // After the first stroke, strokes follow at 305, 505, … 1305 ms: three of them meet voxels within reach.
    let held = |end: Value| {
        vec![
            (5, json!([{"hold": "dig"}])),
            (1400, json!([{"let_go": "place"}, {"let_go": "dig"}])),
            (1500, end),
        ]
    };
    let dug = voxels_after(&held(json!([])), "20");
    assert!(dug != once && dug != untouched);
    assert_eq!(voxels_after(&held(json!([])), "130"), dug);
    let undo = json!(["undo", "undo", "undo"]);
    assert_eq!(voxels_after(&held(undo.clone()), "20"), once);
    let more = json!([
        "undo", "undo", "undo", "undo", "undo", "undo", "undo", "undo"
    ]);
    assert_eq!(voxels_after(&held(more.clone()), "20"), untouched);
    let mut back = held(more);
    let redo = json!(["redo", "redo", "redo", "redo", "redo", "redo", "redo"]);
    back.push((1600, redo));
    assert_eq!(voxels_after(&back, "20"), dug);
    // Focus lost in between ends it.
    let lost = [
        (5, json!([{"hold": "dig"}])),
        (50, json!([{"focus": false}])),
    ];
    assert_eq!(voxels_after(&lost, "20"), once);
}

#[test]
fn a_copy_is_pasted_and_undone() {
    let dig = (5, json!([{"stroke": "dig"}]));
    let untouched = voxels_after(&[(5, json!([]))], "20");
    let once = voxels_after(std::slice::from_ref(&dig), "20");
    // The voxel below the hole is copied, and pasted on top of itself: the hole is filled.
    let copy = ["mark", "mark", "cancel", "paste"].map(|clip| json!({"clip": clip}));
    let copied = [dig.clone(), (20, json!(copy))];
    assert_eq!(
        voxels_after(&copied, "20"),
        once,
        "it is only taken out again"
    );
    let paste = (40, json!([{"clip": "turn"}, {"clip": "paste"}]));
    let pasted = [&copied[..], &[paste]].concat();
    for fps in ["20", "130"] {
        assert_eq!(voxels_after(&pasted, fps), untouched);
    }
    let undone = [&pasted[..], &[(60, json!(["undo"]))]].concat();
    assert_eq!(voxels_after(&undone, "20"), once);
    let redone = [&undone[..], &[(70, json!(["redo"]))]].concat();
    assert_eq!(voxels_after(&redone, "20"), untouched);
}

#[test]
fn bits_fly_in_a_replay_in_the_same_way_each_time() {
    let folder = folder();
    let mut header = header(Path::new(MINIMAL), ON_TOP);
    header["camera"]["pitch_deg"] = json!(-70.0);
    header["size"] = json!([48, 32]);
    let run = |inputs: Value| {
        let moments = [
            json!({"t": 50 * MS + 3, "do": inputs}),
            json!({"t": 300 * MS, "end": true}),
        ];
        let record = written(folder.path(), &header, &moments);
        let out = crate::folder();
        let mut command = grotto();
        command.args(["play", "--quiet", "--fps", "20", "--replay"]);
        command.arg(&record).arg("--out").arg(out.path());
        let ended = end(&mut command);
        assert_eq!(ended.code, 0, "{}", ended.stderr);
        let mut pictures: Vec<PathBuf> = fs::read_dir(out.path())
            .expect("readable")
            .map(|entry| entry.expect("an entry").path())
            .collect();
        pictures.sort();
        pictures
            .iter()
            .map(|path| fs::read(path).expect("readable"))
            .collect::<Vec<_>>()
    };
    let dug = run(json!([{"stroke": "dig"}]));
    assert_eq!(dug, run(json!([{"stroke": "dig"}])));
    assert!(dug.len() == 6 && dug[3] != dug[4], "they fly on");
}

#[test]
fn worlds_of_nothing_but_stone_or_air_are_played() {
    let folder = folder();
    for shape in ["Box(half: (99, 99, 99))", "Empty"] {
        let world = folder.path().join("world.ron");
        let text = format!("(title: \"T.\", size: (16, 16, 16), shape: {shape})");
        fs::write(&world, text).expect("writable");
        let record = written(folder.path(), &header(&world, [8.0, 8.0, 8.0]), &moments());
        let (figures, _) = replayed(&record, "20", "0");
        assert_eq!(figures["steps"], 180, "{shape}");
    }
}

#[test]
fn a_record_without_its_end_is_played_as_far_as_it_goes() {
    let folder = folder();
    let header = header(Path::new(MINIMAL), ON_TOP);
    let record = written(folder.path(), &header, &moments()[..3]);
    let mut command = grotto();
    command.args(["play", "--fps", "10", "--every", "0", "--replay"]);
    command
        .arg(&record)
        .arg("--out")
        .arg(folder.path().join("out"));
    let ended = end(&mut command);
    assert_eq!(ended.code, 0, "{}", ended.stderr);
    assert!(ended.stderr.contains("run.record:4: "), "{}", ended.stderr);
    assert!(
        ended.stdout.starts_with("2 frames, 15 steps, 0.13 s"),
        "{}",
        ended.stdout
    );
}

#[test]
fn bad_records_and_flags_are_refused_with_their_place() {
    let folder = folder();
    let sound = header(Path::new(MINIMAL), ON_TOP);
    let refuse = |header: &Value, moments: &[Value], more: &[&str], parts: &[&str]| {
        let record = written(folder.path(), header, moments);
        let mut command = grotto();
        command.arg("play").args(more).arg("--replay").arg(record);
        command.arg("--out").arg(folder.path().join("out"));
        refused(&mut command, 2, parts);
    };
    let with = |key: &str, value: Value| {
        let mut header = sound.clone();
        header[key] = value;
        header
    };
    let end = &moments()[11..];
    refuse(
        &with("grotto_record", json!(3)),
        end,
        &[],
        &["run.record:1: ", "version 3"],
    );
    refuse(
        &with("world_crc32", json!(5)),
        end,
        &[],
        &["run.record:1: ", "another version", "grotto play WORLD"],
    );
    refuse(
        &sound,
        end,
        &[CAVE],
        &["another version of worlds/cave.ron"],
    );
    refuse(
        &with("world", json!("worlds/gone.ron")),
        end,
        &[],
        &["worlds/gone.ron"],
    );
    refuse(
        &with("layout", json!("gone")),
        end,
        &[],
        &["no layout called `gone`"],
    );
    refuse(
        &sound,
        &[json!({"t": 0, "do": [{"jump": 3}]})],
        &[],
        &["run.record:2: ", "jump"],
    );
    refuse(&sound, &[], &[], &["run.record:2: "]);
    refuse(&sound, end, &["--seed", "3"], &["--seed"]);
    refuse(&sound, end, &["--fps", "0"], &["--fps"]);
    let nowhere = folder.path().join("no/run.record");
    for (flag, parts) in [
        ("--replay", ["no/run.record", "no such file"]),
        ("--record", ["no/run.record", "folder"]),
    ] {
        refused(grotto().args(["play", flag]).arg(&nowhere), 2, &parts);
    }
    refused(grotto().args(["play", "--out", "x"]), 2, &["--replay"]);
}
