//! `--shard I/N` of `reference` and `judge`, and `grotto merge`: merged parts equal the result of one run, byte for byte.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    process::{Child, Output},
};

use serde_json::Value;

use super::{Bench, FEW_FACES, grotto, judge::SKIP, object, text};

const ROOM: &str = "worlds/minimal.ron";

impl Bench {
    /// All files under a folder, except the files of parts.
    fn files(&self, folder: &str) -> BTreeMap<PathBuf, Vec<u8>> {
        fn collect(root: &Path, folder: &Path, all: &mut BTreeMap<PathBuf, Vec<u8>>) {
            for entry in fs::read_dir(folder).expect("a folder") {
                let path = entry.expect("an entry").path();
                if path.is_dir() {
                    collect(root, &path, all);
                } else if !path.to_string_lossy().contains(".part-") {
                    let name = path.strip_prefix(root).expect("within").to_owned();
                    all.insert(name, fs::read(&path).expect("readable"));
                }
            }
        }
        let (root, mut all) = (self.path(folder), BTreeMap::new());
        collect(&root, &root, &mut all);
        all
    }

    /// `grotto reference` of a small room into `FOLDER/room.exr`.
    fn tracing(&self, folder: &str, flags: &[&str]) -> Child {
        fs::create_dir_all(self.path(folder)).expect("writable");
        let picture = self.path(folder).join("room.exr").display().to_string();
        let usual = ["reference", ROOM, "--size", "24x16", "-o", &picture];
        let spp = ["--spp", "44"];
        let spp = if flags.contains(&spp[0]) {
            &[][..]
        } else {
            &spp
        };
        start(&[&usual[..], spp, flags].concat())
    }

    /// Traces parts side by side into folders `1`, `2`, ….
    fn trace_parts(&self, count: u32, flags: &[&str]) {
        let parts = (1..=count).map(|index| {
            let shard = format!("{index}/{count}");
            self.tracing(&index.to_string(), &[&["--shard", &shard], flags].concat())
        });
        for part in parts.collect::<Vec<_>>() {
            done(part);
        }
    }

    fn merge(&self, parts: &[&str], out: &str) -> Output {
        let paths = parts.iter().chain([&out]).map(|name| self.path(name));
        let paths: Vec<String> = paths.map(|path| path.display().to_string()).collect();
        let (out, parts) = paths.split_last().expect("a folder for the whole");
        let parts: Vec<&str> = parts.iter().map(String::as_str).collect();
        grotto(&[&["merge"], &parts[..], &["--out", out, "--json"]].concat())
    }

    /// Asserts that merging is refused with a message with these words, and leaves `out` unchanged.
    fn not_merged(&self, parts: &[&str], out: &str, words: &[&str]) {
        let before = self.path(out).exists().then(|| self.files(out));
        let output = self.merge(parts, out);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{parts:?}: {message}");
        assert_eq!(text(&output.stdout), "", "{parts:?}");
        for word in words {
            assert!(message.contains(word), "{parts:?}: no {word} in {message}");
        }
        let after = self.path(out).exists().then(|| self.files(out));
        assert!(before == after, "{parts:?}");
    }

    fn part(&self, folder: &str) -> PathBuf {
        let entries = fs::read_dir(self.path(folder)).expect("a folder");
        let mut paths = entries.map(|entry| entry.expect("an entry").path());
        let part = paths.find(|path| path.to_string_lossy().contains(".part-"));
        part.expect("a part")
    }
}

fn start(arguments: &[&str]) -> Child {
    super::command(crate::root(), arguments)
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .expect("the binary starts")
}

#[track_caller]
fn done(child: Child) -> Output {
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    output
}

#[test]
fn four_parts_of_a_reference_make_the_picture_of_one_run() {
    let bench = Bench::new();
    // 44 samples are six blocks of eight.
    done(bench.tracing("whole", &[]));
    bench.trace_parts(4, &[]);
    let merged = object(&bench.merge(&["3", "1", "4", "2"], "out"));
    assert_eq!(
        (&merged["command"], &merged["parts"]),
        (&"reference".into(), &4.into())
    );
    assert!(bench.files("out") == bench.files("whole"));
    assert_eq!(bench.files("out").len(), 1);
    // Merged once more into the same folder, the picture is the same.
    object(&bench.merge(&["1", "2", "3", "4"], "out"));

    // More parts than blocks: some hold no samples.
    let many: Vec<String> = (1..=8).map(|index| index.to_string()).collect();
    let many: Vec<&str> = many.iter().map(String::as_str).collect();
    for folder in &many[..4] {
        fs::remove_file(bench.part(folder)).expect("it is there");
    }
    bench.trace_parts(8, &[]);
    object(&bench.merge(&many, "again"));
    assert!(bench.files("again") == bench.files("whole"));
}

#[test]
fn views_without_randomness_and_pngs_have_parts_too() {
    let bench = Bench::new();
    let trace = |name: &str, flags: &[&str]| {
        let picture = bench.path(name).display().to_string();
        done(start(
            &[
                &["reference", ROOM, "--size", "24x16", "-o", &picture],
                flags,
            ]
            .concat(),
        ));
    };
    for (view, name) in [("depth", "depth.png"), ("indirect", "light.png")] {
        let flags = [
            "--spp",
            "9",
            "--view",
            view,
            "--antialias",
            "--set",
            "picture.exposure_ev=1.3",
        ];
        trace(name, &flags);
        for shard in ["1/2", "2/2"] {
            // Parts of several pictures may share a folder.
            trace(
                &format!("parts/{name}"),
                &[&flags[..], &["--shard", shard]].concat(),
            );
        }
    }
    let merged = object(&bench.merge(&["parts"], "out"));
    assert_eq!(merged["files"].as_array().map(Vec::len), Some(2));
    for name in ["depth.png", "light.png"] {
        let read = |path: PathBuf| fs::read(path).expect("written");
        assert!(
            read(bench.path("out").join(name)) == read(bench.path(name)),
            "{name}"
        );
    }
}

#[test]
fn parts_that_make_no_whole_are_refused() {
    let bench = Bench::new();
    bench.trace_parts(2, &[]);
    bench.not_merged(&["2"], "out", &["room.exr", "part 1/2 is missing"]);
    bench.not_merged(&["1", "2", "1"], "out", &["part 1/2 is there 2 times"]);
    assert!(!bench.path("out").exists(), "nothing is left");
    for empty in ["empty", "nowhere"] {
        if empty == "empty" {
            fs::create_dir(bench.path(empty)).expect("writable");
        }
        bench.not_merged(&["1", empty], "out", &[empty]);
    }
    // Parts of other pictures and of another number of parts.
    for (flags, word) in [
        (
            &["--seed", "1", "--shard", "2/2"][..],
            "the seed is 1 and 0",
        ),
        (
            &["--spp", "45", "--shard", "2/2"],
            "the samples a pixel is 45 and 44",
        ),
        (&["--set", "world.seed=9", "--shard", "2/2"], "the world"),
        (&["--shard", "2/3"], "of 3"),
    ] {
        done(bench.tracing("other", flags));
        bench.not_merged(&["1", "other"], "out", &[word]);
        fs::remove_file(bench.part("other")).expect("it is there");
    }
    let part = bench.part("2");
    let whole = fs::read(&part).expect("written");
    let mut damaged = whole.clone();
    *damaged.last_mut().expect("bytes") ^= 1;
    let newer = [b"grotto part 2\n", &whole[14..]].concat();
    for (bytes, word) in [
        (&damaged[..], "damaged"),
        (&whole[..whole.len() / 2], "damaged"),
        (&newer, "another version"),
        (b"", "not a part"),
    ] {
        fs::write(&part, bytes).expect("writable");
        bench.not_merged(&["1", "2"], "out", &["part-2-of-2", word]);
    }
    // Neither a file that cannot be read nor the part of another picture is overwritten.
    let refused = bench.tracing("2", &["--shard", "2/2"]).wait_with_output();
    assert_eq!(refused.expect("it ends").status.code(), Some(2));
    let refused = bench.tracing("1", &["--shard", "1/2", "--seed", "7"]);
    let refused = refused.wait_with_output().expect("it ends");
    assert!(
        text(&refused.stderr).contains("the seed was 0 and would be 7"),
        "{refused:?}"
    );
    fs::write(&part, whole).expect("writable");

    // A folder with other results.
    fs::create_dir(bench.path("full")).expect("writable");
    fs::write(bench.path("full/room.exr"), "mine").expect("writable");
    bench.not_merged(&["1", "2"], "full", &["room.exr", "already"]);
    fs::remove_file(bench.path("full/room.exr")).expect("it is there");
    fs::write(bench.path("full/judge.json"), "{}").expect("writable");
    bench.not_merged(&["1", "2"], "full", &["result of `judge`"]);
    object(&bench.merge(&["1", "2"], "out"));
}

#[test]
fn numbers_of_parts_are_checked() {
    let bench = Bench::new();
    for shard in ["0/4", "5/4", "1/0", "1/1000000000", "2", "a/b"] {
        let output = bench.tracing("out", &["--shard", shard]).wait_with_output();
        let output = output.expect("it ends");
        assert_eq!(output.status.code(), Some(2), "{shard}");
        assert!(text(&output.stderr).contains("I/N"), "{shard}");
    }
    let unshared = grotto(&["merge", "--out", "nowhere"]);
    assert_eq!(unshared.status.code(), Some(2));
}

/// Judges rows in parts, one part after another. Each has a cache of its own, as on separate machines.
fn judge_parts(bench: &Bench, count: u32, flags: &[&str]) {
    for index in 1..=count {
        let [folder, cache] = ["", "cache-"].map(|prefix| format!("{prefix}{index}"));
        let [out, cache] = [folder, cache].map(|name| bench.path(&name).display().to_string());
        let shard = format!("{index}/{count}");
        let own = [
            "--out", &out, "--cache", &cache, "--shard", &shard, "--json",
        ];
        let output = bench.judge(&[flags, &own].concat());
        let json: Value = serde_json::from_slice(&output.stdout).expect("one JSON object");
        assert_eq!(json["complete"], false, "a part is not the whole");
    }
}

#[test]
fn parts_of_a_judge_make_the_tables_and_pages_of_one_run() {
    let bench = Bench::new();
    let flags = [
        &[
            "worlds/cornell.ron",
            ROOM,
            "--camera",
            "front",
            "--layout",
            "layout1",
            "--layout",
            "auto",
        ],
        &[
            "--rays",
            "16,32",
            "--direct",
            "--pictures",
            "--page-pictures",
            "32",
        ][..],
        &[
            "--skip-response",
            "--against",
            "reference",
            "--size",
            "32x18",
            "--frames",
            "6",
        ],
        &["--motion=camera", "--motion-frames", "3", "--moments", "1"],
        &FEW_FACES,
    ]
    .concat();
    let (whole, _) = bench.judged(&flags);
    let rows = whole["rows"].as_array().map_or(0, Vec::len);
    assert_eq!(rows, 6, "direct light and two settings in two worlds");
    judge_parts(&bench, 3, &flags);
    object(&bench.merge(&["1", "2", "3"], "merged"));
    let (merged, whole) = (bench.files("merged"), bench.files("out"));
    assert!(
        merged.keys().eq(whole.keys()),
        "{:?} {:?}",
        merged.keys(),
        whole.keys()
    );
    for (name, bytes) in &whole {
        assert!(merged[name] == *bytes, "{}", name.display());
    }
    assert!(whole.len() > 4, "pictures too");

    // A part with a damaged picture is refused.
    let pictures = bench.path("2/pictures");
    let one = fs::read_dir(&pictures).expect("a folder").next();
    fs::write(one.expect("a picture").expect("an entry").path(), "").expect("writable");
    bench.not_merged(
        &["1", "2", "3"],
        "again",
        &["part-2-of-3", "missing or damaged"],
    );
    bench.not_merged(&["1", "3"], "again", &["part 2/3 is missing"]);
    bench.trace_parts(1, &[]);
    bench.not_merged(&["1", "2", "3"], "again", &["`reference`", "`judge`"]);
}

/// Rows do not depend on those before them, though each changes lamps and walls.
#[test]
fn parts_with_changes_of_light_make_the_same_tables() {
    let bench = Bench::new();
    let flags = [
        "worlds/cornell.ron",
        "--camera",
        "inside",
        "--layout",
        "layout1",
        "--layout",
        "layout2",
        "--frames",
        "8",
        "--response-frames",
        "16",
        "--size",
        "24x16",
        "--spp",
        "16",
        FEW_FACES[0],
        FEW_FACES[1],
    ];
    let (whole, _) = bench.judged(&flags);
    assert!(
        whole["rows"][1]["response"]["lamp_on"].is_object(),
        "{whole}"
    );
    judge_parts(&bench, 2, &flags);
    object(&bench.merge(&["1", "2"], "merged"));
    assert!(bench.files("merged") == bench.files("out"));
}

#[test]
fn a_world_that_fails_is_reported_once() {
    let bench = Bench::new();
    let broken = bench.path("broken.ron");
    fs::write(&broken, "(title: ").expect("writable");
    let broken = broken.display().to_string();
    let flags = [
        &[
            &broken,
            "worlds/cornell.ron",
            "--camera",
            "front",
            "--layout",
            "layout1",
        ],
        &SKIP[..],
    ]
    .concat();
    let one = bench.judge(&flags);
    judge_parts(&bench, 2, &flags);
    let merged = bench.merge(&["1", "2"], "merged");
    assert_eq!(
        (one.status.code(), merged.status.code()),
        (Some(2), Some(2))
    );
    assert!(text(&merged.stderr).contains("1 of 2 worlds"), "{merged:?}");
    assert!(bench.files("merged") == bench.files("out"));
}
