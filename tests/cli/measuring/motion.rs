//! `grotto judge --motion` on tiny pictures.

use std::fs;

use serde_json::Value;

use super::{
    Bench, FEW_FACES,
    judge::{CORNELL, SKIP},
    number, text,
};

const INSIDE: [&str; 5] = [CORNELL, "--camera", "inside", "--layout", "layout1"];
const MOVING: [&str; 2] = ["--set", "lights.preset=moving"];

/// The motions of the only row, by name.
fn motion<'j>(json: &'j Value, name: &str) -> &'j Value {
    let rows = json["rows"].as_array().expect("rows");
    assert_eq!(rows.len(), 1);
    let motions = rows[0]["motion"].as_array().expect("rows of motion");
    let found = motions.iter().find(|motion| motion["motion"] == name);
    found.unwrap_or_else(|| panic!("{name} in {json}"))
}

fn moments(motion: &Value) -> &[Value] {
    motion["moments"].as_array().expect("moments")
}

/// Mean FLIP of the moments after the start.
fn flip(motion: &Value) -> f64 {
    let later = moments(motion).iter().filter(|one| one["frame"] != 0);
    let flips: Vec<f64> = later.map(|one| number(one, "full.flip.mean")).collect();
    flips.iter().sum::<f64>() / flips.len() as f64
}

#[test]
fn every_motion_is_judged_at_every_moment() {
    let bench = Bench::new();
    let small = ["--size", "32x18", "--frames", "6", "--spp", "8"];
    let moved = ["--motion", "--edits", "--motion-frames", "24"];
    let times = ["--moments", "2", "--time", "1.5"];
    let flags = [
        &INSIDE[..],
        &SKIP,
        &MOVING,
        &FEW_FACES,
        &small,
        &moved,
        &times,
    ]
    .concat();
    let (json, said) = bench.judged(&flags);
    let names = ["rest", "lamps", "camera", "both", "edits"];
    let rows = json["rows"][0]["motion"].as_array().expect("motions");
    let found: Vec<&Value> = rows.iter().map(|row| &row["motion"]).collect();
    assert_eq!(found, names);
    for row in rows {
        let name = row["motion"].as_str().expect("a name");
        let moves = |what: &str| row["moves"][what] == true;
        let frames: Vec<u64> = moments(row)
            .iter()
            .filter_map(|moment| moment["frame"].as_u64())
            .collect();
        match name {
            "rest" => assert_eq!(frames, [0, 12, 24]),
            _ => assert_eq!(frames, [12, 24], "{name}"),
        }
        for moment in moments(row) {
            let flip = number(moment, "full.flip.mean");
            assert!(flip > 0.0 && flip < 0.4, "{name}: {moment}");
            assert!(number(moment, "full.rel_mse") > 0.0, "{name}");
            let energy = number(moment, "indirect.energy_ratio");
            assert!((0.5..1.7).contains(&energy), "{name}: {energy}");
            assert!(number(moment, "rest_flip") > 0.0, "{name}");
            let moved = number(moment, "frame") / 60.0;
            let time = if moves("lamps") { 1.5 + moved } else { 1.5 };
            assert!((number(moment, "time_s") - time).abs() < 1e-9, "{name}");
        }
        assert_eq!(row["over_rest"].is_number(), name != "rest", "{name}");
        assert!(said.contains(&format!("{name}: FLIP")), "{name}: {said}");
    }
    let edits = &rows[4]["moves"];
    assert_eq!([&edits["lamps"], &edits["camera"]], [true, true]);
    // One reference at rest, and two of each: lamps, lamps with edits.
    assert_eq!(bench.references().len(), 5);

    let written: Value = serde_json::from_str(&bench.result("judge.json")).expect("JSON");
    assert_eq!(written, json);
    let (page, markdown) = (bench.result("judge.html"), bench.result("judge.md"));
    for name in names {
        assert!(page.contains(&format!(">{name}</td>")), "{name}");
        assert!(markdown.contains(&format!("| {name} |")), "{name}");
    }
    // Three moments at rest; two of each of the four motions, and of their rest where the lamps move.
    assert_eq!(page.matches("<circle").count(), 3 + 2 * 4 + 2 * 3);
    assert!(page.contains("FLIP over time") && !page.contains("http"));

    // A second run takes all references from the cache, and gives the same figures.
    let (again, _) = bench.judged(&flags);
    assert_eq!(again["rows"], json["rows"]);
    assert_eq!(bench.references().len(), 5);

    // The table at rest is the same without the motions.
    let still = [&INSIDE[..], &SKIP, &MOVING, &FEW_FACES, &small, &times[2..]].concat();
    let (still, _) = bench.judged(&still);
    assert!(still["rows"][0]["motion"].is_null());
    assert_eq!(still["rows"][0]["full"], json["rows"][0]["full"]);
    let page = bench.result("judge.html");
    assert!(!page.contains("<svg") && !page.contains("over rest"));
}

#[test]
fn a_lamp_that_stands_still_is_at_rest() {
    let bench = Bench::new();
    let small = ["--size", "32x18", "--spp", "8"];
    let flags = [&INSIDE[..], &SKIP, &FEW_FACES, &small].concat();
    let short = ["--motion=lamps", "--motion-frames", "20", "--moments", "2"];
    let judged = |set: &[&str]| bench.judged(&[&flags[..], &short, set].concat()).0;
    let json = judged(&["--set", "lights.preset=one"]);
    let (rest, lamps) = (motion(&json, "rest"), motion(&json, "lamps"));
    for (still, moved) in moments(rest)[1..].iter().zip(moments(lamps)) {
        assert_eq!(still["full"], moved["full"]);
        assert_eq!(still["indirect"], moved["indirect"]);
        assert_eq!(moved["rest_flip"], still["full"]["flip"]["mean"]);
    }
    assert_eq!(lamps["over_rest"], 1.0);
    assert_eq!(bench.references().len(), 1, "nothing else is to be seen");
    let json = judged(&MOVING);
    assert_ne!(motion(&json, "lamps")["over_rest"], 1.0);
}

/// The planted fault: each moment is judged by the reference of another.
#[test]
fn the_reference_of_another_time_is_a_clear_error() {
    let bench = Bench::new();
    // The noise of fewer rays is small beside the light of another time.
    let few = ["--size", "32x18", "--set", "probes.face_share=0.25"];
    let flags = [&INSIDE[..], &SKIP, &MOVING, &few].concat();
    let moved = ["--motion-frames", "120", "--moments", "2", "--spp", "64"];
    let of = |motions| [&flags[..], &[motions], &moved].concat();
    let (right, _) = bench.judged(&of("--motion=lamps,camera"));
    let over_rest = |name| number(motion(&right, name), "over_rest");
    assert!(over_rest("lamps") < 1.4, "the lamps of DDGI move too");
    // The camera has moved, and is at its place.
    assert!((0.9..1.1).contains(&over_rest("camera")));
    let [moved, still] = ["camera", "rest"].map(|name| flip(motion(&right, name)));
    assert_ne!(moved, still, "other faces were seen");
    let kept = bench.references();
    assert_eq!(kept.len(), 3, "the start and two moments");
    let mut contents: Vec<Vec<u8>> = kept
        .iter()
        .map(|path| fs::read(path).expect("stored"))
        .collect();
    contents.rotate_left(1);
    for (path, content) in kept.iter().zip(&contents) {
        fs::write(path, content).expect("writable");
    }
    let (wrong, said) = bench.judged(&of("--motion=lamps"));
    assert!(!said.contains("traced again"), "{said}");
    let [right, wrong] = [&right, &wrong].map(|json| flip(motion(json, "lamps")));
    assert!(wrong > 1.3 * right, "{wrong} {right}");
}

/// Light that follows a lamp late is an error that the same moments at rest do not have.
#[test]
fn late_light_is_worse_in_motion_than_at_rest() {
    let bench = Bench::new();
    let flags = [&INSIDE[..], &SKIP, &MOVING, &["--size", "32x18"]].concat();
    let moved = ["--motion=lamps", "--motion-frames", "60", "--moments", "1"];
    let indirect = |late: &[&str]| {
        let late: Vec<&str> = late.iter().flat_map(|key| ["--set", key]).collect();
        let few = ["--frames", "60", "--spp", "64"];
        let (json, _) = bench.judged(&[&flags[..], &moved, &few, &late].concat());
        let lamps = motion(&json, "lamps");
        number(lamps, "over_rest")
    };
    let usual = indirect(&[]);
    let late = indirect(&[
        "probes.hysteresis=0.995",
        "probes.change_deviations=1000",
        "probes.final_gather=off",
    ]);
    assert!(late > 1.1 && late > usual, "{late} {usual}");
}

#[test]
fn contradictions_are_refused_before_any_work() {
    let bench = Bench::new();
    let still = ["--set", "lights.animate=off"];
    for (flags, parts) in [
        (&["--moments", "2"][..], &["--motion"][..]),
        (&["--motion-frames", "20"], &["--motion"]),
        (&["--edits"], &["--motion"]),
        (&["--motion=sometimes"], &["lamps, camera or both"]),
        (&["--motion=lamps,lamps"], &["`lamps` is there twice"]),
        (&["--motion", "--moments", "0"], &["1..=64"]),
        (
            &["--motion", "--motion-frames", "3"],
            &["--moments 4", "--motion-frames"],
        ),
        (
            &[&["--motion"][..], &still].concat(),
            &["lights.animate=off", "--motion=camera"],
        ),
        (&["--motion", "lamps"], &["--motion=lamps"]),
    ] {
        let output = bench.judge(&[&[CORNELL], flags].concat());
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{flags:?}: {said}");
        for part in parts {
            assert!(said.contains(part), "{flags:?}: no {part} in {said}");
        }
        assert_eq!(text(&output.stdout), "", "{flags:?}");
    }
    assert!(!bench.path("cache").exists(), "nothing was traced");
}
