//! The suites of `grotto bench` that measure how stable light is and how quickly it responds.

use std::fs;

use serde_json::Value;

use super::{Bench, grotto, judge::CORNELL, number, object, text};

#[test]
fn more_rays_are_steadier() {
    let layout = ["--layout", "layout1"];
    let flags = [
        "--size", "32x18", "--frames", "30", "--rays", "8,64", "--json",
    ];
    let output = grotto(&[&["bench", "stability", CORNELL], &flags[..], &layout].concat());
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let json: Value = serde_json::from_str(&text(&output.stdout)).expect("one JSON object");
    let mean = |row: usize| number(&json["rows"][row], "stability.mean");
    assert_eq!(
        [&json["rows"][0]["rays"], &json["rows"][1]["rays"]],
        [8, 64]
    );
    assert!(mean(1) < mean(0) && mean(1) > 0.0, "{json}");
    assert_eq!(json["rows"][0]["stability"]["frames"], 50);
}

#[test]
fn more_hysteresis_responds_later() {
    let flags = ["--frames", "30", "--response-frames", "60", "--rays", "16"];
    let small = ["--size", "16x9", "--layout", "layout1", "--json"];
    let respond = |hysteresis: &str| {
        let set = [
            "probes.warmup_frames=0",
            "probes.change_deviations=1000",
            // Rays that are kept are not repeated after a change, so the average is a plain one.
            "probes.hits=kept",
            hysteresis,
        ];
        let set: Vec<&str> = set.iter().flat_map(|key| ["--set", key]).collect();
        let all = [&["bench", "response", CORNELL], &flags[..], &small, &set].concat();
        let output = grotto(&all);
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        let json: Value = serde_json::from_str(&text(&output.stdout)).expect("one JSON object");
        let response = &json["rows"][0]["response"];
        for change in [
            "lamp_on",
            "lamp_off",
            "lamp_moved",
            "wall_opened",
            "wall_closed",
        ] {
            assert!(response.get(change).is_some(), "{change} in {response}");
        }
        number(response, "lamp_on.to_90")
    };
    let (quick, slow) = (
        respond("probes.hysteresis=0.5"),
        respond("probes.hysteresis=0.9"),
    );
    assert!(quick < slow, "{quick} {slow}");
    // One bounce alone takes ln 0.1 / ln h frames: 3.3 and 21.9. More bounces take longer.
    assert!((3.0..12.0).contains(&quick), "{quick}");
    assert!((18.0..60.0).contains(&slow), "{slow}");
}

/// Four frames to nine tenths of all bounces, without a shorter history.
#[test]
fn a_lamp_that_is_switched_is_seen_at_once() {
    let frames = ["--frames", "12", "--response-frames", "64"];
    let small = ["--size", "16x9", "--layout", "layout1", "--rays", "128"];
    let set = ["--set", "probes.warmup_frames=10", "--json"];
    let output = grotto(&[&["bench", "response", CORNELL], &frames[..], &small, &set].concat());
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let json: Value = serde_json::from_str(&text(&output.stdout)).expect("one JSON object");
    let response = &json["rows"][0]["response"];
    assert_eq!(json["rows"][0]["hysteresis"].as_f64(), Some(0.97));
    // A plain average takes more than a hundred frames for either. All light of a lone lamp goes out with it.
    for (change, most) in [("lamp_on", 4.0), ("lamp_off", 1.0)] {
        let frames = number(response, &format!("{change}.to_90"));
        assert!(frames <= most, "{change}: {response}");
    }
}

/// The wall that a world names is the one that opens. The dark room sees light through that wall once it is open,
/// but no lamp while it is closed, and no light if the named wall is elsewhere.
#[test]
fn a_world_names_the_wall_that_opens() {
    let bench = Bench::new();
    let sealed = crate::root().join("worlds/sealed.ron");
    let text = fs::read_to_string(sealed).expect("a world of ours");
    let named = "min: (0, -2, -2), max: (0, 1, 1)";
    assert!(text.contains(named), "another wall than this test knows");
    let elsewhere = bench.path("elsewhere.ron");
    let other = text.replace(named, "min: (13, -2, -2), max: (15, 1, 1)");
    fs::write(&elsewhere, other).expect("writable");
    let respond = |world: &str| {
        let flags = [
            "--camera",
            "dark",
            "--layout",
            "straddling",
            "--size",
            "16x9",
        ];
        let short = [
            "--frames",
            "12",
            "--response-frames",
            "16",
            "--rays",
            "32",
            "--json",
        ];
        let output = grotto(&[&["bench", "response", world], &flags[..], &short].concat());
        object(&output)["rows"][0]["response"].clone()
    };
    let response = respond("worlds/sealed.ron");
    for change in ["lamp_on", "lamp_off", "lamp_moved"] {
        assert!(response[change].is_null(), "{change}: {response}");
    }
    for change in ["wall_opened", "wall_closed"] {
        assert_eq!(response[change]["watched"], 16, "{change}: {response}");
    }
    let response = respond(&elsewhere.display().to_string());
    for change in ["wall_opened", "wall_closed"] {
        assert!(response[change].is_null(), "{change}: {response}");
    }
}
