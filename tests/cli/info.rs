//! `grotto info`, with and without a GPU.

use std::{io::Read as _, process::Stdio};

use serde_json::Value;

use crate::{MINIMAL, end, folder, grotto, grotto_without_gpu, listing, refused, run};

#[test]
fn info_lists_every_key_also_without_a_gpu() {
    let ended = end(grotto_without_gpu().args(["info", "--keys"]));
    assert_eq!(ended.code, 0, "{}", ended.stderr);
    assert_eq!(
        ended.stdout.lines().count(),
        grotto::parameters::KEYS.len() + 1
    );
    let json = end(grotto_without_gpu().args(["info", "--keys", "--json"])).json();
    let rows = json["keys"].as_array().expect("an array");
    for key in grotto::parameters::KEYS {
        let row = rows
            .iter()
            .find(|row| row["key"] == key.name)
            .expect(key.name);
        assert_eq!(row["default"], key.default().to_string());
        assert!(ended.stdout.contains(key.name));
    }
    for needed in [
        "probes.rays",
        "probes.hysteresis",
        "probes.visibility",
        "probes.states",
        "probes.irradiance_texels",
        "probes.distance_texels",
        "lights.preset",
        "lights.animate",
        "textures.enabled",
        "world.size",
        "world.seed",
        "world.bodies",
    ] {
        assert!(rows.iter().any(|row| row["key"] == needed), "{needed}");
    }
}

#[test]
fn a_reader_that_leaves_early_is_no_fault() {
    let mut child = grotto()
        .args(["info", "--keys"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary starts");
    drop(child.stdout.take());
    let mut stderr = String::new();
    let mut pipe = child.stderr.take().expect("piped");
    pipe.read_to_string(&mut stderr).expect("UTF-8");
    assert_eq!(child.wait().expect("it ends").code(), Some(0));
    assert_eq!(stderr, "");
}

#[test]
fn info_names_the_adapter_that_would_run() {
    let ended = run(&["info"]);
    assert_eq!(ended.code, 0, "no GPU, no tests: {}", ended.stderr);
    assert!(
        ended.stdout.starts_with("Would run on: "),
        "{}",
        ended.stdout
    );
    let json = run(&["info", "--json"]).json();
    let adapters = json["adapters"].as_array().expect("an array");
    let chosen: Vec<&Value> = adapters
        .iter()
        .filter(|one| one["chosen"] == true)
        .collect();
    assert_eq!(chosen.len(), 1);
    for field in ["name", "kind", "driver", "backend", "limits", "features"] {
        assert!(!chosen[0][field].is_null(), "{field}");
    }
}

#[test]
fn without_a_gpu_the_remedy_is_named() {
    let folder = folder();
    let remedy = ["mesa-vulkan-drivers", "--cpu"];
    refused(grotto_without_gpu().arg("info"), 3, &remedy);
    let output = folder.path().join("a.png");
    refused(
        grotto_without_gpu()
            .args(["render", MINIMAL, "-o"])
            .arg(output),
        3,
        &remedy,
    );
    assert!(listing(folder.path()).is_empty());
}

/// Without a desktop the GPU's loader prints no complaints.
#[test]
fn nothing_else_is_printed_on_stderr() {
    let ended = crate::end(
        crate::grotto()
            .args(["info", "--json"])
            .env_remove("XDG_RUNTIME_DIR")
            .env_remove("WAYLAND_DISPLAY")
            .env_remove("DISPLAY"),
    );
    assert_eq!(ended.code, 0, "{}", ended.stderr);
    assert_eq!(ended.stderr, "");
}
