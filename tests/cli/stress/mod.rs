//! `grotto stress --scenes` as a user runs it: scenes that pass, parts that make a whole, input that is refused, and
//! planted faults that checks must find.

use std::{
    fs,
    path::{Path, PathBuf},
};

use grotto::commands::stress::{
    checks::Check,
    grammar, merge,
    report::{Report, Row},
};

use crate::{FEW_FACE_RAYS, end, folder, grotto};

/// Exit code, stdout, stderr.
fn stress(out: &Path, arguments: &[&str]) -> (i32, String, String) {
    let ended = end(grotto().arg("stress").args(arguments).arg("--out").arg(out));
    (ended.code, ended.stdout, ended.stderr)
}

fn report(out: &Path) -> Report {
    Report::read(out).expect("a report")
}

/// The rows of one check.
fn rows(rows: &[Row], check: Check) -> Vec<&Row> {
    rows.iter().filter(|row| row.check == check).collect()
}

#[test]
fn twenty_five_scenes_have_no_unknown_failure() {
    let folder = folder();
    let (code, stdout, stderr) = stress(
        folder.path(),
        &["--scenes", "25", "--seed", "100", "--jobs", "2"],
    );
    assert_eq!(code, 0, "{stdout}\n{stderr}");
    let report = report(folder.path());
    assert!(report.complete && report.examined >= 25, "{report:?}");
    let judged = |check: Check| {
        report
            .checks
            .get(&check)
            .map_or(0, |count| count.passed + count.known)
    };
    for check in Check::ALL {
        // Not every scene can be compared with a reference; all other checks apply to all scenes.
        let least = if check == Check::Band { 5 } else { 25 };
        assert!(
            judged(check) >= least,
            "`{}` judged {} scenes",
            check.name(),
            judged(check)
        );
    }
}

/// Every file under a folder except the times, with its bytes.
fn files(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            found.extend(files(&path));
        } else if path.file_name().is_none_or(|name| name != "times.json") {
            let bytes = fs::read(&path).expect("a file");
            found.push((path, bytes));
        }
    }
    found.sort();
    found
}

#[test]
fn parts_make_the_whole_byte_for_byte() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    // With failures, whose files must be joined too.
    let scenes = [
        "--scenes",
        "3",
        "--seed",
        "17",
        "--plant",
        "order",
        "--tries",
        "0",
        "--set",
        FEW_FACE_RAYS,
    ];
    let run = |name: &str, more: &[&str]| {
        let (code, _, stderr) = stress(&at(name), &[&scenes, more].concat());
        assert_eq!(code, 4, "{stderr}");
    };
    run("whole", &[]);
    run("one", &["--shard", "1/2"]);
    run("two", &["--shard", "2/2"]);
    merge::join(&[at("two"), at("one")], &at("joined")).expect("two halves");
    let relative = |name: &str| -> Vec<(PathBuf, Vec<u8>)> {
        let all = files(&at(name)).into_iter();
        all.map(|(path, bytes)| {
            (
                path.strip_prefix(at(name)).expect("within").to_owned(),
                bytes,
            )
        })
        .collect()
    };
    let whole = relative("whole");
    assert!(
        whole.len() >= 4,
        "a report and three scenes that fail: {}",
        whole.len()
    );
    assert!(
        whole == relative("joined"),
        "{:#?}\n{:#?}",
        report(&at("whole")),
        report(&at("joined"))
    );
    let refused = |parts: &[&str], out: &str| {
        let parts: Vec<PathBuf> = parts.iter().map(|part| at(part)).collect();
        let failure = merge::join(&parts, &at(out)).expect_err("not a whole");
        assert_eq!(failure.exit_code(), 2);
        failure.to_string()
    };
    assert!(refused(&["one"], "a").contains("2/2 is missing"));
    assert!(refused(&["one", "two", "one"], "a").contains("1/2 is there 2 times"));
    assert!(refused(&["one", "two"], "whole").contains("another run"));
    assert!(refused(&["nowhere", "two"], "a").contains("nowhere"));
    fs::write(at("two").join("stress.json"), "{").expect("a file");
    assert!(refused(&["one", "two"], "a").contains("no report"));
}

#[test]
fn bad_input_is_refused_with_a_remedy() {
    let folder = folder();
    let held = folder.path().join("held");
    fs::create_dir_all(&held).expect("a folder");
    fs::write(held.join("stress.json"), "{}").expect("a file");
    let empty = folder.path().join("empty");
    for (out, arguments, parts) in [
        (&empty, &["--scenes", "0"][..], &["--scenes N"][..]),
        (&empty, &["--scenes", "1000000000"], &["1000000"]),
        (&empty, &["--scenes", "-1"], &["-1"]),
        (
            &empty,
            &["--scenes", "2", "--seed", "4294967295"],
            &["--seed 4294967295"],
        ),
        (&empty, &["--scenes", "2", "--shard", "3/2"], &["I/N"]),
        (&empty, &["--scenes", "2", "--jobs", "0"], &["--jobs"]),
        (
            &empty,
            &["--scenes", "2", "--set", "probes.ray=8"],
            &["probes.rays"],
        ),
        (&empty, &["--world", "nowhere.ron"], &["nowhere.ron"]),
        (&held, &["--scenes", "2"], &["held", "another run"]),
    ] {
        let (code, stdout, stderr) = stress(out, arguments);
        assert_eq!(code, 2, "{arguments:?}\n{stderr}");
        assert_eq!(stdout, "", "{arguments:?}");
        for part in parts {
            assert!(
                stderr.contains(part),
                "{arguments:?}: no `{part}` in\n{stderr}"
            );
        }
    }
}

/// The list of its emissive faces was not predicted.
#[test]
fn a_body_that_glows_takes_as_much_memory_as_is_predicted() {
    let folder = folder();
    let world = folder.path().join("glowing.ron");
    let text = "(
        title: \"A slab that glows.\", size: (1, 1, 1), shape: Box(half: (1, 1, 1)),
        materials: {\"glow\": (a: Flat(0, 0, 0), emission: (0, 0, 1))}, rules: [(material: \"glow\")],
        bodies: [(model: Shape(size: (31, 1, 31), shape: Box(half: (16, 1, 16))), position: (0, 0, 0))],
    )";
    fs::write(&world, text).expect("writable");
    let world = world.to_str().expect("UTF-8");
    let out = folder.path().join("out");
    let (code, stdout, stderr) = stress(&out, &["--world", world, "--tries", "0"]);
    assert_eq!(code, 0, "{stdout}\n{stderr}");
    let predicted = report(&out)
        .checks
        .get(&Check::Predicted)
        .map(|of| of.passed);
    assert_eq!(predicted, Some(1));
}

/// Plants a fault into a scene: the check must find it, and the scene must become simpler.
fn plant(fault: &str, seed: u32, check: Check) {
    let folder = folder();
    let number = seed.to_string();
    let arguments = [
        "--scenes",
        "1",
        "--seed",
        &number,
        "--plant",
        fault,
        "--tries",
        "6",
        "--set",
        FEW_FACE_RAYS,
    ];
    let (code, stdout, stderr) = stress(folder.path(), &arguments);
    assert_eq!(code, 4, "{fault} is not found\n{stdout}\n{stderr}");
    let report = report(folder.path());
    let found = rows(&report.failures, check);
    let [row] = found[..] else {
        panic!(
            "{fault}: no failure of `{}` in {:#?}",
            check.name(),
            report.failures
        );
    };
    let file = row.file.as_ref().expect("the scene is written");
    let text = fs::read_to_string(folder.path().join(file)).expect("the scene");
    let (first, _) = text.split_once('\n').expect("lines");
    assert_eq!(first.strip_prefix("// "), row.command.as_deref());
    assert!(first.contains("--world failures/") && first.contains(&format!("--seed {seed}")));
    let before = grammar::generate(seed).world.file();
    assert!(
        text.len() - first.len() < before.len(),
        "{fault}: the scene is no simpler\n{text}\n{before}"
    );
    // The file shows the fault again.
    let again = folder.path().join("again");
    let world = folder.path().join(file);
    let world = world.to_str().expect("UTF-8");
    let mut words: Vec<&str> = first
        .split(' ')
        .skip_while(|word| *word != "--seed")
        .collect();
    words.retain(|word| !["--out", "again"].contains(word));
    let (code, _, stderr) = stress(
        &again,
        &[&["--world", world, "--tries", "0"], &words[..]].concat(),
    );
    assert_eq!(code, 4, "{fault}: {stderr}");
    assert_eq!(
        rows(&self::report(&again).failures, check).len(),
        1,
        "{fault}"
    );
}

#[test]
fn a_planted_nan_is_found() {
    plant("nan", 19, Check::Finite);
}

#[test]
fn a_planted_leak_is_found() {
    plant("leak", 65, Check::Dark);
}

#[test]
fn a_planted_wrong_distance_is_found() {
    plant("distance", 3, Check::Distances);
}

#[test]
fn a_planted_buffer_that_stays_is_found() {
    plant("buffer", 19, Check::Memory);
}

#[test]
fn a_planted_slow_dispatch_is_found() {
    plant("slow", 19, Check::Dispatch);
}

#[test]
fn a_planted_order_is_found() {
    plant("order", 19, Check::Repeat);
}
