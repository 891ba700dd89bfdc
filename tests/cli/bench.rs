//! `grotto bench`.

use std::fs;

use serde_json::Value;

use crate::{FEW_FACE_RAYS, MINIMAL, end, folder, grotto, refused};

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
fn bench_flight_flies_jumps_and_says_what_is_in_the_way() {
    let folder = folder();
    let flight = |cameras: &[&str]| {
        let mut command = grotto();
        command.args(["bench", "flight", "worlds/house.ron", "--layout", "around"]);
        for camera in cameras {
            command.args(["--camera", camera]);
        }
        command.args(["--metres", "3", "--frames", "2", "--size", "32x18"]);
        command.args(["--rays", "8", "--json", "--set", FEW_FACE_RAYS]);
        command
    };
    let ended = end(flight(&["inside"]).arg("--out").arg(folder.path()));
    assert_eq!(ended.code, 0, "{}", ended.stderr);
    let record = ended.json();
    let written = fs::read_to_string(folder.path().join("flight.json")).expect("the record");
    let written: Value = serde_json::from_str(&written).expect("JSON");
    assert_eq!(written, record);
    let row = &record["rows"][0];
    assert_eq!(
        row["frames"], 9,
        "three metres at 20 m/s, 60 frames a second"
    );
    assert!(
        row["scroll"]["frames"]
            .as_u64()
            .is_some_and(|frames| frames > 0)
    );
    assert!(
        row["change"]["count"]
            .as_u64()
            .is_some_and(|count| count > 1000)
    );
    let (irradiance, displayed) = (&row["change"], &row["displayed"]);
    assert!(displayed["count"].as_u64() >= irradiance["count"].as_u64());
    assert!(
        displayed["max"]
            .as_f64()
            .is_some_and(|max| max > 0.0 && max < 1.0)
    );
    assert_eq!(row["teleport"]["camera"], "outside");
    refused(
        &mut flight(&["inside", "outside"]),
        2,
        &["solid voxels are in the way", "`inside`", "`outside`"],
    );
    refused(flight(&["inside"]).args(["--speed", "0"]), 2, &["above 0"]);
}
