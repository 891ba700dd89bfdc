//! `grotto saves`: lists, copies, renames and deletes what was saved in the window.

use std::{
    io::{self, BufRead as _, IsTerminal as _, Write as _},
    path::{Path, PathBuf},
    time::{Duration, UNIX_EPOCH},
};

use clap::{Args, Subcommand};
use serde::Serialize;

use super::{Failure, info::bytes, options::OutputOptions, output};
use crate::world::save::{self, Folder, Listed, VARIABLE};

/// List, copy, rename and delete saves
///
/// Saves lie in the user's folder for data of programs, or in the folder that GROTTO_SAVES names. `grotto play FILE`
/// goes on from one.
#[derive(Args)]
pub struct Arguments {
    #[command(subcommand)]
    action: Action,
}

#[derive(Subcommand)]
enum Action {
    /// List the saves, the latest first
    List {
        #[command(flatten)]
        output: OutputOptions,
    },
    /// Copy a save to another name
    Copy(Names),
    /// Give a save another name
    Rename(Names),
    /// Delete a save and its backup
    Delete {
        /// Name or file of the save
        #[arg(value_name = "SAVE")]
        from: String,
        /// Do not ask
        #[arg(long)]
        yes: bool,
        #[command(flatten)]
        output: OutputOptions,
    },
}

#[derive(Args)]
struct Names {
    /// Name or file of the save
    #[arg(value_name = "SAVE")]
    from: String,
    /// The new name
    #[arg(value_name = "NAME")]
    to: String,
    #[command(flatten)]
    output: OutputOptions,
}

/// The `--json` of the list.
#[derive(Serialize)]
struct List {
    folder: PathBuf,
    saves: Vec<Row>,
}

#[derive(Serialize)]
struct Row {
    name: String,
    file: PathBuf,
    bytes: u64,
    /// The rest is known only of a save whose head is whole.
    #[serde(flatten)]
    head: Option<save::Head>,
    error: Option<String>,
}

/// The `--json` of a change.
#[derive(Serialize)]
struct Changed {
    file: PathBuf,
}

pub fn run(arguments: Arguments) -> Result<(), Failure> {
    let folder = Folder::of_user().ok_or_else(|| {
        Failure::bad_input(format!(
            "this user has no home folder, and so no saves: name their folder by {VARIABLE}"
        ))
    })?;
    match arguments.action {
        Action::List { output } => list(&folder, output),
        Action::Copy(Names { from, to, output }) => {
            let (from, to) = (existing(&folder, &from)?, folder.free(&to)?);
            save::copy(&from, &to)?;
            done(output, "copied to", to)
        }
        Action::Rename(Names { from, to, output }) => {
            let (from, to) = (existing(&folder, &from)?, folder.free(&to)?);
            save::rename(&from, &to)?;
            done(output, "renamed to", to)
        }
        Action::Delete { from, yes, output } => {
            let from = existing(&folder, &from)?;
            if !yes && !confirmed(&from)? {
                return Err(Failure::bad_input(format!("{} is kept", from.display())));
            }
            save::delete(&from)?;
            done(output, "deleted", from)
        }
    }
}

fn done(output: OutputOptions, what: &str, file: PathBuf) -> Result<(), Failure> {
    match (output.json, output.quiet) {
        (true, _) => output::print_json(&Changed { file }),
        (false, true) => Ok(()),
        (false, false) => output::print(&format!("{what} {}\n", file.display())),
    }
}

/// A save by its name, or by its file.
fn existing(folder: &Folder, name: &str) -> Result<PathBuf, Failure> {
    let named = folder.file(name).filter(|path| path.is_file());
    let path = named.unwrap_or_else(|| PathBuf::from(name));
    if path.is_file() && save::is_save(&path) {
        return Ok(path);
    }
    let names: Vec<String> = folder
        .list()?
        .into_iter()
        .map(|one| format!("`{}`", one.name))
        .collect();
    let known = match &names[..] {
        [] => "has no saves yet".to_owned(),
        names => format!("has {}", names.join(", ")),
    };
    Err(Failure::bad_input(format!(
        "there is no save `{name}`; {} {known}",
        folder.path().display()
    )))
}

/// Asks at the terminal.
fn confirmed(path: &Path) -> Result<bool, Failure> {
    if !io::stdin().is_terminal() {
        return Err(Failure::bad_input(format!(
            "{} is kept: there is no terminal to ask at; --yes deletes without asking",
            path.display()
        )));
    }
    eprint!("Delete {} and its backup for ever? [y/N] ", path.display());
    io::stderr().flush().map_err(Failure::fault)?;
    let mut answer = String::new();
    io::stdin()
        .lock()
        .read_line(&mut answer)
        .map_err(Failure::fault)?;
    Ok(matches!(answer.trim(), "y" | "Y" | "yes"))
}

fn list(folder: &Folder, options: OutputOptions) -> Result<(), Failure> {
    let saves = folder.list()?;
    if options.json {
        let saves = saves.into_iter().map(Row::from).collect();
        return output::print_json(&List {
            folder: folder.path().to_owned(),
            saves,
        });
    }
    if saves.is_empty() {
        let none = format!(
            "{} has no saves yet: Ctrl+S in the window saves\n",
            folder.path().display()
        );
        return output::print(&none);
    }
    let width = saves
        .iter()
        .map(|one| one.name.chars().count())
        .max()
        .unwrap_or(0);
    let mut text = format!("in {}\n", folder.path().display());
    for Listed {
        name,
        bytes: length,
        head,
        ..
    } in &saves
    {
        let about = match head {
            Ok(head) => {
                let at = UNIX_EPOCH + Duration::from_secs(head.saved_s.min(LATEST_S));
                let at = humantime::format_rfc3339_seconds(at).to_string();
                let at = at.replace('T', " ").replace('Z', " UTC");
                format!("{at}  {}, {} voxels changed", head.world, head.voxels)
            }
            Err(error) => error.to_string(),
        };
        text += &format!("{name:width$}  {:>8}  {about}\n", bytes(*length));
    }
    output::print(&text)
}

/// The last second of the year 9999: later ones cannot be printed.
const LATEST_S: u64 = 253_402_300_799;

impl From<Listed> for Row {
    fn from(listed: Listed) -> Self {
        let (head, error) = match listed.head {
            Ok(head) => (Some(head), None),
            Err(error) => (None, Some(error.to_string())),
        };
        Self {
            name: listed.name,
            file: listed.path,
            bytes: listed.bytes,
            head,
            error,
        }
    }
}
