//! Settings of the window, changed by real keys on a virtual display (Xvfb, xdotool).

use std::{
    fs,
    path::Path,
    process::{Command, Stdio},
};

use serde_json::{Value, json};

use crate::{
    MINIMAL, folder,
    support::{
        binary::{grotto, output, text},
        root,
    },
};

/// Presses `$KEYS` in the window of a run, waits until a screenshot shows that they were taken, and ends it.
const SESSION: &str = r#"
"$0" play "$@" &
window=$(xdotool search --sync --onlyvisible --name grotto | head -n 1)
xdotool mousemove --window "$window" 20 20
for key in $KEYS F2; do xdotool key "$key"; done
for tenth in $(seq 900); do ls *.png > /dev/null 2>&1 && break; sleep 0.1; done
kill -TERM $!
wait $!
rm *.png
"#;

/// What a run on a display of its own says, with settings in this folder, in which these keys are pressed.
fn session(place: &Path, keys: &str, arguments: &[&str]) -> String {
    let found = Command::new("xdotool").arg("version").output();
    assert!(
        found.is_ok(),
        "xdotool was not found. scripts/test installs it on Debian."
    );
    let mut command = Command::new("xvfb-run");
    command
        .args(["--auto-servernum", "--server-args=-screen 0 640x480x24"])
        .args(["sh", "-c", SESSION])
        .arg(grotto().get_program())
        .arg(root().join(MINIMAL))
        .args(["--set", "probes.rays=16"])
        .args(arguments)
        .current_dir(place)
        .env("KEYS", keys)
        .env("GROTTO_CONFIG", place)
        .env("GROTTO_SAVES", place.join("saves"))
        .env("RUST_LOG", "grotto=warn")
        .env_remove("WAYLAND_DISPLAY")
        .stdin(Stdio::null());
    let output = output(&mut command);
    let told = text(&output.stderr);
    assert!(!told.contains("panicked"), "{told}");
    assert!(output.status.success(), "no screenshot was taken: {told}");
    told
}

fn settings(place: &Path) -> Value {
    let text = fs::read_to_string(place.join("settings.json")).expect("settings");
    serde_json::from_str(&text).expect("JSON")
}

#[test]
fn what_is_changed_in_the_window_is_there_again_after_a_restart() {
    let place = folder();
    session(place.path(), "F11", &["--size", "160x96"]);
    let kept = settings(place.path());
    assert_eq!(kept["full_screen"], true);
    assert_eq!(
        kept["window_size"],
        json!([1280, 720]),
        "--size is not kept"
    );
    session(place.path(), "F11", &[]);
    assert_eq!(settings(place.path())["full_screen"], false);
}

#[test]
fn a_rebound_key_moves_the_player_and_the_old_one_does_not() {
    let place = folder();
    let changed =
        json!({"version": 1, "mouse_sensitivity": 2, "keys": {"forward": ["T"], "left": []}});
    fs::write(place.path().join("settings.json"), changed.to_string()).expect("writable");
    let small = ["--size", "160x96", "--record", "run.record"];
    let told = session(place.path(), "w t a d", &small);
    assert!(!told.contains("settings"), "{told}");
    let record = fs::read_to_string(place.path().join("run.record")).expect("a record");
    let presses = |key: &str| record.matches(&format!("{{\"press\":\"{key}\"}}")).count();
    assert_eq!(presses("forward"), 1, "{record}");
    assert_eq!(presses("left"), 0, "{record}");
    assert_eq!(presses("right"), 1, "{record}");
}

#[test]
fn damaged_settings_are_set_aside_and_the_window_opens() {
    let place = folder();
    fs::write(place.path().join("settings.json"), "{\"vsync\": nonsense").expect("writable");
    let told = session(place.path(), "F11", &["--size", "160x96"]);
    assert!(told.contains("settings.json.damaged"), "{told}");
    let aside = fs::read_to_string(place.path().join("settings.json.damaged"));
    assert_eq!(aside.expect("it is there"), "{\"vsync\": nonsense");
    assert_eq!(settings(place.path())["full_screen"], true);
}
