//! The command line, driven as a user drives it.

mod bench;
mod bench_reports;
mod bench_speed;
mod info;
mod refusals;
mod render;

use std::{
    fs,
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

const COMMANDS: [&str; 9] = [
    "render",
    "reference",
    "compare",
    "judge",
    "bench",
    "stress",
    "merge",
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

/// The commands of a help text, but for `help` itself.
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
