//! Files that appear only when they are complete, and file system errors in words.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use atomic_write_file::AtomicWriteFile;
use thiserror::Error;

/// Why a file cannot be read or written. Every message names it and a remedy.
#[derive(Debug, Error)]
pub enum FileError {
    #[error("{}: the folder {} does not exist; create it first", path.display(), folder.display())]
    NoFolder { path: PathBuf, folder: PathBuf },
    #[error("{}: {} is no folder; choose another place", path.display(), file.display())]
    NotAFolder { path: PathBuf, file: PathBuf },
    #[error("{}: is a folder; name a file in it", .0.display())]
    IsFolder(PathBuf),
    #[error("{}: no such file", .0.display())]
    NoFile(PathBuf),
    #[error("{}: permission denied; choose a place that you may use", .0.display())]
    Denied(PathBuf),
    #[error("{}: this name is too long for the file system; choose a shorter one", .0.display())]
    NameTooLong(PathBuf),
    #[error("{}: the disk is full; free some space or choose another disk", .0.display())]
    DiskFull(PathBuf),
    #[error("{}: {reason}; choose another place or try again", path.display())]
    Io { path: PathBuf, reason: io::Error },
}

impl FileError {
    /// The error that prevented writing a file or a folder.
    pub fn writing(path: &Path, reason: io::Error) -> Self {
        match reason.kind() {
            io::ErrorKind::NotFound => Self::NoFolder {
                path: path.to_owned(),
                folder: path.parent().unwrap_or(Path::new(".")).to_owned(),
            },
            io::ErrorKind::IsADirectory => Self::IsFolder(path.to_owned()),
            _ => Self::of(path, reason),
        }
    }

    /// The error that prevented reading a file.
    pub fn reading(path: &Path, reason: io::Error) -> Self {
        match reason.kind() {
            io::ErrorKind::NotFound => Self::NoFile(path.to_owned()),
            io::ErrorKind::IsADirectory => Self::IsFolder(path.to_owned()),
            _ => Self::of(path, reason),
        }
    }

    fn of(path: &Path, reason: io::Error) -> Self {
        use io::ErrorKind as Kind;
        let named = path.to_owned();
        // A folder cannot be created under a file.
        let file = || {
            path.ancestors()
                .find(|part| part.exists() && !part.is_dir())
        };
        match reason.kind() {
            Kind::PermissionDenied | Kind::ReadOnlyFilesystem => Self::Denied(named),
            Kind::StorageFull | Kind::QuotaExceeded => Self::DiskFull(named),
            Kind::InvalidFilename => Self::NameTooLong(named),
            Kind::NotADirectory | Kind::AlreadyExists => Self::NotAFolder {
                file: file().unwrap_or(path).to_owned(),
                path: named,
            },
            _ => Self::Io {
                path: named,
                reason,
            },
        }
    }

    /// Whether the machine is at fault, not the given name.
    pub fn is_fault(&self) -> bool {
        matches!(self, Self::DiskFull(_) | Self::Io { .. })
    }
}

/// Stands for the characters that a file's name gets until the file is complete.
const GROWN: &str = ".........";

/// A file that replaces an older one when it is committed; if dropped, it leaves no trace.
///
/// # Errors
/// [`FileError`], as far as errors can be known before the file is complete.
pub fn open(path: &Path) -> Result<AtomicWriteFile, FileError> {
    if path.is_dir() {
        return Err(FileError::IsFolder(path.to_owned()));
    }
    let refused = |reason| FileError::writing(path, reason);
    // A file without a name is opened under any name: a name that is too long would be found only at
    // the end.
    let mut longest = path.as_os_str().to_owned();
    longest.push(GROWN);
    match fs::symlink_metadata(longest) {
        Err(reason) if reason.kind() == io::ErrorKind::InvalidFilename => Err(refused(reason)),
        _ => AtomicWriteFile::open(path).map_err(refused),
    }
}

/// Creates a folder and its parents.
///
/// # Errors
/// [`FileError`].
pub fn create_folder(path: &Path) -> Result<(), FileError> {
    fs::create_dir_all(path).map_err(|reason| FileError::writing(path, reason))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_written_says_why_and_what_to_do() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let file = folder.path().join("file");
        fs::write(&file, "x").expect("writable");
        let message = |error: FileError| error.to_string();
        let missing = open(&folder.path().join("no/a.csv")).expect_err("no folder");
        assert!(matches!(missing, FileError::NoFolder { .. }));
        let inside = open(&file.join("a.csv")).expect_err("no folder");
        assert!(message(inside).ends_with("file is no folder; choose another place"));
        let made = create_folder(&file).expect_err("a file");
        assert!(message(made).ends_with("file is no folder; choose another place"));
        assert!(matches!(open(folder.path()), Err(FileError::IsFolder(_))));
        for (kind, part) in [
            (io::ErrorKind::StorageFull, "disk is full; free"),
            (io::ErrorKind::PermissionDenied, "permission denied; choose"),
            (io::ErrorKind::Interrupted, "; choose another place"),
        ] {
            let error = FileError::writing(Path::new("a.png"), kind.into());
            assert!(message(error).contains(part), "{part}");
        }
    }

    #[test]
    fn names_that_are_too_long_are_refused_before_the_work_and_leave_no_trace() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let named = |length: usize| folder.path().join("a".repeat(length));
        for length in [250, 255, 256, 5000] {
            let error = open(&named(length)).expect_err("too long");
            assert!(matches!(error, FileError::NameTooLong(_)), "{error}");
            assert!(!error.is_fault());
        }
        let file = open(&named(240)).expect("short enough");
        file.commit().expect("written");
        let left = fs::read_dir(folder.path()).expect("readable").count();
        assert_eq!(left, 1);
    }
}
