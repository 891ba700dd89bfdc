//! `grotto judge --displayed`: edges count, on both sides.

use super::{
    Bench, FEW_FACES,
    judge::{CORNELL, SKIP},
    number, object, text,
};

const MINIMAL: &str = "worlds/minimal.ron";
const SMALL: [&str; 6] = [
    "--size",
    "96x54",
    "--frames",
    "120",
    "--against",
    "reference",
];

#[test]
fn edges_are_judged_and_what_players_see_of_them_is_smooth() {
    let bench = Bench::new();
    let flip = |flags: &[&str]| {
        let (json, _) = bench.judged(&[&[MINIMAL], &SKIP[..], &SMALL, flags].concat());
        assert_eq!(json["displayed"], flags.contains(&"--displayed"));
        number(&json["rows"][0], "full.flip.mean")
    };
    // With few paths the references' noise would be most of either figure.
    let many = ["--spp", "512"];
    let displayed = flip(&[&many[..], &["--displayed"]].concat());
    let references = bench.references().len();
    let at_centres = flip(&many);
    assert_eq!(
        bench.references().len(),
        2 * references,
        "its own references"
    );

    // The same picture with jagged edges, by the same light.
    let [jagged, truth] = ["jagged.exr", "truth.exr"].map(|name| bench.path(name));
    let [jagged, truth] = [&jagged, &truth].map(|path| path.to_str().expect("a plain path"));
    let run = |arguments: &[&str]| {
        let output = super::grotto(arguments);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    };
    let picture = ["--size", "96x54", "--set", "probes.rays=32"];
    let off = ["--frames", "120", "--set", "picture.antialias=off"];
    run(&[&["render", MINIMAL, "-o", jagged], &picture[..], &off].concat());
    let smooth = ["--spp", "512", "--antialias"];
    run(&[&["reference", MINIMAL, "-o", truth], &picture[..2], &smooth].concat());
    let compared = object(&bench.compare(&[jagged, truth, "--json"]));
    let jagged = number(&compared, "flip.mean");
    assert!(
        jagged > 2.0 * at_centres,
        "edges are an error of their own: {jagged} {at_centres}"
    );
    assert!(
        displayed - at_centres < 0.3 * (jagged - at_centres),
        "and a small one where they are smooth: {displayed} {at_centres} {jagged}"
    );
}

#[test]
fn what_is_displayed_is_judged_in_motion_too() {
    let bench = Bench::new();
    let moved = [
        "--motion",
        "--edits",
        "--motion-frames",
        "20",
        "--moments",
        "1",
    ];
    let cornell = [CORNELL, "--camera", "inside", "--layout", "layout1"];
    let tiny = ["--size", "48x27", "--frames", "20", "--spp", "16"];
    let moving = ["--set", "lights.preset=moving", "--against", "reference"];
    let flags = [
        &cornell[..],
        &SKIP,
        &tiny,
        &moving,
        &FEW_FACES,
        &moved,
        &["--displayed"],
    ]
    .concat();
    let (json, _) = bench.judged(&flags);
    let motions = json["rows"][0]["motion"].as_array().expect("motions");
    assert_eq!(motions.len(), 5);
    for motion in motions {
        for moment in motion["moments"].as_array().expect("moments") {
            let flip = number(moment, "full.flip.mean");
            assert!(flip > 0.0 && flip < 0.3, "{motion}");
        }
    }
    assert!(bench.result("judge.md").contains("anti-aliased"));
}

#[test]
fn what_is_not_displayed_cannot_be_judged() {
    let bench = Bench::new();
    let output = bench.judge(&[MINIMAL, "--displayed", "--set", "picture.antialias=off"]);
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("--displayed") && said.contains("picture.antialias=off"));
    let output = bench.judge(&[MINIMAL, "--set", "picture.scale=0.5"]);
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("--displayed") && said.contains("picture.scale=0.5"));
    assert!(!bench.path("cache").exists(), "nothing was traced");
}
