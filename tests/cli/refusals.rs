//! Bad flags, outputs and files are refused with a message that helps, before any work.

use std::fs;

use crate::{CAVE, MINIMAL, folder, grotto, listing, refused, run, world_path};

#[test]
fn bad_flags_are_refused_before_any_work() {
    let folder = folder();
    let picture = folder.path().join("a.png");
    let picture = picture.to_str().expect("UTF-8");
    for (flags, parts) in [
        (
            &["--size", "0x0"][..],
            &["--size", "WIDTHxHEIGHT", "16384"][..],
        ),
        (&["--size", "0x20"], &["--size", "from 1 to 16384"]),
        (&["--size", "99999x20"], &["--size", "from 1 to 16384"]),
        (&["--size", "huge"], &["--size", "`huge`", "1280x720"][..1]),
        (&["--size", "-5x5"], &["--size"]),
        (&["--frames", "-1"], &["--frames"]),
        (&["--frames", "many"], &["--frames", "many"]),
        (&["--time", "NaN"], &["--time", "seconds"]),
        (&["--time", "inf"], &["--time", "seconds"]),
        (&["--seed", "-1"], &["--seed"]),
        (
            &["--view", "ful"],
            &["--view", "full", "irradiance", "textures-off"],
        ),
        (&["--spp", "4"], &["--cpu"]),
        (&["--cpu", "--spp", "0"], &["--spp"]),
        (&["--cpu", "--view", "cage"], &["--view cage", "irradiance"]),
        (&["--cpu", "--view", "states"], &["--view states"]),
        (&["--cpu", "--view", "occlusion"], &["--view occlusion"]),
        (
            &["--view", "occlusion"],
            &["--view occlusion", "occlusion.lamps=1 or more", "--set"],
        ),
        (
            &["--set", "lights.shadows=field"],
            &["`lights.shadows=field`", "occlusion.lamps=1 or more"],
        ),
        (&["--set", "occlusion.lamps=9"], &["0 to 8", "`9`"]),
        (
            &["--probes", "light"],
            &["--probes", "irradiance", "state", "offset", "cascade"],
        ),
        (&["--cpu", "--probes", "state"], &["--probes", "--cpu"]),
        (&["--cpu", "--atlas", "irradiance:0"], &["--atlas", "--cpu"]),
        (&["--atlas", "depth:0"], &["irradiance:LAYER"]),
        (&["--atlas", "distance:-1"], &["distance:LAYER"]),
        (
            &["--atlas", "irradiance:0", "--probes", "state"],
            &["--atlas", "--probes"],
        ),
        (
            &["--atlas", "irradiance:0", "--view", "full"],
            &["--atlas", "--view"],
        ),
        (
            &["--set", "probes.ray=64"],
            &["probes.ray", "`probes.rays`"],
        ),
        (&["--set", "probes.rays=lots"], &["8 to 4096", "lots"]),
        (&["--set", "probes.hysteresis=NaN"], &["NaN"]),
        (
            &["--set", "probes.visibility=most"],
            &["chebyshev, exact, auto"],
        ),
        (&["--set", "probes.states=maybe"], &["off, on"]),
        (&["--set", "probes.rays"], &["KEY=VALUE"]),
        (
            &["--set", "lights.preset=nine"],
            &["lamp preset", "`nine`", "it has `"],
        ),
        (
            &["--camera", "nowhere"],
            &["camera", "`nowhere`", "it has `"],
        ),
        (
            &["--layout", "layout9"],
            &[
                "layout",
                "`layout9`",
                "`layout1`",
                "`layout4`",
                "Did you mean",
            ],
        ),
        (
            &["--adapter", "Voodoo 2"],
            &["Voodoo 2", "this machine has"],
        ),
        (&["--sizes", "8x8"], &["--sizes", "--size"]),
    ] {
        refused(
            grotto().args(["render", CAVE, "-o", picture]).args(flags),
            2,
            parts,
        );
    }
    assert!(listing(folder.path()).is_empty());
}

#[test]
fn a_layer_beyond_the_atlas_is_refused_with_how_many_there_are() {
    let folder = folder();
    let mut command = grotto();
    command
        .args([
            "render",
            MINIMAL,
            "--size",
            "8x8",
            "--atlas",
            "irradiance:1",
            "-o",
        ])
        .arg(folder.path().join("a.png"));
    refused(
        &mut command,
        2,
        &["the atlas of irradiance has 1 layer", "no layer 1"],
    );
    assert!(listing(folder.path()).is_empty());
}

#[test]
fn a_picture_beyond_the_limits_of_the_adapter_is_refused() {
    let info = run(&["info", "--json"]).json();
    let adapters = info["adapters"].as_array().expect("an array");
    let chosen = adapters
        .iter()
        .find(|one| one["chosen"] == true)
        .expect("an adapter");
    let limit = &chosen["limits"]["max_storage_buffer_binding_size"];
    // At 8 bytes per pixel. An adapter that can hold the picture would be busy for a while.
    if limit
        .as_u64()
        .is_some_and(|limit| limit < 16384 * 16384 * 8)
    {
        let folder = folder();
        let output = folder.path().join("a.png");
        let mut command = grotto();
        command
            .args(["render", MINIMAL, "--size", "16384x16384", "-o"])
            .arg(output);
        refused(&mut command, 2, &["a picture of this size", "--adapter"]);
        assert!(listing(folder.path()).is_empty());
    }
}

#[test]
fn outputs_that_cannot_be_written_are_refused_before_any_work() {
    let folder = folder();
    let file = folder.path().join("file");
    fs::write(&file, "mine").expect("writable");
    for (name, part) in [
        ("missing/a.png", "create it first"),
        ("file/a.png", "file"),
        ("a.jpg", ".png"),
        ("a", ".exr"),
        (&format!("{}.png", "a".repeat(300)), "name is too long"),
        // Its last bytes are added when it is complete.
        (&format!("{}.png", "a".repeat(250)), "name is too long"),
    ] {
        let output = folder.path().join(name);
        refused(
            grotto().args(["render", MINIMAL, "-o"]).arg(&output),
            2,
            &[part, name],
        );
    }
    refused(
        grotto().args(["render", MINIMAL, "-o"]).arg(folder.path()),
        2,
        &[".png"],
    );
    if cfg!(target_os = "linux") {
        refused(
            grotto().args(["render", MINIMAL, "-o", "/proc/a.png"]),
            2,
            &["/proc"],
        );
    }
    refused(grotto().args(["render", MINIMAL]), 2, &["--output"]);
    assert_eq!(listing(folder.path()), std::slice::from_ref(&file));
    assert_eq!(fs::read_to_string(file).expect("readable"), "mine");
}

#[test]
fn bad_world_files_are_refused_with_their_name() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    let minimal = fs::read_to_string(world_path(MINIMAL)).expect("readable");
    let broken = |with: &str| {
        let opening = minimal.find('(').expect("a world is a struct") + 1;
        format!("{}{with}{}", &minimal[..opening], &minimal[opening..])
    };
    let png = [
        0x89, b'P', b'N', b'G', b'\r', b'\n', 0x1a, b'\n', 0, 0, 0, 13,
    ];
    fs::write(path("empty.ron"), "").expect("writable");
    fs::write(path("png.ron"), png).expect("writable");
    fs::write(path("huge.ron"), vec![b' '; 100 << 20]).expect("writable");
    fs::write(path("unknown-key.ron"), broken(" colour_of_money: 3, ")).expect("writable");
    fs::write(path("half.ron"), &minimal[..minimal.len() / 2]).expect("writable");
    let before = listing(folder.path());
    for name in [
        "empty.ron",
        "png.ron",
        "huge.ron",
        "unknown-key.ron",
        "half.ron",
        "absent.ron",
        ".",
    ] {
        refused(grotto().arg("check").arg(path(name)), 2, &[name]);
        let output = path("a.png");
        refused(
            grotto().arg("render").arg(path(name)).arg("-o").arg(output),
            2,
            &[name],
        );
    }
    refused(
        grotto().arg("check").arg(path("unknown-key.ron")),
        2,
        &["colour_of_money"],
    );
    assert_eq!(listing(folder.path()), before, "something was left behind");
}

/// Every command reports a full disk in the same words, with the place and the remedy.
#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_reported_in_our_words() {
    for arguments in [
        &["check", MINIMAL][..],
        &["info", "--keys"],
        &["info", "--keys", "--json"],
    ] {
        let full = fs::OpenOptions::new().write(true).open("/dev/full");
        let output = grotto()
            .args(arguments)
            .stdout(full.expect("it is there"))
            .output()
            .expect("the binary starts");
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{stderr}");
        assert_eq!(
            stderr,
            "error: stdout: the disk is full; free some space or choose another disk\n"
        );
    }
}

#[test]
fn names_that_are_too_long_are_refused_before_any_work() {
    let folder = folder();
    let long = folder.path().join("a".repeat(300));
    let long = long.to_str().expect("UTF-8");
    let world = format!("{long}.ron");
    let picture = format!("{long}.png");
    for arguments in [
        &["check", &world][..],
        &["render", &world, "-o", "a.png"],
        &["render", MINIMAL, "--cpu", "-o", &picture],
        &["reference", MINIMAL, "-o", &picture],
        &["compare", &picture, &picture],
        &["judge", MINIMAL, "--out", long],
        &[
            "judge",
            &world,
            "--out",
            folder.path().to_str().expect("UTF-8"),
        ],
        &["stress", "--scenes", "1", "--out", long],
        &[
            "stress",
            "--world",
            &world,
            "--out",
            folder.path().to_str().expect("UTF-8"),
        ],
        &["bench", "layouts", MINIMAL, "--out", long],
        &["bench", "traversal", &world],
        &["bench", "diff", long, long],
        &["merge", long, "--out", long],
    ] {
        refused(
            grotto().args(arguments),
            2,
            &["name is too long", "shorter"],
        );
    }
    assert!(listing(folder.path()).is_empty());
}
