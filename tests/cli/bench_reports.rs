//! `grotto bench diff`, `history` and `merge`, which process results. No GPU is needed.

use std::{
    fs,
    path::{Path, PathBuf},
};

use serde_json::{Value, json};

use crate::{end, folder, grotto, refused};

/// Statistics of frames of about `ms` each.
fn statistics(ms: f64) -> Value {
    json!({
        "count": 600, "median": ms, "mean": ms, "p95": 1.1 * ms, "p99": 1.2 * ms, "p999": 1.3 * ms,
        "worst": 1.5 * ms, "low1_fps": 800.0 / ms, "low1_integral_fps": 800.0 / ms, "stutters": 0,
        "stutter_share": 0.0
    })
}

/// Five runs around `ms`.
fn runs(ms: f64) -> Value {
    json!([-0.002, 0.001, 0.0, 0.002, -0.001].map(|by| ms * (1.0 + by)))
}

/// A row whose passes take these milliseconds.
fn row(layout: &str, trace_ms: f64, shade_ms: f64) -> Value {
    let ms = trace_ms + shade_ms + 0.1;
    json!({
        "id": format!("layouts/cave/{layout}/moving"), "place": 0, "suite": "layouts", "world": "cave",
        "camera": "start", "layout": layout, "condition": "moving", "view": "full", "size": [1920, 1080],
        "frames": 64, "seed": 0, "varied": {}, "set": [],
        "adapter": {"name": "Card 9000", "kind": "discrete", "driver": "driver 1", "backend": "vulkan"},
        "clock": "gpu",
        "timing": {
            "runs_ms": runs(ms), "interval": {"mean": ms, "half_width": 0.002 * ms},
            "pass_runs_ms": {"probes/trace": runs(trace_ms), "view/shade": runs(shade_ms)},
            "noisy": false, "cpu_ms": statistics(0.1), "wall_ms": statistics(1.1 * ms),
            "curve_ms": [ms, ms, 1.5 * ms], "histogram": [2, 1], "histogram_from_ms": ms,
            "histogram_step_ms": 0.1
        },
        "fps": 1e3 / ms, "frame_ms": statistics(ms),
        "passes": {"probes/trace": trace_ms, "view/shade": shade_ms},
        "rays": {}, "mrays_per_s": {}, "probes": null, "memory_bytes": {}, "figures": {}, "quality": null
    })
}

/// Three layouts.
fn report(trace_ms: f64, shade_ms: f64) -> Value {
    let rows: Vec<Value> = ["layout1", "layout2", "layout3"]
        .iter()
        .enumerate()
        .map(|(index, layout)| row(layout, trace_ms * (1.0 + index as f64), shade_ms))
        .collect();
    json!({
        "kind": "grotto bench", "schema": 1, "suite": "layouts", "complete": true, "quick": false,
        "shard": {"index": 1, "count": 1}, "command": ["bench", "layouts"],
        "started": "2026-11-22T20:00:00Z", "elapsed_s": 10.0,
        "build": {"version": "0.1.0", "commit": "0123456789ab", "profile": "release"},
        "machine": {
            "cpu": "CPU", "cores": 8, "memory_bytes": 1, "os": "Linux", "warm_up": "1 s of frames",
            "gpu_before": null, "gpu_after": null
        },
        "worlds": [{
            "name": "cave", "title": "A cave", "hash": "0".repeat(32), "seed": 1, "size": [8, 8, 8],
            "picture": null
        }],
        "rows": rows, "missing": []
    })
}

fn write(folder: &Path, name: &str, report: &Value) -> PathBuf {
    let path = folder.join(name);
    fs::create_dir_all(&path).expect("a folder");
    fs::write(path.join("bench.json"), report.to_string()).expect("writable");
    path
}

fn diff(before: &Path, after: &Path) -> std::process::Command {
    let mut command = grotto();
    command.args(["bench", "diff"]).arg(before).arg(after);
    command
}

#[test]
fn equal_results_have_no_change_and_pass_the_gate() {
    let folder = folder();
    let a = write(folder.path(), "a", &report(1.0, 0.5));
    let ended = end(diff(&a, &a.join("bench.json")).args(["--fail-over", "0%"]));
    assert_eq!(ended.code, 0, "{}", ended.stderr);
    assert!(
        ended.stdout.ends_with("no change in 3 rows\n"),
        "{}",
        ended.stdout
    );
    assert!(ended.stdout.contains("± "), "{}", ended.stdout);
}

#[test]
fn a_slower_pass_is_found_and_named() {
    let folder = folder();
    let a = write(folder.path(), "a", &report(1.0, 0.5));
    let b = write(folder.path(), "b", &report(1.0, 0.515));
    let ended = end(&mut diff(&a, &b));
    assert_eq!(ended.code, 0, "{}", ended.stderr);
    let named = "pass view/shade: SLOWER by 3.0 % (median) in 3 of 3 rows\n";
    assert!(ended.stdout.contains(named), "{}", ended.stdout);
    assert!(
        !ended.stdout.contains("pass probes/trace"),
        "{}",
        ended.stdout
    );
    let record = end(diff(&a, &b).arg("--json")).json();
    assert_eq!(record["passes"][0]["pass"], "view/shade");
    assert_eq!(record["passes"][0]["verdict"], "slower");
    assert_eq!(record["rows"][0]["headline"]["verdict"], "noise");
}

#[test]
fn the_gate_fails_past_its_threshold() {
    let folder = folder();
    let a = write(folder.path(), "a", &report(1.0, 0.5));
    let b = write(folder.path(), "b", &report(1.1, 0.5));
    let ended = end(diff(&a, &b).args(["--fail-over", "3%"]));
    assert_eq!(ended.code, 4);
    for part in ["3 of 3 rows", "3.0 %", "layouts/cave/layout2/moving"] {
        assert!(ended.stderr.contains(part), "{}", ended.stderr);
    }
    assert!(ended.stdout.contains("SLOWER"), "{}", ended.stdout);
    assert_eq!(end(diff(&a, &b).args(["--fail-over", "0.1"])).code, 0);
    assert_eq!(
        end(diff(&b, &a).args(["--fail-over", "3%"])).code,
        0,
        "faster"
    );
    let record = end(diff(&a, &b).args(["--fail-over", "3%", "--json"])).json();
    assert_eq!(record["failed"].as_array().map(Vec::len), Some(3));
    refused(
        diff(&a, &b).args(["--fail-over", "fast"]),
        2,
        &["3% or 0.03"],
    );
    refused(
        diff(&a, &b).args(["--fail-over", "-3%"]),
        2,
        &["3% or 0.03"],
    );
}

#[test]
fn what_does_not_compare_is_refused_with_a_message() {
    let folder = folder();
    let a = write(folder.path(), "a", &report(1.0, 0.5));
    let altered = |name: &str, change: fn(&mut Value)| {
        let mut report = report(1.0, 0.5);
        change(&mut report);
        write(folder.path(), name, &report)
    };
    let b = altered("b", |report| {
        report["machine"]["cpu"] = json!("other CPU");
        report["worlds"][0]["hash"] = json!("f".repeat(32));
    });
    refused(
        &mut diff(&a, &b),
        2,
        &["other CPU", "world `cave`", "--anyway"],
    );
    let ended = end(diff(&a, &b).arg("--anyway"));
    assert_eq!(ended.code, 0);
    assert!(
        ended.stderr.contains("warning: another CPU"),
        "{}",
        ended.stderr
    );
    assert!(ended.stdout.contains("no change"), "{}", ended.stdout);

    let newer = altered("newer", |report| report["schema"] = json!(2));
    refused(&mut diff(&a, &newer), 2, &["schema 2", "newer"]);
    let foreign = altered("foreign", |report| report["kind"] = json!("grotto judge"));
    refused(
        &mut diff(&a, &foreign),
        2,
        &["foreign", "is not a report of `grotto bench`"],
    );
    let damaged = altered("damaged", |report| report["rows"] = json!(7));
    refused(&mut diff(&a, &damaged), 2, &["damaged", "measure it again"]);
    fs::write(damaged.join("bench.json"), "{\"kind\": ").expect("writable");
    refused(&mut diff(&a, &damaged), 2, &["damaged"]);
    refused(&mut diff(&a, &folder.path().join("none")), 2, &["none"]);
    let strange = altered("strange", |report| {
        report["rows"][0]["id"] = json!("x");
        report["rows"].as_array_mut().expect("rows").truncate(1);
    });
    refused(&mut diff(&a, &strange), 2, &["no row in common"]);
}

#[test]
fn history_draws_results_in_the_order_of_their_start() {
    let folder = folder();
    let mut newer = report(1.1, 0.5);
    newer["started"] = json!("2026-11-23T20:00:00Z");
    newer["build"]["commit"] = json!("fedcba987654");
    let newer = write(folder.path(), "newer", &newer);
    let older = write(folder.path(), "older", &report(1.0, 0.5));
    let out = folder.path().join("pages/history.html");
    let history = |out: &Path| {
        let mut command = grotto();
        command
            .args(["bench", "history"])
            .args([&newer, &older])
            .arg("--out")
            .arg(out);
        command
    };
    let ended = end(history(&out).arg("--json"));
    assert_eq!(ended.code, 0, "{}", ended.stderr);
    let record = ended.json();
    assert_eq!(record["results"][0]["commit"], "0123456789ab");
    assert_eq!(record["rows"].as_array().map(Vec::len), Some(3));
    assert_eq!(
        record["rows"][0]["points"].as_array().map(Vec::len),
        Some(2)
    );
    let page = fs::read_to_string(&out).expect("the page");
    let (old, new) = (
        page.find("0123456").expect("a commit"),
        page.find("fedcba9").expect("a commit"),
    );
    assert!(old < new);
    refused(&mut history(folder.path()), 2, &["--out", "history.html"]);
}

#[test]
fn cards_are_merged_side_by_side() {
    let folder = folder();
    let mut other = report(2.0, 1.0);
    for row in other["rows"].as_array_mut().expect("rows") {
        row["adapter"]["name"] = json!("Board 7");
    }
    let a = write(folder.path(), "a", &report(1.0, 0.5));
    let b = write(folder.path(), "b", &other);
    let out = folder.path().join("both");
    let merge = |parts: &[&Path], out: &Path| {
        let mut command = grotto();
        command
            .args(["bench", "merge"])
            .args(parts)
            .arg("--out")
            .arg(out);
        command
    };
    let ended = end(&mut merge(&[&a, &b], &out));
    assert_eq!(ended.code, 0, "{}", ended.stderr);
    for part in [
        "cave/layout1/moving@card-9000",
        "cave/layout1/moving@board-7",
    ] {
        assert!(ended.stdout.contains(part), "{}", ended.stdout);
    }
    for file in ["bench.json", "rows.csv", "index.html", "frames.csv.gz"] {
        assert!(out.join(file).exists(), "{file}");
    }
    // It can be read again.
    assert_eq!(end(&mut diff(&out, &out)).code, 0);
    refused(
        &mut merge(&[&a, &b], &out),
        2,
        &["already holds", "--overwrite"],
    );
    assert_eq!(end(merge(&[&a, &b], &out).arg("--overwrite")).code, 0);
    refused(&mut merge(&[&a, &b], &a), 2, &["--out"]);
    refused(
        &mut merge(&[&a, &out], &folder.path().join("more")),
        2,
        &["merged already"],
    );
    refused(&mut merge(&[&a], &folder.path().join("one")), 2, &[]);
    let mut part = report(1.0, 0.5);
    part["shard"] = json!({"index": 2, "count": 4});
    let part = write(folder.path(), "part", &part);
    refused(
        &mut merge(&[&a, &part], &folder.path().join("parts")),
        2,
        &["2/4", "grotto merge"],
    );
}

#[test]
fn a_full_disk_is_reported() {
    let full = Path::new("/dev/full");
    if !full.exists() {
        return;
    }
    let folder = folder();
    let a = write(folder.path(), "a", &report(1.0, 0.5));
    let mut command = diff(&a, &a);
    command.stdout(fs::File::create(full).expect("a device"));
    let output = command.output().expect("the binary starts");
    assert_eq!(output.status.code(), Some(1));
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(message.contains("stdout"), "{message}");
}
