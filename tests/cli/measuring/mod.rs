//! The commands that measure light, run as a user runs them: `grotto compare`, `grotto judge`, and the suites of
//! `grotto bench` about stability and response. These tests also check the measured light.

mod compare;
mod displayed;
mod dynamics;
mod judge;
mod motion;
mod parts;
mod stairs;
mod tables;

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Output},
};

use grotto::measure::{picture::Picture, picture_file};
use serde_json::Value;
use tempfile::TempDir;

use crate::support::{
    self,
    binary::{FEW_FACE_RAYS, output, text},
    listing, root,
};

/// For tests of tables and files, whose figures need not be near the truth.
const FEW_FACES: [&str; 2] = ["--set", FEW_FACE_RAYS];

/// The program at the root of the repository, where the worlds are.
fn grotto(arguments: &[&str]) -> Output {
    output(&mut command(root(), arguments))
}

fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = crate::grotto();
    command.current_dir(folder).args(arguments);
    command
}

/// The number at a path of keys, such as `flip.mean`.
fn number(json: &Value, path: &str) -> f64 {
    let found = path.split('.').fold(json, |value, key| &value[key]);
    found.as_f64().unwrap_or_else(|| panic!("{path} in {json}"))
}

/// The one object that a command printed.
#[track_caller]
fn object(output: &Output) -> Value {
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert_eq!(text(&output.stdout).lines().count(), 1);
    serde_json::from_str(&text(&output.stdout)).expect("one JSON object")
}

/// A folder of pictures, results and references, and the commands over it.
struct Bench {
    folder: TempDir,
}

impl Bench {
    fn new() -> Self {
        Self {
            folder: support::folder(),
        }
    }

    fn folder(&self) -> &Path {
        self.folder.path()
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder().join(name)
    }

    fn write(&self, name: &str, picture: &Picture) {
        picture_file::write(&self.path(name), picture, 0.0).expect("writable");
    }

    /// `grotto compare` in the folder.
    fn compare(&self, arguments: &[&str]) -> Output {
        output(&mut command(
            self.folder(),
            &[&["compare"], arguments].concat(),
        ))
    }

    fn compared(&self, arguments: &[&str]) -> Value {
        object(&self.compare(&[arguments, &["--json"]].concat()))
    }

    /// Asserts that comparing ends with this code, nothing on stdout, and a message with these parts.
    fn refused(&self, arguments: &[&str], code: i32, parts: &[&str]) {
        let output = self.compare(arguments);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {message}");
        assert_eq!(text(&output.stdout), "", "{arguments:?}");
        for part in parts {
            assert!(
                message.contains(part),
                "{arguments:?}: no {part} in {message}"
            );
        }
        assert!(!message.contains("bug in grotto"), "{message}");
    }

    /// `grotto judge` with these flags, and with defaults that keep tests quick.
    fn judging(&self, arguments: &[&str]) -> Command {
        let [out, cache] = ["out", "cache"].map(|name| self.path(name).display().to_string());
        let usual = [
            ["--out", &out],
            ["--cache", &cache],
            ["--size", "64x36"],
            ["--frames", "20"],
            ["--spp", "32"],
            ["--against", "cpu"],
            ["--rays", "32"],
        ];
        let missing = usual.iter().filter(|[flag, _]| !arguments.contains(flag));
        let flags: Vec<&str> = missing.flatten().copied().collect();
        let all = [&["judge"], &flags[..], arguments].concat();
        command(root(), &all)
    }

    fn judge(&self, arguments: &[&str]) -> Output {
        output(&mut self.judging(arguments))
    }

    /// The JSON on stdout and the text on stderr.
    fn judged(&self, arguments: &[&str]) -> (Value, String) {
        let output = self.judge(&[arguments, &["--json"]].concat());
        (object(&output), text(&output.stderr))
    }

    /// A file that `judge` wrote.
    fn result(&self, name: &str) -> String {
        fs::read_to_string(self.path("out").join(name)).expect("written")
    }

    fn references(&self) -> Vec<PathBuf> {
        listing(&self.path("cache"))
    }
}
