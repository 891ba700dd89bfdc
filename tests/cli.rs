//! The command line, driven as a user drives it.

use std::{
    fs,
    io::Read as _,
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

use serde_json::Value;
use tempfile::{TempDir, tempdir};

/// What a command left behind.
struct Ended {
    code: i32,
    stdout: String,
    stderr: String,
}

impl Ended {
    /// The one JSON object on stdout.
    fn json(&self) -> Value {
        assert_eq!(self.stdout.lines().count(), 1, "{}", self.stdout);
        serde_json::from_str(&self.stdout).expect("one JSON object")
    }
}

fn grotto() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_grotto"));
    command.current_dir(env!("CARGO_MANIFEST_DIR"));
    command
}

/// A machine whose Vulkan loader finds no driver.
fn grotto_without_gpu() -> Command {
    let mut command = grotto();
    for variable in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"] {
        command.env(variable, "/nowhere/at/all.json");
    }
    command
}

fn end(command: &mut Command) -> Ended {
    let output = command
        .stdin(Stdio::null())
        .output()
        .expect("the binary starts");
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).expect("UTF-8");
    Ended {
        code: output.status.code().expect("no signal"),
        stdout: text(&output.stdout),
        stderr: text(&output.stderr),
    }
}

fn run(arguments: &[&str]) -> Ended {
    end(grotto().args(arguments))
}

/// Ends with this code, nothing on stdout, and one message with these parts.
fn refused(command: &mut Command, code: i32, parts: &[&str]) {
    let ended = end(command);
    assert_eq!(ended.code, code, "{command:?}\n{}", ended.stderr);
    assert_eq!(ended.stdout, "", "{command:?}");
    for part in parts {
        assert!(
            ended.stderr.contains(part),
            "{command:?}: no `{part}` in\n{}",
            ended.stderr
        );
    }
    for noise in ["panicked", "RUST_BACKTRACE", "bug in grotto"] {
        assert!(!ended.stderr.contains(noise), "{}", ended.stderr);
    }
}

/// What lies in a folder, sorted.
fn listing(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("a folder");
    let mut paths: Vec<PathBuf> = entries
        .map(|entry| entry.expect("an entry").path())
        .collect();
    paths.sort();
    paths
}

fn folder() -> TempDir {
    tempdir().expect("a temporary folder")
}

fn world_files() -> Vec<PathBuf> {
    let all = listing(&Path::new(env!("CARGO_MANIFEST_DIR")).join("worlds"));
    all.into_iter()
        .filter(|path| path.extension().is_some_and(|e| e == "ron"))
        .collect()
}

const CAVE: &str = "worlds/cave.ron";
const MINIMAL: &str = "worlds/minimal.ron";

#[test]
fn without_arguments_it_says_what_it_is() {
    let ended = run(&[]);
    assert_eq!(ended.code, 0);
    assert_eq!(ended.stderr, "");
    for part in ["grotto render worlds/cave.ron", "worlds/", "--help"] {
        assert!(ended.stdout.contains(part), "{}", ended.stdout);
    }
    assert!(ended.stdout.lines().count() < 15);
}

#[test]
fn help_lists_what_there_is_and_nothing_else() {
    let ended = run(&["--help"]);
    assert_eq!(ended.code, 0);
    for command in ["render", "compare", "judge", "check", "info"] {
        assert!(ended.stdout.contains(command), "{}", ended.stdout);
    }
    let later = "stress";
    assert!(!ended.stdout.contains(later), "{}", ended.stdout);
    assert_eq!(run(&[later]).code, 2);
    for command in ["render", "compare", "judge", "check", "info"] {
        assert_eq!(run(&[command, "--help"]).code, 0);
    }
}

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
        (
            &["--set", "probes.ray=64"],
            &["probes.ray", "`probes.rays`"],
        ),
        (&["--set", "probes.rays=lots"], &["8 to 4096", "lots"]),
        (&["--set", "probes.hysteresis=NaN"], &["NaN"]),
        (&["--set", "probes.visibility=exact"], &["not yet"]),
        (&["--set", "probes.states=on"], &["not yet"]),
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
fn a_picture_beyond_the_limits_of_the_adapter_is_refused() {
    let info = run(&["info", "--json"]).json();
    let adapters = info["adapters"].as_array().expect("an array");
    let chosen = adapters
        .iter()
        .find(|one| one["chosen"] == true)
        .expect("an adapter");
    let limit = &chosen["limits"]["max_storage_buffer_binding_size"];
    // At 8 bytes a pixel; an adapter that can hold it would be busy for a while.
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

fn world_path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

#[test]
fn every_world_passes_the_check_and_one_bad_file_is_counted() {
    let worlds = world_files();
    assert!(worlds.len() >= 6, "{worlds:?}");
    let ended = end(grotto().arg("check").args(&worlds));
    assert_eq!(ended.code, 0, "{}", ended.stderr);
    assert_eq!(ended.stdout.matches(": ok. ").count(), worlds.len());

    let ended = end(grotto().args(["check", MINIMAL, "worlds/none.ron", CAVE]));
    assert_eq!(ended.code, 2);
    assert_eq!(ended.stdout.matches(": ok. ").count(), 2);
    for part in ["worlds/none.ron", "1 of 3"] {
        assert!(ended.stderr.contains(part), "{}", ended.stderr);
    }
}

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

/// Renders the cave small, twice and with `extra`, and holds both pictures equal byte for byte.
/// Gives the picture and the first run.
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
    for pass in ["camera_rays", "probe_rays", "probe_blend", "shade"] {
        assert!(
            record["passes"][pass].is_number(),
            "{pass}: {}",
            record["passes"]
        );
    }
    assert_eq!(record["rays"]["camera"], 48 * 32);
    let shadow = record["rays"]["shadow"].as_u64().expect("a number");
    let probe = record["rays"]["probe"].as_u64().expect("a number");
    // One lamp and the sun.
    assert!(shadow > 0 && shadow <= 2 * (48 * 32 + probe), "{shadow}");
    assert_eq!(record["probes"]["total"], 7 * 5 * 5);
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
fn bench_traversal_measures_rows_and_writes_them() {
    let folder = folder();
    let out = folder.path().join("new");
    let ended = end(grotto()
        .args([
            "bench",
            "traversal",
            MINIMAL,
            "--size",
            "32x16",
            "--repeats",
            "1",
            "--json",
        ])
        .arg("--out")
        .arg(&out));
    assert_eq!(ended.code, 0, "{}", ended.stderr);
    let record = ended.json();
    let written = fs::read_to_string(out.join("traversal.json")).expect("the record");
    let written: Value = serde_json::from_str(&written).expect("JSON");
    assert_eq!(written, record);
    let rows = record["rows"].as_array().expect("an array");
    for kind in ["camera", "shadow", "probe"] {
        let row = rows.iter().find(|row| row["rays"] == kind).expect(kind);
        assert_eq!(row["mismatches"], 0);
        assert!(
            row["grays_per_s"].as_f64().is_some_and(|rate| rate > 0.0),
            "{row}"
        );
    }
    refused(
        grotto().args(["bench", "traversal", "worlds/none.ron"]),
        2,
        &["worlds/none.ron"],
    );
    refused(grotto().args(["bench", "layout"]), 2, &["layout"]);
    let file = folder.path().join("file");
    fs::write(&file, "").expect("writable");
    refused(
        grotto()
            .args(["bench", "traversal", MINIMAL, "--out"])
            .arg(&file),
        2,
        &["file"],
    );
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
