//! Files of results: opened before the work starts, there when it is complete.

use std::{
    io::Write as _,
    path::{Path, PathBuf},
};

use atomic_write_file::AtomicWriteFile;
use serde::Serialize;

use super::Failure;
use crate::measure::whole_file;

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
        whole_file::create_folder(folder)?;
        let file = whole_file::open(&path)?;
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
        let written = self.file.write_all(text.as_bytes());
        written
            .and_then(|()| self.file.commit())
            .map_err(|reason| Failure::unwritten(&self.path, reason))
    }
}
