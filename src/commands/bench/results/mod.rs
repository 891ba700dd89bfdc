//! The files of a report: `bench.json`, `rows.csv`, `index.html` and `frames.csv.gz` in one folder.

mod frame_log;
mod probe_tables;
mod rows_csv;
mod summary;

use std::{
    fs,
    path::{Path, PathBuf},
};

pub use self::{
    frame_log::{FRAMES, FrameLog, FrameSample, join_logs},
    rows_csv::rows_csv,
    summary::summary,
};
use super::{
    super::{Failure, out_file::OutFile},
    model::{self, Report},
    page,
};

const CSV: &str = "rows.csv";
const HTML: &str = "index.html";

/// The folder that a report is written to. The report is rewritten after every round of rows.
pub struct Files {
    folder: PathBuf,
}

impl Files {
    /// Makes the folder if need be, and checks that it can be written. Files in it are unchanged until the
    /// first [`write`](Self::write).
    ///
    /// # Errors
    /// When a file cannot be written, and when the folder already holds results, unless they may be
    /// overwritten.
    pub fn new(folder: &Path, overwrite: bool) -> Result<Self, Failure> {
        if !overwrite {
            refuse_results(folder)?;
        }
        for name in [model::FILE, CSV, HTML, FRAMES] {
            // A file that is dropped leaves no trace.
            OutFile::new(folder, name)?;
        }
        Ok(Self {
            folder: folder.to_owned(),
        })
    }

    /// Replaces the previous report, file by file: each file is complete at every moment.
    ///
    /// # Errors
    /// When a file cannot be written, as on a full disk.
    pub fn write(&self, report: &Report) -> Result<(), Failure> {
        let file = |name| OutFile::new(&self.folder, name);
        file(model::FILE)?.write_json(report)?;
        file(CSV)?.write(&rows_csv(report))?;
        file(HTML)?.write(&page::page(report))
    }

    /// The log of every frame, in the same folder. `about` describes in one line what was measured where: it
    /// becomes the comment of the gzip file.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn frame_log(&self, about: &str) -> Result<FrameLog, Failure> {
        FrameLog::new(&self.folder.join(FRAMES), about)
    }
}

/// Extensions of files that other commands, or another run, have left in a folder.
const RESULTS: [&str; 5] = ["json", "csv", "html", "gz", "md"];

/// # Errors
/// When the folder holds results; the error names them.
fn refuse_results(folder: &Path) -> Result<(), Failure> {
    let shown = folder.display();
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(()),
        Err(error) => return Err(Failure::unread(folder, error)),
        Ok(entries) => entries,
    };
    let remedy = "name another folder, or add --overwrite";
    if folder.join(model::FILE).exists() {
        let what = match Report::read(folder) {
            Ok(report) => format!(
                "a report of `grotto bench {}` from {}{}",
                report.suite,
                report.started,
                if report.complete { "" } else { " (partial)" }
            ),
            Err(_) => format!("a {} that this grotto cannot read", model::FILE),
        };
        return Err(Failure::bad_input(format!(
            "{shown} already holds {what}: {remedy}"
        )));
    }
    let is_result = |path: &PathBuf| {
        path.extension()
            .is_some_and(|found| RESULTS.iter().any(|known| found == *known))
    };
    let paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
    match paths.filter(is_result).min() {
        Some(other) => Err(Failure::bad_input(format!(
            "{shown} already holds other results ({}): {remedy}",
            other.file_name().unwrap_or_default().to_string_lossy()
        ))),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::{super::made_up::report, *};

    #[test]
    fn a_report_is_read_as_it_was_written() {
        let folder = tempfile::tempdir().expect("a folder");
        let out = folder.path().join("new/one");
        let files = Files::new(&out, false).expect("a new folder");
        assert_eq!(fs::read_dir(&out).expect("made").count(), 0, "no trace");
        let report = report();
        files.write(&report).expect("writable");
        files.write(&report).expect("again");
        // Not `assert_eq`: a printed report fills several screens.
        assert!(Report::read(&out).expect("its file") == report);
        for name in [CSV, HTML] {
            assert!(out.join(name).metadata().expect("a file").len() > 100);
        }
    }

    #[test]
    fn results_are_not_overwritten_without_a_word() {
        let folder = tempfile::tempdir().expect("a folder");
        let out = folder.path();
        fs::write(out.join("notes.txt"), "mine").expect("writable");
        let files = Files::new(out, false).expect("no results");
        let refused = |part: &str| {
            let failure = Files::new(out, false).err().expect("refused");
            assert_eq!(failure.exit_code(), 2);
            assert!(failure.reason().contains(part), "{failure}");
            assert!(failure.reason().contains("--overwrite"), "{failure}");
        };
        files.write(&report()).expect("writable");
        refused("from 2026-11-22");
        Files::new(out, true).expect("they may be overwritten");
        let partial = Report {
            complete: false,
            ..report()
        };
        files.write(&partial).expect("writable");
        refused("(partial)");
        fs::write(out.join(model::FILE), "{}").expect("writable");
        refused("cannot read");
        for name in [model::FILE, CSV, HTML] {
            fs::remove_file(out.join(name)).expect("there");
        }
        fs::write(out.join("judge.json"), "{}").expect("writable");
        refused("judge.json");
    }

    #[test]
    fn a_folder_that_cannot_be_made_is_bad_input() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("file");
        fs::write(&file, "").expect("writable");
        for path in [&file, &file.join("below")] {
            let failure = Files::new(path, true).err().expect("refused");
            assert_eq!(failure.exit_code(), 2, "{failure}");
            assert!(failure.reason().contains("file"), "{failure}");
        }
    }
}
