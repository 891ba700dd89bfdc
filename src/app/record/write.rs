//! Writing a record while the run goes on.

use std::{
    fs::{self, File},
    io::{self, BufWriter, Write as _},
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use serde::Serialize;

use super::{Header, Moment, RecordError};
use crate::{app::input::Input, measure::whole_file::FileError};

/// Lines go to the disk at least this often.
const KEPT_EVERY: Duration = Duration::from_millis(500);
/// Without inputs, a line still marks the time this often (nanoseconds).
const MARK_EVERY_NS: u64 = 500_000_000;

pub struct Recorder {
    path: PathBuf,
    /// `FILE.part`: has the lines until the run ends.
    part: PathBuf,
    file: BufWriter<File>,
    kept: Instant,
    marked_ns: u64,
}

impl Recorder {
    /// Begins a record. An older file of that name stays until the run ends.
    ///
    /// # Errors
    /// [`RecordError::File`] when it cannot be written.
    pub fn create(path: &Path, header: &Header) -> Result<Self, RecordError> {
        if path.is_dir() {
            return Err(FileError::IsFolder(path.to_owned()).into());
        }
        let part = part_of(path);
        let file = File::create(&part).map_err(|reason| FileError::writing(path, reason))?;
        let mut recorder = Self {
            path: path.to_owned(),
            part,
            file: BufWriter::new(file),
            kept: Instant::now(),
            marked_ns: 0,
        };
        let written = recorder.line(header).and_then(|()| recorder.file.flush());
        written.map_err(|reason| FileError::writing(path, reason))?;
        Ok(recorder)
    }

    /// Adds inputs that took effect at this time.
    ///
    /// # Errors
    /// [`RecordError::File`] when it cannot be written, as on a full disk.
    pub fn add(&mut self, at_ns: u64, inputs: &[Input]) -> Result<(), RecordError> {
        if inputs.is_empty() && at_ns < self.marked_ns + MARK_EVERY_NS {
            return Ok(());
        }
        self.marked_ns = at_ns;
        let moment = Moment::new(at_ns, inputs.to_vec());
        let is_due = self.kept.elapsed() >= KEPT_EVERY;
        let written = self.line(&moment).and_then(|()| match is_due {
            true => self.file.flush(),
            false => Ok(()),
        });
        if is_due {
            self.kept = Instant::now();
        }
        Ok(written.map_err(|reason| FileError::writing(&self.path, reason))?)
    }

    /// The run ends: the file gets its name.
    ///
    /// # Errors
    /// [`RecordError::File`]; what was written so far stays in `FILE.part`.
    pub fn finish(mut self, at_ns: u64) -> Result<(), RecordError> {
        let mut end = Moment::new(at_ns, Vec::new());
        end.end = true;
        let written = self
            .line(&end)
            .and_then(|()| self.file.flush())
            .and_then(|()| self.file.get_ref().sync_all())
            .and_then(|()| fs::rename(&self.part, &self.path));
        Ok(written.map_err(|reason| FileError::writing(&self.path, reason))?)
    }

    fn line(&mut self, value: &impl Serialize) -> io::Result<()> {
        serde_json::to_writer(&mut self.file, value)?;
        self.file.write_all(b"\n")
    }
}

/// Where the lines of a record are until its run ends.
pub(super) fn part_of(path: &Path) -> PathBuf {
    let mut part = path.as_os_str().to_owned();
    part.push(".part");
    part.into()
}
