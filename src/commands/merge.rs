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
/// The result equals that of one run, to the byte. Parts that are missing, given twice, damaged, or of
/// different work are refused, and so is an --out that holds another result.
#[derive(Args)]
pub struct Arguments {
    /// The folders of the parts, in any order; parts may share a folder
    #[arg(value_name = "DIR", required = true)]
    parts: Vec<PathBuf>,
    /// The folder for the whole, created if it does not exist
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    run: RunOptions,
}

/// The reports of commands, apart from the pages made from them.
const REPORTS: [(&str, &str); 3] = [
    (BENCH, "bench.json"),
    (STRESS, "stress.json"),
    (judge::COMMAND, "judge.json"),
];
const BENCH: &str = "bench";
const STRESS: &str = "stress";

/// The files made from the parts: the `--json` output.
#[derive(Serialize)]
struct Record {
    /// The command that wrote the parts.
    command: String,
    parts: usize,
    files: Vec<String>,
}

/// The content of the folders.
enum Found {
    /// Part files of one command, grouped by the whole that they belong to.
    Files(String, BTreeMap<String, Vec<Part>>),
    /// A report of this command in each folder: each folder is a part.
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

/// Writes the wholes into a folder. The inner result is that of the whole run.
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

/// Joins these folders' reports into one in a folder. The inner result is that of the whole run.
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

/// Groups parts by the whole that they belong to.
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

/// Refuses a folder that holds another command's report. Files of the same names are compared later, by
/// [`Draft::publish`].
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

/// A temporary folder inside the output folder, where the whole is made; removed when dropped.
struct Draft {
    out: PathBuf,
    folder: PathBuf,
    /// Whether the output folder was created for this.
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

    /// Moves all files to their places, and returns their paths.
    ///
    /// # Errors
    /// When a different file exists at one of the paths: then none is moved.
    fn publish(mut self) -> Result<Vec<PathBuf>, Failure> {
        let mut files = Vec::new();
        files_under(&self.folder, Path::new(""), &mut files)
            .map_err(|reason| Failure::unread(&self.folder, reason))?;
        files.sort();
        for file in &files {
            let place = self.out.join(file);
            if place.exists() && fs::read(&place).ok() != fs::read(self.folder.join(file)).ok() {
                return Err(Failure::bad_input(format!(
                    "{} exists already with other content than these parts make; delete it or choose another \
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
        // A folder that cannot be removed is hidden and harmless.
        let _ = fs::remove_dir_all(&self.folder);
        if self.made_out {
            let _ = fs::remove_dir(&self.out);
        }
    }
}

/// The files under `folder` and its subfolders, as paths relative to `folder`.
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
