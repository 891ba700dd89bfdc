//! The command line, run as a user runs it.

#[path = "../support/mod.rs"]
mod support;

mod bench;
mod bench_reports;
mod bench_speed;
mod bodies;
mod info;
mod lamps;
mod measuring;
#[cfg(target_os = "linux")]
mod package;
mod reference;
mod refusals;
mod render;
mod replay;
mod saves;
#[cfg(target_os = "linux")]
mod settings;
mod storms;
mod stress;
#[cfg(target_os = "linux")]
mod window;

use std::path::PathBuf;

use support::{
    binary::{Ended, FEW_FACE_RAYS, end, grotto, grotto_without_gpu, refused, run},
    folder, listing, root,
};

fn world_files() -> Vec<PathBuf> {
    let all = listing(&root().join("worlds"));
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

const COMMANDS: [&str; 11] = [
    "render",
    "reference",
    "compare",
    "judge",
    "bench",
    "stress",
    "merge",
    "export",
    "saves",
    "check",
    "info",
];

#[test]
fn help_lists_what_there_is_and_nothing_else() {
    let ended = run(&["--help"]);
    assert_eq!(ended.code, 0);
    for command in COMMANDS {
        assert!(ended.stdout.contains(command), "{}", ended.stdout);
    }
    assert!(!ended.stdout.contains("one-start"), "{}", ended.stdout);
    for command in COMMANDS {
        assert_eq!(run(&[command, "--help"]).code, 0);
    }
}

/// The commands of a help text, except `help` itself.
fn commands_of(help: &str) -> Vec<String> {
    let lines = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    let names = lines
        .take_while(|line| !line.is_empty())
        .filter(|line| line.starts_with("  ") && !line.starts_with("   "))
        .filter_map(|line| line.split_whitespace().next());
    names
        .filter(|name| *name != "help")
        .map(str::to_owned)
        .collect()
}

#[test]
fn every_command_takes_json_and_quiet() {
    let commands = commands_of(&run(&["--help"]).stdout);
    assert!(
        COMMANDS
            .iter()
            .all(|name| commands.iter().any(|c| c == name))
    );
    let mut seen = 0;
    for command in &commands {
        let help = run(&[command, "--help"]).stdout;
        let suites = commands_of(&help);
        let helps = match &suites[..] {
            [] => vec![help],
            suites => suites
                .iter()
                .map(|suite| run(&[command, suite, "--help"]).stdout)
                .collect(),
        };
        for help in helps {
            let takes = |flag: &str| {
                help.lines()
                    .any(|line| line.trim() == flag || line.trim().starts_with(&format!("{flag} ")))
            };
            assert!(takes("--json") && takes("--quiet"), "{command}: {help}");
            seen += 1;
        }
    }
    assert!(seen > 20, "{seen}");
}

#[test]
fn check_says_in_json_what_it_says_in_words() {
    let ended = run(&["check", MINIMAL, "worlds/none.ron", "--json", "--quiet"]);
    assert_eq!(ended.code, 2);
    let worlds = &ended.json()["worlds"];
    assert_eq!(worlds[0]["ok"], true);
    assert_eq!(worlds[0]["file"], MINIMAL);
    assert_eq!(worlds[1]["ok"], false);
    let text = worlds[1]["text"].as_str().expect("a text");
    assert!(text.contains("does not exist"), "{text}");
    assert!(ended.stderr.contains("1 of 2 files"), "{}", ended.stderr);
}

fn world_path(name: &str) -> PathBuf {
    root().join(name)
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
