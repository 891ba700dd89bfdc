//! `grotto merge`: joins what `--shard I/N` of stress, judge, reference and bench wrote.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

use clap::Args;
use serde::Serialize;

use super::{
    Failure, bench, judge,
    options::RunOptions,
    output,
    part::{self, Part},
    reference, stress,
};
use crate::measure::whole_file;

/// Join the parts that --shard I/N of stress, judge, reference or bench wrote
///
/// What comes of it is what one run would have written, to the byte. Parts that are missing, there twice, damaged,
/// or of different work are refused, and so is an --out that holds another result.
#[derive(Args)]
pub struct Arguments {
    /// The folders of the parts, in any order; parts may share a folder
    #[arg(value_name = "DIR", required = true)]
    parts: Vec<PathBuf>,
    /// The folder for the whole, made if need be
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    run: RunOptions,
}

/// The reports of commands, beside pages that are made of them.
const REPORTS: [(&str, &str); 3] = [
    (BENCH, "bench.json"),
    (STRESS, "stress.json"),
    (judge::COMMAND, "judge.json"),
];
const BENCH: &str = "bench";
const STRESS: &str = "stress";

/// What was made of the parts: the `--json`.
#[derive(Serialize)]
struct Record {
    /// Whose parts they were.
    command: String,
    parts: usize,
    files: Vec<String>,
}

/// What lies in the folders.
enum Found {
    /// Files of parts of one command, by their wholes.
    Files(String, BTreeMap<String, Vec<Part>>),
    /// A report of this command in each folder: a folder is a part.
    Reports(&'static str),
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let (out, run) = (&arguments.out, &arguments.run);
    let found = look(&arguments.parts)?;
    let (command, parts) = match &found {
        Found::Files(command, wholes) => (command.clone(), wholes.values().map(Vec::len).sum()),
        Found::Reports(command) => ((*command).to_owned(), arguments.parts.len()),
    };
    check_other_results(out, &command)?;
    let draft = Draft::new(out)?;
    let verdict = match found {
        Found::Files(_, wholes) => join_files(wholes, &draft.folder)?,
        Found::Reports(command) => join_reports(command, &arguments.parts, &draft.folder)?,
    };
    let files = draft.publish()?;
    let files: Vec<String> = files
        .iter()
        .map(|path| path.display().to_string())
        .collect();
    if run.json {
        let record = Record {
            command,
            parts,
            files,
        };
        output::print_json(&record)?;
    } else {
        output::note(run, &format!("{parts} parts make {}", files.join(", ")));
    }
    verdict
}

/// Writes the wholes into a folder. What comes of it is how the whole run would have ended.
fn join_files(
    wholes: BTreeMap<String, Vec<Part>>,
    folder: &Path,
) -> Result<Result<(), Failure>, Failure> {
    let mut verdict = Ok(());
    for parts in wholes.into_values() {
        let parts = part::in_order(parts)?;
        match parts.first().map(|part| &part.head.command[..]) {
            Some(reference::COMMAND) => reference::merge(&parts, folder)?,
            Some(judge::COMMAND) => verdict = judge::merge(&parts, folder)?,
            _ => {
                return Err(Failure::bad_input(
                    "these are parts of a command that this version does not know",
                ));
            }
        }
    }
    Ok(verdict)
}

/// Writes the whole of these folders' reports into a folder. What comes of it is how the whole run would have ended.
fn join_reports(
    command: &str,
    parts: &[PathBuf],
    folder: &Path,
) -> Result<Result<(), Failure>, Failure> {
    match command {
        BENCH => bench::merge::join(parts, folder).map(Ok),
        _ => {
            stress::merge::join(parts, folder)?;
            Ok(stress::report::Report::read(folder)?.verdict())
        }
    }
}
/// Reads the parts.
fn look(folders: &[PathBuf]) -> Result<Found, Failure> {
    let mut files = Vec::new();
    let mut reports = Vec::new();
    for folder in folders {
        let refused = |reason: &str| Failure::bad_input(format!("{}: {reason}", folder.display()));
        let parts = part::files_in(folder)?;
        let report = REPORTS
            .iter()
            .find(|(command, name)| *command != judge::COMMAND && folder.join(name).is_file());
        match (parts.is_empty(), report) {
            (true, Some((command, _))) => reports.push((*command, folder)),
            (false, None) => files.extend(parts),
            (true, None) => {
                return Err(refused(
                    "holds no part; name the folders that --shard I/N wrote into",
                ));
            }
            (false, Some((command, _))) => {
                return Err(refused(&format!(
                    "holds a part of `{command}` and parts of other work; keep them apart"
                )));
            }
        }
    }
    let Some((command, folder)) = reports.first() else {
        return group(files.iter().map(|path| Part::read(path)));
    };
    let other = reports.iter().find(|(known, _)| known != command);
    let (name, place) = match (other, files.first()) {
        (Some((name, folder)), _) => (*name, folder.as_path()),
        (None, Some(file)) => ("another command", file.as_path()),
        (None, None) => return Ok(Found::Reports(command)),
    };
    Err(Failure::bad_input(format!(
        "{} holds a part of `{command}` and {} one of {name}; join them one after the other",
        folder.display(),
        place.display()
    )))
}

/// Sorts parts by what they are parts of.
fn group(parts: impl Iterator<Item = Result<Part, Failure>>) -> Result<Found, Failure> {
    let mut wholes: BTreeMap<String, Vec<Part>> = BTreeMap::new();
    let mut command = String::new();
    for part in parts {
        let part = part?;
        if command.is_empty() {
            command.clone_from(&part.head.command);
        } else if command != part.head.command {
            return Err(part.refused(&format!(
                "it is a part of `{}` among parts of `{command}`; join them one after the other",
                part.head.command
            )));
        }
        let of_whole = wholes.entry(part.head.whole.clone()).or_default();
        of_whole.push(part);
    }
    Ok(Found::Files(command, wholes))
}

/// Refuses a folder with the report of another command. What the whole consists of itself is for
/// [`Draft::publish`] to compare.
fn check_other_results(out: &Path, command: &str) -> Result<(), Failure> {
    let other = REPORTS
        .iter()
        .find(|(known, name)| *known != command && out.join(name).is_file());
    match other {
        None => Ok(()),
        Some((known, _)) => Err(Failure::bad_input(format!(
            "{} holds a result of `{known}`; choose another folder for --out",
            out.display()
        ))),
    }
}

/// A folder within the folder for the whole, where it is made; gone when it is dropped.
struct Draft {
    out: PathBuf,
    folder: PathBuf,
    /// Whether nothing was there before.
    made_out: bool,
}

impl Draft {
    fn new(out: &Path) -> Result<Self, Failure> {
        let made_out = !out.exists();
        let folder = out.join(format!(".merging-{}", std::process::id()));
        whole_file::create_folder(&folder)?;
        Ok(Self {
            out: out.to_owned(),
            folder,
            made_out,
        })
    }

    /// Moves all files to their places, and gives those.
    ///
    /// # Errors
    /// When a file is there already and is another one: then none is moved.
    fn publish(mut self) -> Result<Vec<PathBuf>, Failure> {
        let mut files = Vec::new();
        files_under(&self.folder, Path::new(""), &mut files)
            .map_err(|reason| Failure::unread(&self.folder, reason))?;
        files.sort();
        for file in &files {
            let place = self.out.join(file);
            if place.exists() && fs::read(&place).ok() != fs::read(self.folder.join(file)).ok() {
                return Err(Failure::bad_input(format!(
                    "{} is there already, and is not what these parts make; delete it or choose another \
                     folder for --out",
                    place.display()
                )));
            }
        }
        let mut places = Vec::new();
        for file in &files {
            let place = self.out.join(file);
            let moved = place
                .parent()
                .map_or(Ok(()), fs::create_dir_all)
                .and_then(|()| fs::rename(self.folder.join(file), &place));
            moved.map_err(|reason| Failure::unwritten(&place, reason))?;
            places.push(place);
        }
        self.made_out = false;
        Ok(places)
    }
}

impl Drop for Draft {
    fn drop(&mut self) {
        // What cannot be removed is hidden, and harms nobody.
        let _ = fs::remove_dir_all(&self.folder);
        if self.made_out {
            let _ = fs::remove_dir(&self.out);
        }
    }
}

/// The files under `folder` and its folders, as paths from `folder` on.
fn files_under(folder: &Path, prefix: &Path, files: &mut Vec<PathBuf>) -> std::io::Result<()> {
    for entry in fs::read_dir(folder.join(prefix))? {
        let entry = entry?;
        let path = prefix.join(entry.file_name());
        match entry.file_type()?.is_dir() {
            true => files_under(folder, &path, files)?,
            false => files.push(path),
        }
    }
    Ok(())
}
