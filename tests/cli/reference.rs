//! `grotto reference`, run as a user runs it.

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::thread::sleep;
use std::time::Duration;

use grotto::measure::picture_file;
use serde_json::Value;

use crate::{folder, grotto};

fn reference(arguments: &[&str], output: &Path) -> Command {
    let mut command = grotto();
    command
        .args(["reference", "worlds/minimal.ron", "-o"])
        .arg(output)
        .args(arguments);
    command
}

fn record(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).expect("one JSON object")
}

#[test]
fn bad_flags_are_refused_before_any_work() {
    let folder = folder();
    for (name, arguments, part) in [
        ("a.exr", &["--spp", "0"][..], "--spp"),
        ("a.exr", &["--spp", "-3"], "--spp"),
        ("a.exr", &["--view", "cage"], "--view cage"),
        ("a.exr", &["--camera", "nope"], "no camera"),
        ("a.jpg", &[], ".exr"),
    ] {
        let output = reference(arguments, &folder.path().join(name)).output();
        let output = output.expect("the binary starts");
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {stderr}");
        assert!(stderr.contains(part), "{arguments:?}: {stderr}");
        let left = fs::read_dir(folder.path()).expect("readable").count();
        assert_eq!(left, 0, "{arguments:?}");
    }
}

#[test]
fn a_picture_comes_with_its_record() {
    let folder = folder();
    let path = folder.path().join("a.exr");
    let arguments = [
        "--spp", "3", "--size", "24x16", "--json", "--layout", "none",
    ];
    let refused = reference(&arguments, &path).output().expect("it starts");
    assert_eq!(refused.status.code(), Some(2), "no such layout");
    let output = reference(&arguments[..5], &path).output();
    let output = output.expect("the binary starts");
    assert_eq!(output.status.code(), Some(0));
    let record = record(&output);
    assert_eq!(record["spp"], 3);
    assert_eq!(record["size"], serde_json::json!([24, 16]));
    assert!(
        record["mpaths_per_s"]
            .as_f64()
            .is_some_and(|rate| rate > 0.0)
    );
    let (picture, _) = picture_file::read(&path).expect("an EXR");
    assert_eq!((picture.width, picture.height), (24, 16));
    let light: f32 = picture.rgb.iter().flatten().sum();
    assert!(light.is_finite() && light > 0.0);
}

/// Ctrl-C ends the command with the picture so far, and the record says how many samples the picture holds.
#[test]
#[cfg(unix)]
fn ctrl_c_writes_the_picture_so_far() {
    stopped_writes_the_picture_so_far("-INT");
}

#[test]
#[cfg(unix)]
fn a_termination_writes_the_picture_so_far() {
    stopped_writes_the_picture_so_far("-TERM");
}

#[cfg(unix)]
fn stopped_writes_the_picture_so_far(signal: &str) {
    let folder = folder();
    let path = folder.path().join("a.exr");
    for seconds in [2, 5, 15, 40] {
        let child = reference(&["--spp", "1000000", "--size", "16x16", "--json"], &path)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the binary starts");
        sleep(Duration::from_secs(seconds));
        let interrupt = Command::new("kill")
            .args([signal, &child.id().to_string()])
            .status();
        assert!(interrupt.expect("kill is there").success());
        let output = child.wait_with_output().expect("it ends");
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(130), "{stderr}");
        // Not a single sample yet: this machine is slow, so give it longer.
        if !path.exists() {
            continue;
        }
        assert!(stderr.contains("of 1000000 samples"), "{stderr}");
        let spp = record(&output)["spp"].as_u64().expect("a number");
        assert!((1..1_000_000).contains(&spp), "{spp}");
        picture_file::read(&path).expect("an EXR");
        return;
    }
    panic!("no sample within 40 s");
}
