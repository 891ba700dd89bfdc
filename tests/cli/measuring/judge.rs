//! `grotto judge` on tiny pictures.

use std::{fs, path::Path};

use grotto::measure::{picture::Picture, picture_file};
use serde_json::Value;

use super::{Bench, FEW_FACES, command, number, output, root, text};

pub const SKIP: [&str; 2] = ["--skip-response", "--skip-stability"];
pub const CORNELL: &str = "worlds/cornell.ron";

#[test]
fn a_world_from_end_to_end() {
    let bench = Bench::new();
    let chosen = [
        "--camera", "inside", "--layout", "layout1", "--frames", "8", "--spp", "64",
    ];
    let watched = ["--response-frames", "24"];
    let (json, _) = bench.judged(&[&[CORNELL], &chosen[..], &watched, &FEW_FACES].concat());
    let rows = json["rows"].as_array().expect("rows");
    assert_eq!(rows.len(), 1);
    let row = &rows[0];
    assert_eq!([&row["world"], &row["camera"]], ["cornell", "inside"]);
    // There is light, and it is not that of another picture.
    let energy = number(row, "indirect.energy_ratio");
    assert!((0.6..1.6).contains(&energy), "{row}");
    let flip = number(row, "full.flip.mean");
    assert!(flip > 0.0 && flip < 0.35, "{row}");
    let stability = number(row, "stability.mean");
    assert!(stability > 0.0 && stability < 0.2, "{row}");
    let frames = number(row, "response.lamp_off.to_90");
    assert!((1.0..=24.0).contains(&frames), "{row}");
    // The reference has light everywhere.
    assert_eq!(row["leak_ratio"], Value::Null);

    let read = |name: &str| fs::read_to_string(bench.path("out").join(name)).expect("written");
    let written: Value = serde_json::from_str(&read("judge.json")).expect("JSON");
    assert_eq!(written, json);
    let csv = read("judge.csv");
    let cells: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(cells.len(), 2);
    assert_eq!(cells[0].len(), cells[1].len());
    let column = cells[0]
        .iter()
        .position(|name| *name == "flip_mean")
        .expect("a column");
    assert_eq!(cells[1][column].parse(), Ok(number(row, "full.flip.mean")));
    let page = read("judge.html");
    assert_eq!(page.matches("<img").count(), 6);
    assert_eq!(page.matches("src=\"data:image/jpeg;base64,/9j/").count(), 6);
    assert!(!page.contains("http"), "the page needs nothing else");
    assert!(page.contains("<td class=\"name\">cornell</td>"));
}

#[test]
fn a_sealed_room_shows_what_leaks_in() {
    let bench = Bench::new();
    let flags = ["worlds/sealed.ron", "--layout", "straddling"];
    let leak = |set: &[&str]| {
        let (json, _) = bench.judged(&[&flags[..], &SKIP, set].concat());
        let rows = json["rows"].as_array().expect("rows").clone();
        let of = |camera: &str| {
            let row = rows.iter().find(|row| row["camera"] == camera);
            row.expect("a row")["leak_ratio"].clone()
        };
        assert_eq!(of("bright"), Value::Null);
        of("dark").as_f64().expect("the dark room has no light")
    };
    // Without visibility probes light through walls: the planted fault.
    let (kept, leaking) = (
        leak(&["--set", "probes.visibility=chebyshev"]),
        leak(&[
            "--set",
            "probes.method=source",
            "--set",
            "source.weights=direction",
        ]),
    );
    assert!(leaking > 0.02, "{leaking}");
    assert!(kept < leaking / 10.0, "{kept} {leaking}");
    assert_eq!(leak(&["--set", "probes.visibility=exact"]), 0.0);
}

#[test]
fn noise_is_the_error_of_a_picture_without_any() {
    let bench = Bench::new();
    let flags = [CORNELL, "--camera", "inside", "--layout", "layout1"];
    let noise = |paths: &str| {
        let small = ["--size", "32x18", "--frames", "1", "--spp", paths];
        let (json, _) = bench.judged(&[&flags[..], &SKIP, &small].concat());
        json["rows"][0]["noise"].clone()
    };
    assert_eq!(noise("1"), Value::Null, "one path says nothing of noise");
    let [few, many] = ["16", "256"].map(|paths| number(&noise(paths), "indirect"));
    // The same paths by another tracer, against a reference that has hardly any noise.
    let traced = |name: &str, paths: &str| {
        let file = bench.path(name).display().to_string();
        let look = [
            "reference",
            CORNELL,
            "--camera",
            "inside",
            "--size",
            "32x18",
            "--view",
            "indirect",
        ];
        let arguments = [&look[..], &["--spp", paths, "-o", &file, "--quiet"]].concat();
        assert!(output(&mut command(root(), &arguments)).status.success());
    };
    traced("few.exr", "16");
    traced("many.exr", "8192");
    let error = number(&bench.compared(&["few.exr", "many.exr"]), "flip.mean");
    assert!((few / error - 1.0).abs() < 0.2, "{few} {error}");
    assert!(many < few / 2.0, "{many} {few}");
}

#[test]
fn both_tracers_say_the_same() {
    let bench = Bench::new();
    let ratio = |tracer: &str| {
        let flags = [
            "worlds/cornell.ron",
            "--camera",
            "inside",
            "--layout",
            "layout1",
        ];
        let small = ["--size", "32x18", "--spp", "128", "--against", tracer];
        let (json, _) = bench.judged(&[&flags[..], &SKIP, &small].concat());
        number(&json["rows"][0], "indirect.energy_ratio")
    };
    let (gpu, cpu) = (ratio("reference"), ratio("cpu"));
    // 74 thousand paths each: their energies differ by noise alone.
    assert!((gpu / cpu - 1.0).abs() < 0.05, "{gpu} {cpu}");
    assert_eq!(
        bench.references().len(),
        2,
        "one is not taken for the other"
    );
}

#[test]
fn a_mask_names_what_must_stay_dark() {
    let bench = Bench::new();
    let mut mask = Picture::new(64, 36);
    mask.rgb[..64].fill([1.0; 3]);
    let path = bench.path("mask.png");
    picture_file::write_png(&path, &mask).expect("writable");
    let named = format!("front={}", path.display());
    let chosen = [CORNELL, "--camera", "front", "--layout", "layout1"];
    let (json, _) = bench.judged(&[&chosen[..], &SKIP, &["--mask", &named]].concat());
    assert!(json["rows"][0]["leak_ratio"].is_number(), "{json}");

    mask.rgb.fill([0.0; 3]);
    picture_file::write_png(&path, &mask).expect("writable");
    let output = bench.judge(&[&chosen[..], &SKIP, &["--mask", &named]].concat());
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("marks no pixel"));
}

#[test]
fn references_are_kept_and_damaged_ones_traced_again() {
    let bench = Bench::new();
    let flags = [
        &[CORNELL, "--camera", "inside", "--layout", "layout1"],
        &SKIP[..],
        &FEW_FACES,
    ]
    .concat();
    let (first, _) = bench.judged(&flags);
    let kept = bench.references();
    assert_eq!(kept.len(), 1);
    let whole = fs::read(&kept[0]).expect("stored");
    let (second, said) = bench.judged(&flags);
    assert_eq!(first["rows"], second["rows"]);
    assert!(!said.contains("traced again"), "{said}");

    let mut damaged = whole.clone();
    *damaged.last_mut().expect("bytes") ^= 1;
    let version = b"another version";
    let mut other = b"grotto reference\n".to_vec();
    other.extend((version.len() as u32).to_le_bytes());
    other.extend(version);
    for (bytes, word) in [(damaged, "damaged"), (other, "another version")] {
        fs::write(&kept[0], bytes).expect("writable");
        let (again, said) = bench.judged(&flags);
        assert_eq!(first["rows"], again["rows"]);
        assert!(
            said.contains(word) && said.contains("traced again"),
            "{said}"
        );
        assert_eq!(fs::read(&kept[0]).expect("stored"), whole, "kept again");
    }
    // The reference of another picture is another file.
    bench.judged(&[&flags[..], &["--seed", "1"]].concat());
    assert_eq!(bench.references().len(), 2);
}

#[test]
fn a_bad_world_does_not_take_the_others_with_it() {
    let bench = Bench::new();
    let broken = bench.path("broken.ron");
    fs::write(&broken, "(title: ").expect("writable");
    let broken = broken.display().to_string();
    let flags = [
        &[&broken, CORNELL, "--camera", "front", "--layout", "layout1"],
        &SKIP[..],
    ];
    let output = bench.judge(&[&flags.concat()[..], &["--json"]].concat());
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    let json: Value = serde_json::from_str(&text(&output.stdout)).expect("one JSON object");
    assert_eq!(json["rows"].as_array().map(Vec::len), Some(1));
    assert_eq!(json["failures"].as_array().map(Vec::len), Some(1));
    let said = text(&output.stderr);
    assert!(
        said.contains("1 of 2 worlds") && said.contains("broken.ron"),
        "{said}"
    );
    let page = fs::read_to_string(bench.path("out").join("judge.html")).expect("written");
    assert!(page.contains("broken.ron"));
}

#[test]
fn bad_flags_are_refused_before_any_work() {
    let bench = Bench::new();
    for (flags, parts) in [
        (
            &[CORNELL, "--camera", "nowhere"][..],
            &["`nowhere`", "`front`"][..],
        ),
        (
            &[CORNELL, "--layout", "layout9"],
            &["`layout9`", "`layout1`"],
        ),
        (&[CORNELL, "--spp", "0"], &["--spp", "1"]),
        (&[CORNELL, "--rays", "8,many"], &["8 to 4096", "many"]),
        (&[CORNELL, "--response-frames", "3"], &["16"]),
        (&[CORNELL, "--mask", "front"], &["CAMERA=FILE"]),
        (
            &[CORNELL, "--mask", "front=none.png"],
            &["none.png", "no such file"],
        ),
        (&[CORNELL, "--no-cache"], &["--cache"]),
        (
            &[CORNELL, "--vary", "probes.relocation=off,sometimes"],
            &["--vary", "`probes.relocation`", "exact", "`sometimes`"],
        ),
        (
            &[CORNELL, "--vary", "textures.enabled=on,off"],
            &["`textures.enabled`", "--set"],
        ),
        (
            &[CORNELL, "--vary", "probes.rays=8,16"],
            &["`probes.rays` varies twice"],
        ),
        (&[CORNELL, "--page-pictures", "-1"], &["0..=4096"]),
        (&["no/world.ron"], &["no/world.ron"]),
    ] {
        let output = bench.judge(flags);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{flags:?}: {said}");
        for part in parts {
            assert!(said.contains(part), "{flags:?}: no {part} in {said}");
        }
        assert_eq!(text(&output.stdout), "", "{flags:?}");
    }
    assert!(
        !Path::new(&bench.path("cache")).exists(),
        "nothing was traced"
    );
}
