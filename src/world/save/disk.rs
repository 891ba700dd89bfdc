//! Saves as files. At every moment there is a whole save under its name, or under the name of its backup.

use std::{
    fs::{self, File},
    io::{self, ErrorKind, Read as _, Write},
    path::{Path, PathBuf},
};

use atomic_write_file::AtomicWriteFile;

use super::{
    EXTENSION, Head, LARGEST, Save, SaveError,
    format::{self, FIXED, Fault, Start},
};
use crate::world::file::read_bytes;

/// A save that was opened.
#[derive(Debug)]
pub struct Opened {
    pub save: Save,
    /// What a person must know about it: that it is the backup, and why.
    pub note: Option<String>,
}

/// Whether a file is a save: by its extension, or by its first bytes.
pub fn is_save(path: &Path) -> bool {
    let begins_as_one = || {
        let mut first = [0; format::MAGIC.len()];
        let file = File::open(path).and_then(|mut file| file.read_exact(&mut first));
        file.is_ok() && first == format::MAGIC
    };
    path.extension().is_some_and(|found| found == EXTENSION) || (path.is_file() && begins_as_one())
}

/// The backup of a save: what was saved before.
pub fn backup_of(path: &Path) -> PathBuf {
    with_ending(path, ".bak")
}

fn with_ending(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(ending);
    name.into()
}

/// Replaces a save, and keeps the one before as its backup.
///
/// # Errors
/// [`SaveError`] when it cannot be written; the old save is then unchanged.
pub fn write(path: &Path, save: &Save) -> Result<(), SaveError> {
    let bytes = format::encode(save);
    if bytes.len() as u64 > LARGEST {
        return Err(SaveError::TooLarge {
            path: path.to_owned(),
            bytes: bytes.len() as u64,
        });
    }
    replace(path, |file| file.write_all(&bytes)).map_err(|error| unwritable(path, &error))
}

/// The error of a file or a folder that cannot be written.
pub(super) fn unwritable(path: &Path, error: &io::Error) -> SaveError {
    SaveError::Unwritable {
        path: path.to_owned(),
        reason: in_words(error),
    }
}

/// Writes a new file beside the old one, makes the old one the backup, and gives the new one its name.
fn replace(path: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new("."));
    fs::create_dir_all(folder)?;
    let mut file = AtomicWriteFile::open(path)?;
    fill(&mut file)?;
    file.sync_all()?;
    if path.exists() {
        keep_backup(path)?;
    }
    file.commit()?;
    // The new name must last too. Not every system can synchronise a folder.
    let _ = File::open(folder).and_then(|folder| folder.sync_all());
    Ok(())
}

/// A second name for the same file: the first one is never missing.
fn keep_backup(path: &Path) -> io::Result<()> {
    let (backup, link) = (backup_of(path), with_ending(path, ".bak.part"));
    // Left by a program that was killed.
    remove_if_there(&link)?;
    // Not every file system has links.
    fs::hard_link(path, &link).or_else(|_| {
        fs::copy(path, &link)?;
        File::open(&link)?.sync_all()
    })?;
    fs::rename(&link, &backup)?;
    // Renaming one name of a file to another name of the same file does nothing.
    remove_if_there(&link)
}

fn remove_if_there(path: &Path) -> io::Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

/// Why a file cannot be written, and what to do.
fn in_words(error: &io::Error) -> String {
    match error.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => {
            "the disk is full; free some space and save again".to_owned()
        }
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
            "permission denied; choose a folder that you may use".to_owned()
        }
        ErrorKind::InvalidFilename => "the name is too long; choose a shorter one".to_owned(),
        ErrorKind::IsADirectory => "it is a folder; choose another name".to_owned(),
        ErrorKind::NotADirectory | ErrorKind::AlreadyExists => {
            "a file is where its folder should be; choose another place".to_owned()
        }
        _ => format!("it cannot be written: {error}; choose another place or try again"),
    }
}

/// Reads a save.
///
/// # Errors
/// [`SaveError`]: missing, unreadable, damaged or of a newer version.
pub fn read(path: &Path) -> Result<Save, SaveError> {
    if fs::symlink_metadata(path).is_err_and(|error| error.kind() == ErrorKind::NotFound) {
        return Err(SaveError::Missing(path.to_owned()));
    }
    let bytes = read_bytes(path, LARGEST).map_err(|reason| SaveError::Unreadable {
        path: path.to_owned(),
        reason,
    })?;
    format::decode(&bytes).map_err(|fault| fault.at(path))
}

/// Reads the head of a save, and nothing else.
///
/// # Errors
/// Those of [`read`].
pub fn read_head(path: &Path) -> Result<Head, SaveError> {
    let unreadable = |error: io::Error| match error.kind() {
        ErrorKind::NotFound => SaveError::Missing(path.to_owned()),
        _ => SaveError::Unreadable {
            path: path.to_owned(),
            reason: format!("it cannot be read: {error}"),
        },
    };
    let file = File::open(path).map_err(unreadable)?;
    let mut bytes = Vec::new();
    let reading = (&file).take(FIXED as u64).read_to_end(&mut bytes);
    reading.map_err(unreadable)?;
    let start = Start::read(&bytes).map_err(|fault| fault.at(path))?;
    let reading = (&file)
        .take(start.head_length() as u64)
        .read_to_end(&mut bytes);
    reading.map_err(unreadable)?;
    start.head(&bytes).map_err(|fault| fault.at(path))
}

impl Fault {
    fn at(self, path: &Path) -> SaveError {
        let path = path.to_owned();
        match self {
            Self::Damaged(reason) => SaveError::Damaged { path, reason },
            Self::Newer { version, grotto } => SaveError::Newer {
                path,
                version,
                grotto,
            },
        }
    }
}

/// Opens a save to go on from there. A damaged one is set aside, and its backup is opened in its place.
///
/// # Errors
/// Those of [`read`], and [`SaveError::Lost`] for a damaged save without a good backup.
pub fn open(path: &Path) -> Result<Opened, SaveError> {
    let backup = backup_of(path);
    match read(path) {
        Ok(save) => Ok(Opened { save, note: None }),
        Err(SaveError::Damaged { reason, .. }) => {
            let aside = free_name(&with_ending(path, ".damaged"));
            let aside = match fs::rename(path, &aside) {
                Ok(()) => format!("; it was set aside as {}", aside.display()),
                Err(error) => format!("; it could not be set aside ({error})"),
            };
            match read(&backup) {
                Ok(save) => Ok(Opened {
                    save,
                    note: Some(format!(
                        "{} is damaged ({reason}){aside}. Its backup was opened: what was saved before",
                        path.display()
                    )),
                }),
                Err(error) => Err(SaveError::Lost {
                    path: path.to_owned(),
                    reason,
                    aside,
                    backup: match error {
                        SaveError::Missing(_) => "none was made".to_owned(),
                        error => error.to_string(),
                    },
                }),
            }
        }
        Err(SaveError::Missing(_)) if backup.exists() => Ok(Opened {
            save: read(&backup)?,
            note: Some(format!(
                "{} is missing. Its backup was opened: what was saved before",
                path.display()
            )),
        }),
        Err(error) => Err(error),
    }
}

/// This path, or with a number where it is taken.
fn free_name(path: &Path) -> PathBuf {
    let numbered = (2..).map(|number| with_ending(path, &format!("{number}")));
    std::iter::once(path.to_owned())
        .chain(numbered)
        .find(|path| fs::symlink_metadata(path).is_err())
        .unwrap_or_else(|| path.to_owned())
}

#[cfg(test)]
mod tests {
    use glam::UVec3;

    use super::*;
    use crate::world::{Overlay, save::sample::save_of};

    fn numbered(number: u32) -> Save {
        let mut overlay = Overlay::default();
        overlay.set(UVec3::new(number, 0, 0), 1);
        save_of(overlay)
    }

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).expect("readable");
        let names = entries.map(|entry| entry.expect("an entry").file_name());
        let mut names: Vec<_> = names
            .map(|name| name.to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn the_save_before_is_the_backup() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("new/my cave.grotto");
        for number in 0..4 {
            write(&path, &numbered(number)).expect("writable");
            assert_eq!(read(&path).expect("whole"), numbered(number));
            assert_eq!(read_head(&path).expect("whole"), numbered(number).head);
            if number > 0 {
                let backup = read(&backup_of(&path)).expect("whole");
                assert_eq!(backup, numbered(number - 1));
            }
        }
        let all = names(&folder.path().join("new"));
        assert_eq!(all, ["my cave.grotto", "my cave.grotto.bak"]);
        assert!(is_save(&path) && is_save(&backup_of(&path)));
        assert!(!is_save(folder.path()));
    }

    /// A disk that is full after so many bytes.
    struct Full<'a>(&'a mut dyn Write, usize);

    impl Write for Full<'_> {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            match self.1.min(bytes.len()) {
                0 => Err(ErrorKind::StorageFull.into()),
                room => {
                    self.1 -= room;
                    self.0.write(&bytes[..room])
                }
            }
        }

        fn flush(&mut self) -> io::Result<()> {
            self.0.flush()
        }
    }

    #[test]
    fn a_full_disk_leaves_the_old_save() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("cave.grotto");
        write(&path, &numbered(1)).expect("writable");
        let bytes = format::encode(&numbered(2));
        for room in [0, 1, 50, bytes.len() - 1] {
            let full = replace(&path, |file| Full(file, room).write_all(&bytes));
            let reason = in_words(&full.expect_err("the disk is full"));
            assert!(reason.contains("disk is full"), "{reason}");
            assert_eq!(read(&path).expect("whole"), numbered(1));
            assert_eq!(names(folder.path()), ["cave.grotto"]);
        }
    }

    #[test]
    fn a_killed_writer_leaves_no_obstacle() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("cave.grotto");
        write(&path, &numbered(1)).expect("writable");
        // Killed after the backup got its name, and before the save did; and before that.
        fs::hard_link(&path, backup_of(&path)).expect("links");
        fs::hard_link(&path, with_ending(&path, ".bak.part")).expect("links");
        write(&path, &numbered(2)).expect("writable");
        assert_eq!(read(&path).expect("whole"), numbered(2));
        assert_eq!(read(&backup_of(&path)).expect("whole"), numbered(1));
        assert_eq!(names(folder.path()), ["cave.grotto", "cave.grotto.bak"]);
    }

    #[test]
    fn a_damaged_save_is_set_aside_and_its_backup_opened() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("cave.grotto");
        for number in [1, 2] {
            write(&path, &numbered(number)).expect("writable");
        }
        let half = |path: &Path| {
            let bytes = fs::read(path).expect("readable");
            fs::write(path, &bytes[..bytes.len() / 2]).expect("writable");
        };
        half(&path);
        let opened = open(&path).expect("the backup is good");
        assert_eq!(opened.save, numbered(1));
        let note = opened.note.expect("it is said");
        assert!(note.contains("cave.grotto.damaged"), "{note}");
        let opened = open(&path).expect("the backup is good");
        assert!(opened.note.is_some_and(|note| note.contains("is missing")));
        write(&path, &numbered(3)).expect("writable");
        half(&path);
        half(&backup_of(&path));
        let error = open(&path).expect_err("both are damaged").to_string();
        for part in [
            "cave.grotto.damaged2",
            "no good backup",
            "cave.grotto.bak: ",
        ] {
            assert!(error.contains(part), "{error}");
        }
    }

    #[test]
    fn what_cannot_be_opened_says_why_and_stays() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("cave.grotto");
        let message = |path: &Path| open(path).expect_err("it is bad").to_string();
        assert!(message(&path).contains("no such save"));
        let huge = File::create(&path).expect("writable");
        huge.set_len(2 << 30).expect("a sparse file");
        assert!(
            message(&path).contains("more than the 536 MB"),
            "{}",
            message(&path)
        );
        assert!(matches!(read_head(&path), Err(SaveError::Damaged { .. })));
        assert!(path.exists());
        fs::create_dir(folder.path().join("folder.grotto")).expect("writable");
        assert!(message(&folder.path().join("folder.grotto")).contains("is not a file"));
    }
}
