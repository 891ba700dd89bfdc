//! The tables of `grotto judge`: rows for settings, results of interrupted work, and pages.

use std::{
    fs,
    process::{Command, Stdio},
    thread::sleep,
    time::{Duration, Instant},
};

use grotto::measure::picture_file;
use serde_json::{Value, json};

use super::{
    Bench, FEW_FACES,
    judge::{CORNELL, SKIP},
    number, text,
};

const ONE_CAMERA: [&str; 3] = [CORNELL, "--camera", "inside"];

#[test]
fn settings_make_rows_and_a_table_of_means() {
    let bench = Bench::new();
    let vary = [
        "--vary",
        "source.weights=direction,visibility",
        "--set",
        "probes.method=source",
        "--rays",
        "16,32",
        "--direct",
    ];
    let flags = [
        &["worlds/sealed.ron", "--layout", "straddling"],
        &SKIP[..],
        &vary,
    ]
    .concat();
    let (judged, _) = bench.judged(&flags);
    assert_eq!(judged["complete"], true);
    let rows = judged["rows"].as_array().expect("rows");
    let settings = |row: &Value| (row["direct_alone"] == true, row["settings"].clone());
    let setting = |weights: &str, rays: u32| {
        let values = json!({"source.weights": weights, "probes.rays": rays});
        (false, values)
    };
    let each = [
        (true, json!({})),
        setting("direction", 16),
        setting("direction", 32),
        setting("visibility", 16),
        setting("visibility", 32),
    ];
    // Two cameras, the dark one first.
    let found: Vec<_> = rows.iter().map(settings).collect();
    assert_eq!(found, [&each[..], &each].concat());
    for row in rows {
        let rays = row["settings"]["probes.rays"].as_u64().unwrap_or(0);
        assert_eq!(row["rays"], rays);
    }
    assert_eq!(bench.references().len(), 2, "one for each camera");

    // The setting takes effect: without visibility the dark room is lit.
    assert!(number(&rows[1], "leak_ratio") > 10.0 * number(&rows[3], "leak_ratio"));
    assert_eq!(number(&rows[0], "leak_ratio"), 0.0, "no probes, no leak");
    assert_eq!(number(&rows[5], "indirect.energy_ratio"), 0.0);
    assert!(number(&rows[5], "full.energy_ratio") > 0.1);

    let means = judged["by_setting"].as_array().expect("means");
    assert_eq!(means.iter().map(settings).collect::<Vec<_>>(), each);
    for (index, mean) in means.iter().enumerate() {
        let pair = [&rows[index], &rows[index + 5]];
        let [average, most] = ["mean", "max"]
            .map(|figure| pair.map(|row| number(row, &format!("full.abs_sum.{figure}"))));
        assert_eq!(mean["rows"], 2);
        assert!((number(mean, "abs_sum_mean") - (average[0] + average[1]) / 2.0).abs() < 1e-12);
        assert_eq!(number(mean, "abs_sum_max"), most[0].max(most[1]));
        assert_eq!(
            mean["leak_ratio"], pair[0]["leak_ratio"],
            "only one has one"
        );
    }

    let csv = bench.result("judge.csv");
    let cells: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(cells.len(), 11);
    let column = cells[0]
        .iter()
        .position(|name| *name == "source.weights")
        .expect("a column");
    assert_eq!([cells[1][column], cells[2][column]], ["", "direction"]);
    for name in ["judge.html", "judge.md"] {
        let page = bench.result(name);
        for part in ["source.weights", "visibility", "direct light alone"] {
            assert!(page.contains(part), "{name}: no {part}");
        }
    }
    let markdown = bench.result("judge.md");
    assert_eq!(
        markdown
            .lines()
            .filter(|line| line.starts_with("| "))
            .count(),
        1 + 5 + 1 + 10
    );
}

#[test]
fn what_is_stopped_keeps_its_rows() {
    let bench = Bench::new();
    let vary = ["--vary", "probes.hysteresis=0.9,0.91,0.92,0.93,0.94,0.95"];
    let long = ["--frames", "60", "--layout", "layout1", "--json"];
    let all = [&ONE_CAMERA[..], &SKIP, &FEW_FACES, &vary, &long].concat();
    let child = bench
        .judging(&all)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary starts");
    let path = bench.path("out").join("judge.json");
    let start = Instant::now();
    while !path.exists() {
        assert!(start.elapsed() < Duration::from_secs(120), "no row yet");
        sleep(Duration::from_millis(20));
    }
    // While the work runs there is a complete table of the finished rows.
    let early: Value = serde_json::from_slice(&fs::read(&path).expect("readable")).expect("JSON");
    assert_eq!(early["complete"], false);
    let kill = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(kill.expect("kill is there").success());
    let output = child.wait_with_output().expect("it ends");
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(130), "{said}");
    let kept: Value = serde_json::from_str(&bench.result("judge.json")).expect("JSON");
    let printed: Value = serde_json::from_slice(&output.stdout).expect("one JSON object");
    assert_eq!(kept, printed);
    let rows = kept["rows"].as_array().expect("rows").len();
    assert!((1..6).contains(&rows), "{rows}");
    assert_eq!(kept["complete"], false);
    assert!(said.contains(&format!("first {rows} rows")), "{said}");
    assert_eq!(bench.result("judge.csv").lines().count(), rows + 1);
    let page = bench.result("judge.html");
    assert_eq!(page.matches("<h4>").count(), rows);
    assert!(page.contains("Not complete") && bench.result("judge.md").contains("Not complete"));
    let names = fs::read_dir(bench.path("out")).expect("a folder").count();
    assert_eq!(names, 4, "nothing half-written is left");

    // The traced references are kept, and a full run makes a complete table.
    let (whole, said) = bench.judged(&all[..all.len() - 1]);
    assert!(!said.contains("anew"), "{said}");
    assert_eq!(whole["rows"].as_array().map(Vec::len), Some(6));
    assert_eq!(whole["rows"][0], kept["rows"][0]);
    assert!(!bench.result("judge.html").contains("Not complete"));
}

#[test]
fn pictures_are_as_small_and_as_large_as_they_are_wanted() {
    let bench = Bench::new();
    let flags = [
        &ONE_CAMERA[..],
        &SKIP,
        &FEW_FACES,
        &["--layout", "layout1", "--size", "96x54"],
    ]
    .concat();
    let page = |more: &[&str]| {
        bench.judged(&[&flags[..], more].concat());
        bench.result("judge.html")
    };
    let large = page(&[]);
    let small = page(&["--page-pictures", "24"]);
    let none = page(&["--page-pictures", "0"]);
    for (page, width) in [
        (&large, "width=\"96\" height=\"54\""),
        (&small, "width=\"24\" height=\"14\""),
    ] {
        assert_eq!(page.matches(width).count(), 6);
        assert_eq!(page.matches("<a href").count(), 0);
    }
    assert!(
        small.len() * 3 < large.len() * 2,
        "{} {}",
        small.len(),
        large.len()
    );
    assert!(!none.contains("<img") && none.contains("<td class=\"name\">cornell</td>"));
    assert!(none.len() < 8192, "{}", none.len());
    assert!(!bench.path("out/pictures").exists());

    let linked = page(&["--page-pictures", "24", "--pictures"]);
    let folder = bench.path("out/pictures");
    let files: Vec<_> = fs::read_dir(&folder)
        .expect("a folder")
        .map(|entry| {
            entry
                .expect("an entry")
                .file_name()
                .into_string()
                .expect("ASCII")
        })
        .collect();
    assert_eq!(files.len(), 6);
    for name in files {
        assert!(
            linked.contains(&format!("<a href=\"pictures/{name}\">")),
            "{name}"
        );
        let (picture, _) = picture_file::read(&folder.join(&name)).expect("a PNG");
        assert_eq!([picture.width, picture.height], [96, 54]);
    }
}
