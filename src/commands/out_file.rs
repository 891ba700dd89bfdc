//! Files of results: opened before the work starts, visible when they are complete.

use std::{
    io::Write as _,
    path::{Path, PathBuf},
};

use atomic_write_file::AtomicWriteFile;
use serde::Serialize;

use super::Failure;
use crate::measure::whole_file;

/// A result that is written when it is complete. Until then an older file stays; a dropped one leaves no trace.
pub struct OutFile {
    path: PathBuf,
    file: AtomicWriteFile,
}

impl OutFile {
    /// A file in a folder, which is created if need be.
    ///
    /// # Errors
    /// When the folder cannot be created or the file cannot be written, with the path.
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
    /// See [`write_json`](Self::write_json).
    pub fn write(mut self, text: &str) -> Result<(), Failure> {
        let written = self.file.write_all(text.as_bytes());
        written
            .and_then(|()| self.file.commit())
            .map_err(|reason| Failure::unwritten(&self.path, reason))
    }
}
