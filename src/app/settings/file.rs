//! The file of settings: where it lies, and when it is written.

use std::{
    env, fs,
    io::Write as _,
    path::{Path, PathBuf},
};

use directories::ProjectDirs;

use super::{Preferences, Read};
use crate::{
    app::texts::settings_file,
    measure::whole_file::{self, FileError},
};

/// Names another folder for the settings than the user's folder for settings of programs.
const VARIABLE: &str = "GROTTO_CONFIG";

const NAME: &str = "settings.json";
/// The largest file that is read: settings are small, and anything else must not fill the memory.
const MOST_BYTES: u64 = 1 << 20;

/// The file, and what it holds.
#[derive(Debug)]
pub struct Store {
    /// `None` for a user without a home, and for a file that must not be written.
    path: Option<PathBuf>,
    kept: Preferences,
}

impl Store {
    /// Opens the user's settings. Returns what is to be said about them, one text for each thing.
    pub fn of_user() -> (Self, Vec<String>) {
        let named = env::var_os(VARIABLE).filter(|folder| !folder.is_empty());
        let own = || Some(ProjectDirs::from("", "", "grotto")?.config_dir().to_owned());
        match named.map(PathBuf::from).or_else(own) {
            Some(folder) => Self::at(&folder),
            None => (Self::nowhere(), vec![settings_file::NO_HOME.to_owned()]),
        }
    }

    /// Opens the settings of a folder, which need not exist.
    pub fn at(folder: &Path) -> (Self, Vec<String>) {
        let path = folder.join(NAME);
        let (read, note) = match read(&path) {
            Ok(read) => (read, None),
            Err(Unread::Damaged(reason)) => (None, Some(set_aside(&path, &reason))),
            Err(Unread::Unreadable(error)) => {
                return (
                    Self::nowhere(),
                    vec![settings_file::unread(&error.to_string())],
                );
            }
        };
        let mut store = Self {
            path: Some(path),
            kept: Preferences::default(),
        };
        let Some(read) = read else {
            return (store, note.into_iter().collect());
        };
        let mut notes: Vec<String> = read
            .notes
            .iter()
            .map(|note| settings_file::note(note))
            .collect();
        if read.is_newer {
            store.path = None;
            notes.push(settings_file::NEWER.to_owned());
        }
        store.kept = read.preferences;
        (store, notes)
    }

    fn nowhere() -> Self {
        Self {
            path: None,
            kept: Preferences::default(),
        }
    }

    /// What the file holds.
    pub fn kept(&self) -> &Preferences {
        &self.kept
    }

    /// Keeps the settings if they differ from those kept. What cannot be written is told once, and not tried again.
    ///
    /// # Errors
    /// [`FileError`] when the file cannot be written.
    pub fn keep(&mut self, preferences: &Preferences) -> Result<(), FileError> {
        if *preferences == self.kept {
            return Ok(());
        }
        self.kept = preferences.clone();
        let Some(path) = self.path.take() else {
            return Ok(());
        };
        write(&path, preferences)?;
        self.path = Some(path);
        Ok(())
    }
}

/// Why a file was not read.
enum Unread {
    /// It holds no settings.
    Damaged(String),
    Unreadable(FileError),
}

fn read(path: &Path) -> Result<Option<Read>, Unread> {
    let unreadable = |reason| Unread::Unreadable(FileError::reading(path, reason));
    let bytes = match fs::metadata(path) {
        Ok(known) if known.len() > MOST_BYTES => {
            let reason = format!("it has {} bytes", known.len());
            return Err(Unread::Damaged(reason));
        }
        Ok(_) => fs::read(path).map_err(unreadable)?,
        Err(reason) if reason.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(reason) => return Err(unreadable(reason)),
    };
    let text =
        String::from_utf8(bytes).map_err(|_| Unread::Damaged(settings_file::NO_TEXT.to_owned()))?;
    let read = Preferences::read(&text).map_err(|error| Unread::Damaged(error.to_string()))?;
    Ok(Some(read))
}

/// Gives a damaged file another name, and says so.
fn set_aside(path: &Path, reason: &str) -> String {
    let mut aside = path.as_os_str().to_owned();
    aside.push(".damaged");
    let aside = PathBuf::from(aside);
    match fs::rename(path, &aside) {
        Ok(()) => settings_file::set_aside(reason, &aside),
        Err(error) => settings_file::not_set_aside(path, reason, &error.to_string()),
    }
}

fn write(path: &Path, preferences: &Preferences) -> Result<(), FileError> {
    let failed = |reason| FileError::writing(path, reason);
    if let Some(folder) = path.parent() {
        whole_file::create_folder(folder)?;
    }
    let text = preferences.text().map_err(|error| failed(error.into()))?;
    let mut file = whole_file::open(path)?;
    file.write_all(text.as_bytes())
        .and_then(|()| file.commit())
        .map_err(failed)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn muted() -> Preferences {
        Preferences {
            muted: true,
            ..Preferences::default()
        }
    }

    #[test]
    fn settings_are_kept_when_they_change() {
        let place = tempfile::tempdir().expect("a temporary folder");
        let folder = place.path().join("a/b");
        let (mut store, notes) = Store::at(&folder);
        assert!(notes.is_empty());
        store.keep(&Preferences::default()).expect("no need");
        assert!(!folder.exists(), "nothing was changed");
        store.keep(&muted()).expect("writable");
        let (store, notes) = Store::at(&folder);
        assert!(notes.is_empty(), "{notes:?}");
        assert_eq!(store.kept(), &muted());
        let files = fs::read_dir(&folder).expect("readable").count();
        assert_eq!(files, 1, "it was written whole");
    }

    #[test]
    fn a_damaged_file_is_set_aside_and_a_new_one_takes_its_place() {
        let place = tempfile::tempdir().expect("a temporary folder");
        let path = place.path().join(NAME);
        let large = "x".repeat(MOST_BYTES as usize + 1);
        for nonsense in [
            &b"{\"version\": 1, \"vsync\""[..],
            b"\xff\xfe",
            large.as_bytes(),
        ] {
            fs::write(&path, nonsense).expect("writable");
            let (mut store, notes) = Store::at(place.path());
            assert_eq!(store.kept(), &Preferences::default());
            assert_eq!(notes.len(), 1, "{notes:?}");
            assert!(notes[0].contains("settings.json.damaged"), "{}", notes[0]);
            let aside = place.path().join("settings.json.damaged");
            assert_eq!(fs::read(aside).expect("it is there"), nonsense);
            store.keep(&muted()).expect("writable");
            assert_eq!(Store::at(place.path()).0.kept(), &muted());
        }
    }

    #[test]
    fn what_cannot_be_written_is_said_once() {
        let place = tempfile::tempdir().expect("a temporary folder");
        let file = place.path().join("file");
        fs::write(&file, "x").expect("writable");
        let (mut store, notes) = Store::at(&place.path().join("gone"));
        assert!(notes.is_empty());
        fs::write(place.path().join("gone"), "x").expect("writable");
        let error = store.keep(&muted()).expect_err("a file is no folder");
        assert!(error.to_string().contains("gone is no folder"), "{error}");
        store
            .keep(&Preferences::default())
            .expect("not tried again");
        // A file where the folder should be is seen at once.
        let (mut store, notes) = Store::at(&file);
        assert_eq!(notes.len(), 1);
        store.keep(&muted()).expect("not tried");
        assert_eq!(fs::read(&file).expect("it is there"), b"x");
    }

    #[test]
    fn settings_of_a_newer_version_are_used_and_left_alone() {
        let place = tempfile::tempdir().expect("a temporary folder");
        let text = r#"{"version": 9, "muted": true, "smell": "fresh"}"#;
        fs::write(place.path().join(NAME), text).expect("writable");
        let (mut store, notes) = Store::at(place.path());
        assert!(store.kept().muted && notes.len() == 1, "{notes:?}");
        store.keep(&Preferences::default()).expect("not tried");
        let left = fs::read_to_string(place.path().join(NAME));
        assert_eq!(left.expect("it is there"), text);
    }
}
