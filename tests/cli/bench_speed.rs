//! The suites of `grotto bench` that time frames: all rows exist and add up, in tiny pictures.

use std::{fs, io::Read as _, path::Path};

use serde_json::Value;

use crate::{Ended, FEW_FACE_RAYS, MINIMAL, end, folder, grotto, refused, root};

/// The shortest possible run of a suite.
fn tiny(suite: &[&str], more: &[&str]) -> Ended {
    let mut command = grotto();
    command.arg("bench").args(suite);
    command.args(["--size", "32x18", "--frames", "2", "--measured", "12"]);
    command.args(["--json", "--quiet", "--set", "probes.rays=8"]);
    command.args(["--set", FEW_FACE_RAYS]);
    let ended = end(command.args(more));
    assert_eq!(ended.code, 0, "{}", ended.stderr);
    ended
}

fn rows(report: &Value) -> &Vec<Value> {
    report["rows"].as_array().expect("an array of rows")
}

fn number(value: &Value) -> f64 {
    value
        .as_f64()
        .unwrap_or_else(|| panic!("{value} is no number"))
}

/// Asserts what holds in every row of frames on every machine.
fn adds_up(row: &Value, runs: u32) {
    let id = &row["id"];
    assert!(number(&row["fps"]) > 0.0, "{id}");
    let frame = &row["frame_ms"];
    // Every seventh frame is timed pass by pass; a software adapter does not separate those from the others.
    let of_each = number(&frame["count"]) / f64::from(runs);
    assert!((9.0..=12.0).contains(&of_each), "{id}: {of_each}");
    let order = ["median", "p95", "p99", "p999", "worst"].map(|name| number(&frame[name]));
    assert!(order.is_sorted(), "{id}: {order:?}");
    assert!((number(&row["fps"]) * order[0] - 1e3).abs() < 1e-6, "{id}");
    assert!(
        number(&frame["low1_fps"]) <= number(&row["fps"]) + 1e-9,
        "{id}"
    );
    let timing = &row["timing"];
    assert_eq!(
        timing["runs_ms"].as_array().map(Vec::len),
        Some(runs as usize)
    );
    let bars = timing["histogram"].as_array().expect("bars").iter();
    let counted: f64 = bars.map(number).sum();
    assert_eq!(counted, number(&frame["count"]), "{id}");
    let passes = row["passes"].as_object().expect("passes");
    for pass in [
        "view/camera_rays",
        "probes/trace",
        "probes/blend",
        "view/shade",
    ] {
        assert!(passes.contains_key(pass), "{id}: no {pass}");
    }
    let probes = &row["probes"];
    let states = ["alive", "sleeping", "dead"].map(|state| number(&probes[state]));
    assert_eq!(states.iter().sum::<f64>(), number(&probes["total"]), "{id}");
    let memory = &row["memory_bytes"];
    let parts = number(&memory["voxels"]) + number(&memory["probes"]);
    assert!(parts < number(&memory["total"]), "{id}");
    assert_eq!(number(&row["rays"]["camera"]), 32.0 * 18.0, "{id}");
}

#[test]
fn layouts_have_a_row_for_every_condition_and_the_files_say_the_same() {
    let folder = folder();
    let out = folder.path().join("new");
    let out_text = out.to_str().expect("UTF-8");
    let ended = tiny(
        &["layouts", "worlds/cornell.ron", "--layout", "layout1"],
        &["--runs", "2", "--out", out_text],
    );
    let report = ended.json();
    assert_eq!(report["kind"], "grotto bench");
    assert_eq!(report["complete"], true);
    let ids: Vec<&str> = rows(&report)
        .iter()
        .map(|row| row["id"].as_str().expect("a name"))
        .collect();
    let expected = ["still", "moving", "flight", "edits"]
        .map(|condition| format!("layouts/cornell/layout1/{condition}"));
    assert_eq!(ids, expected);
    for row in rows(&report) {
        adds_up(row, 2);
        assert_eq!(row["clock"], row["clock"].as_str().expect("a clock"));
        assert_eq!(row["set"][0], "probes.rays=8");
    }
    let written = fs::read_to_string(out.join("bench.json")).expect("the report");
    let written: Value = serde_json::from_str(&written).expect("JSON");
    assert_eq!(written, report);
    for name in ["rows.csv", "index.html"] {
        let text = fs::read_to_string(out.join(name)).expect(name);
        assert!(text.contains("layouts/cornell/layout1/edits"), "{name}");
    }
    // Four rows, two runs, twelve frames, one header.
    assert_eq!(frames(&out).lines().count(), 4 * 2 * 12 + 1);

    let again = ["bench", "layouts", MINIMAL, "--out", out_text];
    refused(grotto().args(again), 2, &["already holds", "--overwrite"]);
}

/// Rows with edits draw a world of their own; they showed every pixel once.
#[test]
fn all_conditions_draw_as_few_pixels_as_asked() {
    let ended = tiny(
        &["layouts", MINIMAL],
        &["--runs", "1", "--set", "picture.scale=0.5"],
    );
    let report = ended.json();
    assert_eq!(rows(&report).len(), 4);
    for row in rows(&report) {
        let passes = row["passes"].as_object().expect("passes");
        assert!(passes.contains_key("view/antialias"), "{}", row["id"]);
    }
}

/// Rows are as players see them, and are not taken for those that are not.
#[test]
fn displayed_rows_are_anti_aliased_and_say_so() {
    let names = |more: &[&str]| -> Vec<(String, bool)> {
        let ended = tiny(&["layouts", MINIMAL], &[&["--runs", "1"], more].concat());
        let report = ended.json();
        let of = |row: &Value| {
            let passes = row["passes"].as_object().expect("passes");
            let id = row["id"].as_str().expect("a name").to_owned();
            (id, passes.contains_key("view/antialias"))
        };
        rows(&report).iter().map(of).collect()
    };
    let usual = names(&[]);
    assert!(
        usual.iter().all(|(_, antialiased)| !antialiased),
        "{usual:?}"
    );
    let displayed = names(&["--displayed"]);
    let expected: Vec<_> = usual
        .iter()
        .map(|(id, _)| (format!("{id}/displayed"), true))
        .collect();
    assert_eq!(displayed, expected);
    let contradiction = [
        "layouts",
        MINIMAL,
        "--displayed",
        "--set",
        "picture.antialias=off",
    ];
    refused(
        grotto().arg("bench").args(contradiction),
        2,
        &["--displayed", "picture.antialias=off"],
    );
}

/// The log of every frame.
fn frames(folder: &Path) -> String {
    let file = fs::File::open(folder.join("frames.csv.gz")).expect("the log");
    let mut text = String::new();
    flate2::read::MultiGzDecoder::new(file)
        .read_to_string(&mut text)
        .expect("a valid gzip file");
    text
}

/// `cornell.ron` whose lattices have fewer probes, which take most of the time of a frame on a software device.
fn with_few_probes(folder: &Path) -> String {
    let text = fs::read_to_string(root().join("worlds/cornell.ron")).expect("a world");
    let few = text
        .replace(
            "counts: (5, 5, 5), spacing: 6",
            "counts: (3, 3, 2), spacing: 11",
        )
        .replace(
            "counts: (7, 7, 7), spacing: 4",
            "counts: (4, 3, 3), spacing: 8",
        )
        .replace(
            "counts: (11, 11, 11), spacing: 3",
            "counts: (4, 4, 4), spacing: 7",
        )
        .replace("octree: (depth: 3)", "octree: (depth: 1)");
    let many = ["(7, 7, 7)", "(11, 11, 11)", "depth: 3"];
    let found = |text: &str| many.map(|part| text.matches(part).count());
    assert_eq!((found(&text), found(&few)), ([1; 3], [0; 3]));
    let path = folder.join("cornell.ron");
    fs::write(&path, few).expect("writable");
    path.to_str().expect("UTF-8").to_owned()
}

#[test]
fn what_varies_does_so_and_nothing_else() {
    let folder = folder();
    let world = with_few_probes(folder.path());
    let report = tiny(&["states", &world], &["--quick", "--runs", "1"]).json();
    // Three of the five layouts, two numbers of rays, on and off.
    assert_eq!(rows(&report).len(), 3 * 2 * 2);
    for row in rows(&report) {
        adds_up(row, 1);
        let states = row["varied"]["probes.states"].as_str().expect("a word");
        let id = row["id"].as_str().expect("a name");
        assert!(id.contains(&format!("states {states}")), "{id}");
        let sleeping = number(&row["probes"]["sleeping"]);
        assert!(states == "on" || sleeping == 0.0, "{id}: {sleeping} asleep");
    }
    let report = tiny(&["lights", &world], &["--runs", "1"]).json();
    // No lamp and one: still, flickering, moving, and with a radius.
    assert_eq!(rows(&report).len(), 2 * 4);
    for row in rows(&report) {
        let shadow = number(&row["rays"]["shadow"]);
        let lit = number(&row["varied"]["lamps"]) > 0.0;
        assert_eq!(shadow > 0.0, lit, "{}", row["id"]);
    }
}

#[test]
fn edits_are_measured_by_what_is_edited_at_once() {
    let folder = folder();
    let world = with_few_probes(folder.path());
    let report = tiny(&["edits", &world], &["--runs", "1"]).json();
    let kinds: Vec<&str> = rows(&report)
        .iter()
        .map(|row| row["varied"]["edit"].as_str().expect("a word"))
        .collect();
    assert_eq!(kinds, ["none", "ball", "box", "crumbs"]);
    for (row, kind) in rows(&report).iter().zip(kinds) {
        adds_up(row, 1);
        let cpu = &row["figures"];
        if kind == "none" {
            assert!(cpu["edit_cpu_ms"].is_null(), "{row}");
            continue;
        }
        assert_eq!(row["condition"], "edits", "{kind}");
        let [usual, worst] =
            ["edit_cpu_ms", "edit_cpu_worst_ms"].map(|name| number(&cpu[name]["value"]));
        assert!(usual > 0.0 && usual <= worst, "{kind}: {usual} {worst}");
    }
}

#[test]
fn rows_without_frames_have_figures() {
    let report = tiny(
        &["world", MINIMAL],
        &["--quick", "--seed", "1", "--runs", "1"],
    )
    .json();
    assert!(rows(&report).len() >= 4);
    for row in rows(&report) {
        assert!(row["frame_ms"].is_null(), "{}", row["id"]);
        let figures = &row["figures"];
        assert!(number(&figures["wall_ms"]["value"]) > 0.0, "{}", row["id"]);
        assert!(number(&figures["peak_bytes"]["value"]) > 0.0);
    }
    let report = tiny(&["start", MINIMAL], &["--quick"]).json();
    let figures = &rows(&report)[0]["figures"];
    let order = [
        "adapter_open_ms",
        "world_built_ms",
        "passes_made_ms",
        "first_frame_ms",
        "first_picture_ms",
        "settled_ms",
    ]
    .map(|name| number(&figures[name]["value"]));
    assert!(order.is_sorted(), "{order:?}");
    let loaded = number(&figures["world_loaded_ms"]["value"]);
    assert!(loaded < order[1], "{loaded} {order:?}");
}

#[test]
fn still_rows_have_quality_beside_their_speed() {
    let folder = folder();
    let cache = folder.path().to_str().expect("UTF-8");
    let more = ["--runs", "1", "--quality", "--spp", "4", "--cache", cache];
    let report = tiny(&["textures", "worlds/cornell.ron"], &more).json();
    assert_eq!(rows(&report).len(), 4);
    for row in rows(&report) {
        let quality = &row["quality"];
        let still = row["condition"] == "still";
        assert_eq!(quality.is_object(), still, "{}", row["id"]);
        if still {
            let flip = number(&quality["flip"]);
            assert!((0.0..1.0).contains(&flip) && flip > 0.0);
            assert_eq!(quality["spp"], 4);
        }
    }
}

#[test]
fn probes_have_figures_with_the_final_gather_and_without() {
    let folder = folder();
    let cache = folder.path().to_str().expect("UTF-8");
    // Every tenth row: a uniform layout, traced and kept hits.
    let more = ["--spp", "4", "--cache", cache, "--shard", "1/10"];
    let report = tiny(&["probes", "worlds/cornell.ron"], &more).json();
    let kinds: Vec<&str> = rows(&report)
        .iter()
        .map(|row| row["varied"]["kind"].as_str().expect("a kind"))
        .collect();
    assert!(kinds.contains(&"uniform") && kinds.len() >= 2, "{kinds:?}");
    for row in rows(&report) {
        adds_up(row, 1);
        for name in [
            "update_ms",
            "gather_ms",
            "alone_update_ms",
            "alone_gather_ms",
        ] {
            assert!(number(&row["figures"][name]["value"]) > 0.0, "{name}");
        }
        let flips = [
            &row["quality"]["flip"],
            &row["figures"]["alone_flip"]["value"],
        ]
        .map(number);
        assert!(
            flips.iter().all(|flip| (0.0..1.0).contains(flip)),
            "{flips:?}"
        );
        // The passes are those with the final gather.
        assert!(row["passes"]["surface_cache/trace"].is_number(), "{row}");
    }
}

/// Kernels of points know no spheres: rows of both kinds in one suite must not meet in one frame.
#[test]
fn lamps_are_measured_as_points_and_as_spheres() {
    let ended = tiny(
        &["lights", "worlds/cornell.ron", "--quick"],
        &["--runs", "1"],
    );
    let report: Value = serde_json::from_str(&ended.stdout).expect("JSON");
    let of = |condition: &str| {
        let rows = rows(&report).iter();
        rows.filter(|row| row["condition"] == condition).count()
    };
    for condition in ["still", "flickering", "moving", "spheres"] {
        assert_eq!(of(condition), 2, "{condition}: no lamp, and one");
    }
}

#[test]
fn the_quality_tables_have_an_octree_beside_the_lattices() {
    let folder = folder();
    let cache = folder.path().to_str().expect("UTF-8");
    let suite = ["tables", "worlds/bleed.ron"];
    let ended = tiny(&suite, &["--spp", "1", "--cache", cache]);
    let report: Value = serde_json::from_str(&ended.stdout).expect("JSON");
    let all = rows(&report);
    assert_eq!(all.len(), 2 * 4);
    for row in all {
        let id = row["id"].as_str().expect("an id");
        assert!(id.starts_with("tables/octree-quality/bleed/"), "{id}");
        assert!(number(&row["quality"]["flip"]) > 0.0, "{id}");
        let error = number(&row["figures"]["absolute_error_mean"]["value"]);
        assert!(error > 0.0 && error < 3.0, "{id}: {error}");
    }
    let octrees = all.iter().filter(|row| row["layout"] == "octree").count();
    assert_eq!(octrees, 2);
}

#[test]
fn hits_of_the_published_octree_are_counted_over_time() {
    let more = ["--quick", "--shard", "1/8"];
    let report = tiny(&["hits", "worlds/cornell.ron"], &more).json();
    let [row] = &rows(&report)[..] else {
        panic!("one row")
    };
    let of = |name: &str| number(&row["figures"][name]["value"]);
    for frame in ["000", "100"] {
        let [hits, in_leaf] = ["hits", "leaf_hits"].map(|what| of(&format!("{what}_{frame}")));
        // The box is open on one side; leaves are smaller than the box.
        assert!(
            0.0 < in_leaf && in_leaf < hits && hits < 1.0,
            "{hits} {in_leaf}"
        );
        assert!(of(&format!("probes_{frame}")) > 1.0);
    }
    assert!(
        row["figures"].get("probes_200").is_none(),
        "--quick ends at 100"
    );
}

#[test]
fn what_cannot_be_measured_is_refused_before_anything_is() {
    let bench = |arguments: &[&str], parts: &[&str]| {
        refused(grotto().arg("bench").args(arguments), 2, parts);
    };
    bench(
        &["everything"],
        &["`everything`", "layouts", "traversal", "tables"],
    );
    bench(&["layout"], &["Did you mean `layouts`?"]);
    bench(&["layouts", "worlds/none.ron"], &["worlds/none.ron"]);
    bench(&["layouts", MINIMAL, "--layout", "none"], &["no row"]);
    bench(&["cascades", MINIMAL], &["no row", "`cascades`"]);
    for runs in ["0", "1000000000", "-1", "some"] {
        bench(&["layouts", MINIMAL, "--runs", runs], &["--runs"]);
    }
    bench(&["layouts", MINIMAL, "--shard", "5/4"], &["2/4"]);
    let folder = folder();
    let file = folder.path().join("file");
    fs::write(&file, "").expect("writable");
    let file = file.to_str().expect("UTF-8");
    bench(&["layouts", MINIMAL, "--out", file], &["file"]);
}

#[test]
fn parts_of_a_suite_make_the_whole() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name).to_str().expect("UTF-8").to_owned();
    let mut ids = Vec::new();
    for part in ["1/2", "2/2"] {
        let out = path(&part.replace('/', "-of-"));
        let more = ["--runs", "1", "--shard", part, "--out", &out];
        let report = tiny(&["textures", "worlds/cornell.ron"], &more).json();
        assert_eq!(rows(&report).len(), 2, "part {part}");
        ids.extend(rows(&report).iter().map(|row| row["id"].clone()));
    }
    let merge = |parts: &[&str], out: &str| {
        let mut command = grotto();
        command
            .arg("merge")
            .args(parts.iter().map(|part| path(part)));
        command.args(["--out", &path(out)]);
        command
    };
    refused(&mut merge(&["1-of-2"], "whole"), 2, &["2/2 is missing"]);
    let ended = end(&mut merge(&["2-of-2", "1-of-2"], "whole"));
    assert_eq!(ended.code, 0, "{}", ended.stderr);
    let text = fs::read_to_string(folder.path().join("whole/bench.json")).expect("the report");
    let whole: Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(whole["complete"], true);
    let expected = [
        "textures on/still",
        "textures off/still",
        "textures on/moving",
        "textures off/moving",
    ]
    .map(|name| format!("textures/cornell/{name}"));
    let joined: Vec<&str> = rows(&whole)
        .iter()
        .map(|row| row["id"].as_str().expect("a name"))
        .collect();
    // The rows are in the order of the whole, of which each part had every second row.
    assert_eq!(joined.len(), ids.len());
    assert!(
        ids.iter()
            .all(|id| joined.contains(&id.as_str().expect("a name")))
    );
    assert_eq!(joined, expected);
}

#[cfg(unix)]
#[test]
fn a_run_that_is_stopped_leaves_a_report_that_says_so() {
    use std::{
        process::Command,
        thread::sleep,
        time::{Duration, Instant},
    };

    let folder = folder();
    let out = folder.path().join("out");
    let mut command = grotto();
    command.args([
        "bench",
        "layouts",
        "worlds/cornell.ron",
        "--layout",
        "layout1",
    ]);
    command.args([
        "--size",
        "32x18",
        "--frames",
        "2",
        "--measured",
        "8",
        "--runs",
        "900",
    ]);
    command.arg("--quiet").arg("--out").arg(&out);
    let mut child = command
        .stdout(std::process::Stdio::null())
        .spawn()
        .expect("the binary starts");
    // The first report is written ten seconds after the start.
    let start = Instant::now();
    while !out.join("bench.json").exists() && start.elapsed() < Duration::from_secs(60) {
        sleep(Duration::from_millis(100));
    }
    let id = child.id().to_string();
    let sent = Command::new("kill").args(["-INT", &id]).status();
    assert!(sent.expect("kill is there").success());
    let status = child.wait().expect("it ends");
    assert_eq!(status.code(), Some(130));
    let text = fs::read_to_string(out.join("bench.json")).expect("the report");
    let report: Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(report["complete"], false);
    assert!(!rows(&report).is_empty());
    assert!(frames(&out).lines().count() > 8);
}
