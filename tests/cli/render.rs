//! `grotto render`: pictures and their records.

use std::{fs, process::Command};

use crate::{CAVE, Ended, MINIMAL, end, folder, grotto, grotto_without_gpu, listing};

/// Renders the cave small, twice and with `extra`, and asserts that both pictures are equal byte for byte.
/// Returns the picture and the first run.
fn render_twice(command: fn() -> Command, extra: &[&str]) -> (Vec<u8>, Ended) {
    let folder = folder();
    let mut first = None;
    for name in ["a", "b"] {
        let output = folder.path().join(name).with_extension("png");
        let ended = end(command()
            .args(["render", CAVE, "--size", "48x32", "--json", "-o"])
            .arg(&output)
            .args(extra));
        assert_eq!(ended.code, 0, "{}", ended.stderr);
        let bytes = fs::read(&output).expect("the picture");
        match &first {
            None => first = Some((bytes, ended)),
            Some((expected, _)) => assert!(bytes == *expected, "two runs differ"),
        }
    }
    assert_eq!(
        listing(folder.path()).len(),
        2,
        "more than the pictures was left"
    );
    first.expect("it ran")
}

#[test]
fn a_picture_from_the_gpu_with_its_record() {
    let extra = [
        "--frames",
        "3",
        "--layout",
        "layout1",
        "--set",
        "probes.rays=32",
    ];
    let (png, ended) = render_twice(grotto, &extra);
    let record = ended.json();
    let decoded = image::load_from_memory(&png).expect("a PNG").into_rgb8();
    assert_eq!(decoded.dimensions(), (48, 32));
    let brightest = decoded.pixels().map(|pixel| pixel.0[1]).max();
    let darkest = decoded.pixels().map(|pixel| pixel.0[1]).min();
    assert_ne!(brightest, darkest, "a picture of nothing");

    let fields = record.as_object().expect("an object");
    let expected = [
        "world",
        "camera",
        "layout",
        "view",
        "size",
        "frames",
        "adapter",
        "fps",
        "frame_ms",
        "passes",
        "rays",
        "mrays_per_s",
        "probes",
        "memory_bytes",
        "build",
    ];
    let mut rest = ended.stdout.as_str();
    for field in expected {
        assert!(fields.contains_key(field), "{field}");
        let at = rest.find(&format!("\"{field}\":"));
        rest = &rest[at.unwrap_or_else(|| panic!("{field} is out of order in {}", ended.stdout))..];
    }
    assert_eq!(fields.len(), expected.len());
    let probes = &record["probes"];
    let [total, alive, sleeping, dead, back_side] =
        ["total", "alive", "sleeping", "dead", "back_side"]
            .map(|key| probes[key].as_u64().expect("a count"));
    assert_eq!(alive + sleeping + dead, total, "{probes}");
    let cave = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(CAVE);
    let cave = grotto::world::file::load(&cave, &Default::default()).expect("sound");
    let mut layouts = cave.layouts.iter();
    let layout = layouts.find(|layout| layout.name == "layout1");
    let of_layout = layout.map_or(0, |layout| u64::from(layout.counts.element_product()));
    assert_eq!(total - back_side, of_layout, "{probes}");
    assert!(back_side > 0, "{probes}");
    assert_eq!(record["world"], "cave");
    assert_eq!(record["layout"], "layout1");
    assert_eq!(record["view"], "full");
    assert_eq!(record["size"], serde_json::json!([48, 32]));
    assert_eq!(record["frames"], 3);
    for field in ["name", "kind", "driver", "backend"] {
        assert!(record["adapter"][field].is_string(), "{field}");
    }
    for field in ["median", "p99", "low1_fps"] {
        assert!(
            record["frame_ms"][field]
                .as_f64()
                .is_some_and(|value| value > 0.0),
            "{field}"
        );
    }
    assert!(record["fps"].as_f64().is_some_and(|fps| fps > 0.0));
    for pass in [
        "view/camera_rays",
        "probes/trace",
        "probes/blend",
        "view/shade",
    ] {
        assert!(
            record["passes"][pass].is_number(),
            "{pass}: {}",
            record["passes"]
        );
    }
    assert_eq!(record["rays"]["camera"], 48 * 32);
    let shadow = record["rays"]["shadow"].as_u64().expect("a number");
    let probe = record["rays"]["probe"].as_u64().expect("a number");
    let face = record["rays"]["face"].as_u64().expect("a number");
    // One lamp and the sun.
    assert!(
        shadow > 0 && shadow <= 2 * (48 * 32 + probe + face),
        "{shadow}"
    );
    assert!(face > 0 && face.is_multiple_of(32), "{face}");
    // Probes of the lattice, and back-side probes.
    let total = record["probes"]["total"].as_u64().expect("a number");
    assert!((7 * 5 * 5..=2 * 7 * 5 * 5).contains(&total), "{total}");
    for field in ["voxels", "probes", "total"] {
        assert!(
            record["memory_bytes"][field]
                .as_u64()
                .is_some_and(|bytes| bytes > 0),
            "{field}"
        );
    }
}

#[test]
fn probes_and_their_maps_are_drawn_where_they_are_asked_for() {
    let folder = folder();
    let picture = |name: &str, flags: &[&str]| {
        let output = folder.path().join(name);
        let ended = end(grotto()
            .args(["render", MINIMAL, "--size", "48x32", "--frames", "1"])
            .args(["--set", "probes.rays=8", "--json", "-o"])
            .arg(&output)
            .args(flags));
        assert_eq!(ended.code, 0, "{}", ended.stderr);
        (fs::read(&output).expect("the picture"), ended.json())
    };
    let (plain, record) = picture("plain.png", &[]);
    assert!(record["passes"]["view/probe_draw"].is_null());
    for (name, flags, pass) in [
        ("states.png", &["--view", "states"][..], "view/state_view"),
        ("probes.png", &["--probes", "state"], "view/probe_draw"),
        (
            "atlas.png",
            &[
                "--atlas",
                "distance:0",
                "--set",
                "probes.visibility=chebyshev",
            ],
            "view/atlas_view",
        ),
        ("atlas.exr", &["--atlas", "irradiance:0"], "view/atlas_view"),
    ] {
        let (bytes, record) = picture(name, flags);
        assert!(bytes != plain, "{name} is the plain picture");
        assert!(record["passes"][pass].is_number(), "{}", record["passes"]);
    }
}

#[test]
fn another_seed_gives_another_picture() {
    let folder = folder();
    let picture = |seed: &str| {
        let output = folder.path().join(seed).with_extension("exr");
        let ended = end(grotto()
            .args([
                "render", MINIMAL, "--size", "32x16", "--frames", "0", "--view", "indirect",
            ])
            .args(["--set", "probes.rays=8", "--seed", seed, "-o"])
            .arg(&output));
        assert_eq!(ended.code, 0, "{}", ended.stderr);
        fs::read(&output).expect("the picture")
    };
    assert!(picture("1") != picture("2"), "the seed changes nothing");
}

#[test]
fn the_cpu_needs_no_gpu() {
    let (png, ended) = render_twice(grotto_without_gpu, &["--cpu", "--spp", "2"]);
    let record = ended.json();
    let decoded = image::load_from_memory(&png).expect("a PNG");
    assert_eq!((decoded.width(), decoded.height()), (48, 32));
    assert_eq!(record["adapter"]["backend"], "cpu");
    assert!(record["layout"].is_null());
}

#[test]
fn quiet_and_json_keep_the_streams_clean() {
    let folder = folder();
    let output = folder.path().join("a.exr");
    let render = |flags: &[&str]| {
        end(grotto_without_gpu()
            .args([
                "render", MINIMAL, "--cpu", "--spp", "1", "--size", "8x8", "-o",
            ])
            .arg(&output)
            .args(flags))
    };
    let quiet = render(&["--quiet"]);
    assert_eq!(
        (quiet.code, quiet.stdout.as_str(), quiet.stderr.as_str()),
        (0, "", "")
    );
    let json = render(&["--json", "--quiet"]);
    assert_eq!((json.code, json.stderr.as_str()), (0, ""));
    assert_eq!(json.json()["world"], "minimal");
    let noted = render(&["--layout", "none-such"]);
    assert_eq!(noted.code, 2);
    let noted = render(&["--frames", "9"]);
    assert!(
        noted.stderr.contains("--frames changes nothing with --cpu"),
        "{}",
        noted.stderr
    );
}

/// A command with nothing to save ends at once, with the code that shells use for a program ended by Ctrl-C.
#[test]
#[cfg(unix)]
fn a_signal_ends_it_with_130() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("a.png");
    for signal in ["-INT", "-TERM"] {
        let mut child = crate::grotto()
            .args([
                "render",
                "worlds/cavern.ron",
                "--cpu",
                "--size",
                "4000x4000",
            ])
            .arg("-o")
            .arg(&path)
            .stdout(std::process::Stdio::null())
            .stderr(std::process::Stdio::null())
            .spawn()
            .expect("the binary starts");
        std::thread::sleep(std::time::Duration::from_secs(2));
        let sent = std::process::Command::new("kill")
            .args([signal, &child.id().to_string()])
            .status();
        assert!(sent.expect("kill is there").success());
        let status = child.wait().expect("it ends");
        assert_eq!(status.code(), Some(130), "{signal}: {status}");
        let left = std::fs::read_dir(folder.path()).expect("readable").count();
        assert_eq!(left, 0);
    }
}
