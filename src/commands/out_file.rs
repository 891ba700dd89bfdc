//! Files of results: opened before the work starts, there when it is complete.

use std::{
    io::Write as _,
    path::{Path, PathBuf},
};

use atomic_write_file::AtomicWriteFile;
use serde::Serialize;

use super::Failure;

/// A result to be written when it is complete. Until then an older one stays; dropped, it leaves no
/// trace.
pub struct OutFile {
    path: PathBuf,
    file: AtomicWriteFile,
}

impl OutFile {
    /// In a folder, which is made if need be.
    ///
    /// # Errors
    /// When the folder cannot be made or the file not be written, with the path.
    pub fn new(folder: &Path, name: &str) -> Result<Self, Failure> {
        let path = folder.join(name);
        let unusable = |error| Failure::bad_input(format!("{}: {error}", path.display()));
        std::fs::create_dir_all(folder).map_err(unusable)?;
        let file = AtomicWriteFile::open(&path).map_err(unusable)?;
        Ok(Self { path, file })
    }

    /// # Errors
    /// When the file cannot be written, as on a full disk.
    pub fn write_json(self, value: &impl Serialize) -> Result<(), Failure> {
        let mut text = serde_json::to_string_pretty(value).map_err(Failure::fault)?;
        text.push('\n');
        self.write(&text)
    }

    /// # Errors
    /// As [`write_json`](Self::write_json).
    pub fn write(mut self, text: &str) -> Result<(), Failure> {
        self.file
            .write_all(text.as_bytes())
            .and_then(|()| self.file.commit())
            .map_err(|error| Failure::fault(format!("{}: {error}", self.path.display())))
    }
}
