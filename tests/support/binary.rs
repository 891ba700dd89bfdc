//! The program `grotto`, run as a user runs it.

use std::process::{Command, Output, Stdio};

use serde_json::Value;

use super::root;

/// A parameter for tests that do not judge light: a twentieth of the rays of faces, which take most of the time of a
/// small picture in software.
pub const FEW_FACE_RAYS: &str = "probes.face_share=0.05";

/// The result of a command.
pub struct Ended {
    pub code: i32,
    pub stdout: String,
    pub stderr: String,
}

impl Ended {
    /// The one JSON object on stdout.
    pub fn json(&self) -> Value {
        assert_eq!(self.stdout.lines().count(), 1, "{}", self.stdout);
        serde_json::from_str(&self.stdout).expect("one JSON object")
    }
}

/// `grotto` at the root of the repository, where the worlds are, with nothing to read from stdin.
pub fn grotto() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_grotto"));
    command.current_dir(root()).stdin(Stdio::null());
    // The settings of whoever runs the tests are none of their business: nobody has a folder here.
    command.env("GROTTO_CONFIG", "/nowhere/at/all");
    command
}

/// A machine whose Vulkan loader finds no driver.
pub fn grotto_without_gpu() -> Command {
    let mut command = grotto();
    for variable in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"] {
        command.env(variable, "/nowhere/at/all.json");
    }
    command
}

pub fn output(command: &mut Command) -> Output {
    command.output().expect("the binary starts")
}

pub fn end(command: &mut Command) -> Ended {
    let output = output(command);
    Ended {
        code: output.status.code().expect("no signal"),
        stdout: text(&output.stdout),
        stderr: text(&output.stderr),
    }
}

pub fn run(arguments: &[&str]) -> Ended {
    end(grotto().args(arguments))
}

/// Asserts that the command ends with this code, nothing on stdout, and one message with these parts.
pub fn refused(command: &mut Command, code: i32, parts: &[&str]) {
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

pub fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}
