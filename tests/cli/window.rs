//! The window, opened on a virtual display (Xvfb).

use std::{
    env, fs,
    path::PathBuf,
    process::{Command, Output, Stdio},
};

use directories::BaseDirs;

use crate::{
    folder, grotto, root,
    support::{
        binary::{output, text},
        copy_folder,
    },
};

fn ended(command: &mut Command) -> Output {
    output(command.current_dir(root()).stdin(Stdio::null()))
}

/// `grotto play` with these arguments, on a display of its own.
fn play(arguments: &[&str]) -> Output {
    ended(on_a_display().arg("play").args(arguments))
}

/// grotto, on a display of its own.
fn on_a_display() -> Command {
    let found = Command::new("xvfb-run").arg("--help").output();
    assert!(
        found.is_ok(),
        "xvfb-run was not found. scripts/test installs it on Debian (packages xvfb and xauth)."
    );
    let mut command = Command::new("xvfb-run");
    command
        .args(["--auto-servernum", "--server-args=-screen 0 640x480x24"])
        .arg(grotto().get_program())
        .env("RUST_LOG", "grotto=info")
        // Nobody has settings here.
        .env("GROTTO_CONFIG", "/nowhere/at/all")
        .env_remove("WAYLAND_DISPLAY");
    command
}

/// Where Mesa keeps what it has compiled, for a process whose cache folder is its own: to compile all of it again takes a
/// minute.
fn compiled_shaders() -> Option<(&'static str, PathBuf)> {
    let folders = BaseDirs::new()?;
    let variable = "MESA_SHADER_CACHE_DIR";
    let chosen = env::var_os(variable).map(PathBuf::from);
    Some((variable, chosen.unwrap_or(folders.cache_dir().to_owned())))
}

#[test]
fn without_a_world_the_title_screen_opens_anywhere() {
    let place = folder();
    let mut command = on_a_display();
    command
        .args([
            "play",
            "--frames",
            "3",
            "--size",
            "320x200",
            "--set",
            "probes.rays=16",
        ])
        .env("XDG_DATA_HOME", place.path().join("data"))
        .env("XDG_CACHE_HOME", place.path().join("cache"))
        .envs(compiled_shaders())
        .stdin(Stdio::null())
        // Not a checkout: the worlds come out of the binary.
        .current_dir(place.path());
    let output = output(&mut command);
    let stderr = text(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    let worlds = fs::read_dir(place.path().join("cache/grotto"))
        .expect("a cache")
        .count();
    assert!(worlds > 0, "the world behind the title is a file");
    assert!(!place.path().join("data/grotto/saves/cave.grotto").exists());
}

#[test]
fn without_a_display_a_bare_call_greets() {
    let output = ended(
        grotto()
            .env_remove("DISPLAY")
            .env_remove("WAYLAND_DISPLAY")
            .env_remove("WAYLAND_SOCKET"),
    );
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("grotto render"));
}

#[test]
fn the_window_opens_shows_frames_and_closes() {
    let output = play(&[
        "worlds/minimal.ron",
        "--frames",
        "3",
        "--size",
        "160x96",
        "--set",
        "probes.rays=16",
    ]);
    let stderr = text(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{stderr}");
}

#[test]
fn the_window_continues_when_its_device_is_lost() {
    let arguments = [
        "worlds/minimal.ron",
        "--size",
        "160x96",
        "--set",
        "probes.rays=16",
    ];
    let lost = ["--lose-device-at", "2", "--frames", "5"];
    let output = play(&[&arguments[..], &lost].concat());
    let stderr = text(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    assert!(stderr.contains("the device was lost"), "{stderr}");
}

#[test]
fn the_path_traced_reference_is_shown_in_the_window() {
    let output = play(&[
        "worlds/minimal.ron",
        "--reference",
        "--frames",
        "4",
        "--size",
        "160x96",
    ]);
    let stderr = text(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{stderr}");
}

#[test]
fn the_benchmark_flies_prints_its_figures_and_the_session_continues() {
    // 30 frames of warm-up (or half a second), 240 that count, and some after those.
    let output = play(&[
        "worlds/minimal.ron",
        "--benchmark",
        "--frames",
        "400",
        "--size",
        "64x40",
        "--set",
        "probes.rays=8",
    ]);
    let stderr = text(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    assert_eq!(stderr.matches("benchmark: minimal").count(), 1, "{stderr}");
    for part in ["240 frames", "median", "1 % low, by time", "Present mode"] {
        assert!(stderr.contains(part), "{part}: {stderr}");
    }
}

#[test]
fn probes_and_atlases_are_shown_in_the_window() {
    for shown in [
        &["--view", "states", "--probes", "offset"][..],
        &["--atlas", "irradiance:0"],
        // The window shows the last layer instead.
        &["--atlas", "irradiance:9"],
    ] {
        let arguments = ["worlds/minimal.ron", "--frames", "2", "--size", "160x96"];
        let output = play(&[&arguments[..], &["--set", "probes.rays=16"], shown].concat());
        let stderr = text(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{shown:?}: {stderr}");
    }
}

#[test]
fn a_run_is_recorded_and_played_again() {
    let folder = folder();
    let record = folder.path().join("run.record");
    let record = record.to_str().expect("UTF-8");
    let small = ["--size", "160x96", "--frames", "6"];
    let world = ["worlds/minimal.ron", "--set", "probes.rays=16"];
    let recorded = play(&[&world[..], &small, &["--record", record]].concat());
    assert_eq!(
        recorded.status.code(),
        Some(0),
        "{}",
        text(&recorded.stderr)
    );
    let lines = fs::read_to_string(record).expect("it has its name");
    assert!(lines.starts_with("{\"grotto_record\":2,"), "{lines}");
    assert!(lines.trim_end().ends_with("\"end\":true}"), "{lines}");
    let replayed = play(&[&small[..], &["--replay", record]].concat());
    assert_eq!(
        replayed.status.code(),
        Some(0),
        "{}",
        text(&replayed.stderr)
    );
}

/// The control gives up rays and pixels frame after frame here, for no adapter is this fast.
#[test]
fn a_frame_time_that_is_held_leaves_no_trace_in_a_record() {
    let folder = folder();
    let record = folder.path().join("run.record");
    let output = play(&[
        "worlds/minimal.ron",
        "--quality",
        "high+auto",
        "--frame-time",
        "1",
        "--frames",
        "60",
        "--size",
        "160x96",
        "--set",
        "probes.rays=16",
        "--record",
        record.to_str().expect("UTF-8"),
    ]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let lines = fs::read_to_string(record).expect("it has its name");
    let (header, inputs) = lines.split_once('\n').expect("a header");
    assert!(header.contains("probes.rays=16"), "{header}");
    for trace in ["set", "resize", "share"] {
        assert!(!inputs.contains(trace), "{trace}: {inputs}");
    }
}

#[test]
fn shaders_from_a_folder_run_and_broken_ones_leave_those_of_the_binary() {
    let folder = folder();
    copy_folder(&root().join("shaders"), folder.path());
    fs::write(folder.path().join("view/shade.wesl"), "fn main( {").expect("writable");
    let output = play(&[
        "worlds/minimal.ron",
        "--frames",
        "2",
        "--size",
        "160x96",
        "--set",
        "probes.rays=16",
        "--shaders",
        folder.path().to_str().expect("UTF-8"),
    ]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
}

#[test]
fn without_a_display_the_message_names_the_way_to_a_picture() {
    let output = ended(
        grotto()
            .args(["play", "worlds/minimal.ron"])
            .env_remove("DISPLAY")
            .env_remove("WAYLAND_DISPLAY")
            .env_remove("WAYLAND_SOCKET"),
    );
    let stderr = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{stderr}");
    assert!(stderr.contains("grotto render"), "{stderr}");
    assert_eq!(stderr.matches("error").count(), 1, "{stderr}");
}

#[test]
fn bad_arguments_are_refused_before_any_window_opens() {
    for (arguments, part) in [
        (&["worlds/minimal.ron", "--camera", "nope"][..], "no camera"),
        (&["worlds/minimal.ron", "--layout", "nope"], "no layout"),
        (&["worlds/none.ron"], "worlds/none.ron"),
        (
            &["worlds/minimal.ron", "--shaders", "src"],
            "no folder of shaders",
        ),
        (&["worlds/minimal.ron", "--size", "0x10"], "WIDTHxHEIGHT"),
        (&["worlds/minimal.ron", "--frames", "0"], "--frames"),
        (
            &["worlds/minimal.ron", "--quality", "hihg"],
            "there are low, medium",
        ),
        (
            &["worlds/minimal.ron", "--frame-time", "0"],
            "1 to 1000 milliseconds",
        ),
    ] {
        let output = ended(grotto().arg("play").args(arguments));
        let stderr = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {stderr}");
        assert!(stderr.contains(part), "{arguments:?}: {stderr}");
    }
}
