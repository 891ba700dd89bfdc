//! `grotto compare`, run as a user runs it.

use std::{fs, path::Path};

use grotto::measure::{
    comparison::{Shown, compare},
    picture::Picture,
    picture_file,
    selection::Selection,
};

use super::{Bench, number, text};

fn scene() -> Picture {
    let rgb = (0..48 * 27).map(|i| {
        let (x, y) = ((i % 48) as f32, (i / 48) as f32);
        [0.02 * x + 0.05, 0.03 * y, 0.4 + 0.2 * (x * 0.7).sin()]
    });
    Picture {
        width: 48,
        height: 27,
        rgb: rgb.collect(),
    }
}

fn changed(change: impl Fn(&mut Picture)) -> Picture {
    let mut picture = scene();
    change(&mut picture);
    picture
}

#[test]
fn the_figures_are_those_of_the_metrics_and_of_the_hand() {
    let bench = Bench::new();
    let darkened = changed(|p| p.rgb.iter_mut().flatten().for_each(|value| *value *= 0.9));
    bench.write("a.exr", &darkened);
    bench.write("b.exr", &scene());
    let json = bench.compared(&["a.exr", "b.exr"]);
    assert!((number(&json, "energy_ratio") - 0.9).abs() < 1e-6, "{json}");
    assert_eq!(json["size"], serde_json::json!([48, 27]));
    let shown = |picture| Shown::from_linear(picture, 0.0);
    let (expected, _) = compare(&shown(darkened), &shown(scene()), &Selection::ALL).expect("fits");
    for name in [
        "flip.mean",
        "flip.p99",
        "flip.max",
        "abs_sum.mean",
        "abs_sum.max",
        "rel_mse",
    ] {
        let value = number(&json, name);
        assert!(value > 0.0 && (value - expected.metric(name).expect(name)).abs() < 1e-12);
    }
    let same = bench.compared(&["b.exr", "b.exr"]);
    assert_eq!(number(&same, "flip.max"), 0.0);
    assert_eq!(number(&same, "energy_ratio"), 1.0);
    let spoken = text(&bench.compare(&["a.exr", "b.exr"]).stdout);
    assert!(spoken.contains("energy ratio        0.90000"), "{spoken}");
}

#[test]
fn every_planted_fault_is_found() {
    let bench = Bench::new();
    bench.write("truth.exr", &scene());
    bench.write("truth.png", &scene());
    for (name, fault) in [
        (
            "darkened",
            changed(|p| p.rgb.iter_mut().flatten().for_each(|v| *v *= 0.9)),
        ),
        ("shifted", changed(|p| p.rgb.rotate_right(1))),
        (
            "swapped",
            changed(|p| p.rgb.iter_mut().for_each(|rgb| rgb.swap(0, 2))),
        ),
    ] {
        for extension in ["exr", "png"] {
            let (file, truth) = (format!("{name}.{extension}"), format!("truth.{extension}"));
            bench.write(&file, &fault);
            let output = bench.compare(&[&file, &truth, "--fail-over", "flip.mean=0.005"]);
            assert_eq!(output.status.code(), Some(4), "{file}: {output:?}");
        }
    }
}

#[test]
fn a_png_and_an_exr_of_the_same_picture_look_the_same() {
    let bench = Bench::new();
    bench.write("a.png", &scene());
    bench.write("a.exr", &scene());
    for pair in [["a.png", "a.exr"], ["a.exr", "a.png"]] {
        let json = bench.compared(&pair);
        assert_eq!(number(&json, "flip.max"), 0.0, "{json}");
        assert_eq!(number(&json, "abs_sum.max"), 0.0, "{json}");
    }
    // One stop brighter is another picture.
    let brighter = bench.compared(&["a.exr", "a.png", "--exposure", "1"]);
    assert!(number(&brighter, "flip.mean") > 0.05, "{brighter}");
}

#[test]
fn regions_and_masks_choose_what_counts() {
    let bench = Bench::new();
    bench.write("a.exr", &scene());
    bench.write("b.exr", &changed(|p| p.rgb[0] = [9.0; 3]));
    let mut mask = Picture::new(48, 27);
    mask.rgb[47] = [1.0; 3];
    bench.write("far.exr", &mask);
    mask.rgb = vec![[0.0; 3]; mask.rgb.len()];
    mask.rgb[0] = [0.0, 1.0, 0.0];
    picture_file::write_png(&bench.path("near.png"), &mask).expect("writable");
    for (flags, pixels, differs) in [
        (["--region", "0,0,1x1"], 1, true),
        (["--region", "1,0,47x27"], 47 * 27, false),
        (["--mask", "near.png"], 1, true),
        (["--mask", "far.exr"], 1, false),
    ] {
        let json = bench.compared(&[&["a.exr", "b.exr"], &flags[..]].concat());
        assert_eq!(json["pixels"], pixels, "{flags:?}");
        assert_eq!(
            number(&json, "abs_sum.max") > 0.0,
            differs,
            "{flags:?}: {json}"
        );
    }
}

#[test]
fn gates_end_with_four_and_one_line_each() {
    let bench = Bench::new();
    bench.write(
        "a.exr",
        &changed(|p| p.rgb.iter_mut().flatten().for_each(|v| *v *= 1.5)),
    );
    bench.write("b.exr", &scene());
    let gates = [
        "flip.mean=0.001",
        "energy_ratio=1.2",
        "energy_error=0.1",
        "abs_sum.max=2.9",
    ];
    let flags: Vec<&str> = gates
        .iter()
        .flat_map(|gate| ["--fail-over", gate])
        .collect();
    let output = bench.compare(&[&["a.exr", "b.exr", "--json"], &flags[..]].concat());
    assert_eq!(output.status.code(), Some(4), "{output:?}");
    assert_eq!(
        text(&output.stdout).lines().count(),
        1,
        "the figures are still given"
    );
    let message = text(&output.stderr);
    assert_eq!(message.lines().count(), 3, "{message}");
    for part in [
        "flip.mean is 0.",
        "energy_ratio is 1.5",
        "energy_error is 0.5",
    ] {
        assert!(message.contains(part), "{message}");
    }
    let kept = bench.compare(&["a.exr", "b.exr", "--fail-over", "energy_ratio=1.6"]);
    assert_eq!(kept.status.code(), Some(0));
    // Light against black has no finite ratio; the gate must not treat that as small.
    bench.write("black.exr", &Picture::new(48, 27));
    let dark = bench.compare(&["a.exr", "black.exr", "--fail-over", "energy_error=100"]);
    assert_eq!(dark.status.code(), Some(4), "{dark:?}");
}

#[test]
fn a_heat_map_shows_where() {
    let bench = Bench::new();
    bench.write("a.exr", &scene());
    bench.write("b.exr", &changed(|p| p.rgb[13 * 48 + 24] = [9.0; 3]));
    bench.compared(&["a.exr", "b.exr", "--heatmap", "map.png"]);
    let (map, _) = picture_file::read(&bench.path("map.png")).expect("a picture");
    let brightness = |x: usize, y: usize| map.rgb[y * 48 + x].iter().sum::<f32>();
    assert_eq!((map.width, map.height), (48, 27));
    let (there, elsewhere) = (brightness(24, 13), brightness(0, 0));
    assert!(there > 0.4 && elsewhere < 0.1, "{there} {elsewhere}");
    let names = || fs::read_dir(bench.folder()).expect("a folder").count();
    let before = names();
    bench.refused(
        &["a.exr", "b.exr", "--heatmap", "map.exr"],
        2,
        &["map.exr", ".png"],
    );
    bench.refused(
        &["a.exr", "b.exr", "--heatmap", "no/map.png"],
        2,
        &["no/map.png", "create"],
    );
    assert_eq!(names(), before, "nothing is left behind");
}

#[test]
fn bad_input_is_refused_with_the_place_and_a_remedy() {
    let bench = Bench::new();
    bench.write("a.exr", &scene());
    bench.write("a.png", &scene());
    bench.write("small.exr", &Picture::new(8, 8));
    bench.write("none.exr", &Picture::new(48, 27));
    for (name, bad) in [("nan.exr", f32::NAN), ("inf.exr", f32::INFINITY)] {
        bench.write(name, &changed(|p| p.rgb[5 * 48 + 7][1] = bad));
    }
    let whole = fs::read(bench.path("a.exr")).expect("written");
    fs::write(bench.path("cut.exr"), &whole[..whole.len() / 2]).expect("writable");
    let whole = fs::read(bench.path("a.png")).expect("written");
    fs::write(bench.path("cut.png"), &whole[..whole.len() / 2]).expect("writable");
    fs::write(bench.path("words.png"), "not a picture").expect("writable");
    fs::write(bench.path("empty.exr"), "").expect("writable");
    fs::write(bench.path("a.txt"), "words").expect("writable");
    for (arguments, parts) in [
        (
            &["a.exr", "small.exr"][..],
            &["a.exr is 48×27", "small.exr is 8×8", "--size"][..],
        ),
        (
            &["nan.exr", "a.exr"],
            &["nan.exr", "pixel (7, 5)", "green NaN"],
        ),
        (
            &["a.exr", "inf.exr"],
            &["inf.exr", "pixel (7, 5)", "green inf"],
        ),
        (
            &["cut.exr", "a.exr"],
            &["cut.exr", "not a picture that can be read"],
        ),
        (
            &["a.png", "cut.png"],
            &["cut.png", "not a picture that can be read"],
        ),
        (&["words.png", "a.png"], &["words.png", "not a picture"]),
        (&["a.exr", "empty.exr"], &["empty.exr", "not a picture"]),
        (&["a.txt", "a.exr"], &["a.txt", ".png", ".exr"]),
        (&["a.exr", "missing.exr"], &["missing.exr", "no such file"]),
        (
            &["a.exr", "a.exr", "--mask", "none.exr"],
            &["none.exr", "marks no pixel"],
        ),
        (
            &["a.exr", "a.exr", "--mask", "small.exr"],
            &["small.exr", "8×8", "48×27"],
        ),
        (
            &["a.exr", "a.exr", "--mask", "nan.exr"],
            &["nan.exr", "pixel (7, 5)"],
        ),
        (
            &["a.exr", "a.exr", "--region", "40,0,9x1"],
            &["40,0,9x1", "48×27"],
        ),
        (&["a.exr", "a.exr", "--region", "0,0,0x1"], &["0,0,0x1"]),
        (
            &["a.exr", "a.exr", "--region", "here"],
            &["X,Y,WIDTHxHEIGHT"],
        ),
        (
            &["a.exr", "a.exr", "--fail-over", "flip.mein=1"],
            &["flip.mein", "`flip.mean`"],
        ),
        (
            &["a.exr", "a.exr", "--fail-over", "rel_mse=low"],
            &["`low`", "number"],
        ),
        (&["a.exr", "a.exr", "--exposure", "NaN"], &["stops"]),
        (&["a.exr"], &["<B>"]),
    ] {
        bench.refused(arguments, 2, parts);
    }
}

/// Whatever part of an EXR is missing or flipped: a message or a picture, never a panic.
#[test]
fn damaged_files_end_in_a_message() {
    let folder = crate::folder();
    let path = folder.path().join("a.exr");
    picture_file::write_exr(&path, &scene()).expect("writable");
    let whole = fs::read(&path).expect("written");
    let mut refused = 0;
    for end in (0..whole.len()).step_by(whole.len() / 60 + 1) {
        refused += u32::from(read(&path, &whole[..end]).is_err());
    }
    assert!(refused > 40, "cut files must not be taken for whole ones");
    for at in (0..whole.len()).step_by(whole.len() / 300 + 1) {
        let mut flipped = whole.clone();
        flipped[at] ^= 0x55;
        // Either result is fine: a flipped bit in the pixels gives another picture.
        let _ = read(&path, &flipped);
    }
}

fn read(path: &Path, bytes: &[u8]) -> Result<(), picture_file::PictureError> {
    fs::write(path, bytes).expect("writable");
    picture_file::read(path).map(|_| ())
}
