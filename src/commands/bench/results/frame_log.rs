//! `frames.csv.gz`: every measured frame.

use std::{
    fs::File,
    io::{self, BufRead as _, BufReader, BufWriter, Write},
    path::{Path, PathBuf},
};

use atomic_write_file::AtomicWriteFile;
use flate2::{Compression, GzBuilder, read::MultiGzDecoder, write::GzEncoder};

use super::{super::super::Failure, rows_csv::quoted};
use crate::measure::whole_file;

/// Name of the file in the folder of a report.
pub const FRAMES: &str = "frames.csv.gz";
const HEADER: &str = "row,run,frame,gpu_ms,cpu_ms,wall_ms,by_pass";

/// One frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameSample {
    /// Time between two GPU timestamps; `None` where the adapter has none.
    pub gpu_ms: Option<f64>,
    /// CPU time of recording and submitting the frame.
    pub cpu_ms: f64,
    /// Time since the previous frame.
    pub wall_ms: f64,
    /// Whether the frame was timed pass by pass. The statistics of frames leave such frames out.
    pub by_pass: bool,
}

/// Runs are appended as they finish. The file appears when the log is finished or dropped, so that an
/// interrupted run leaves all its frames in a valid file.
pub struct FrameLog {
    path: PathBuf,
    encoder: Option<GzEncoder<BufWriter<AtomicWriteFile>>>,
}

impl FrameLog {
    /// # Errors
    /// When the file cannot be written, with its path.
    pub(super) fn new(path: &Path, about: &str) -> Result<Self, Failure> {
        let file = whole_file::open(path)?;
        // The comment of a gzip file ends at its first zero byte.
        let comment = about.replace('\0', " ");
        let encoder = GzBuilder::new()
            .comment(comment.into_bytes())
            .write(BufWriter::new(file), Compression::fast());
        let mut log = Self {
            path: path.to_owned(),
            encoder: Some(encoder),
        };
        log.append(&format!("{HEADER}\n"))?;
        Ok(log)
    }

    /// Appends the frames of run `run` of a row, counted from 0.
    ///
    /// # Errors
    /// When the disk is full.
    pub fn run(&mut self, row_id: &str, run: u32, frames: &[FrameSample]) -> Result<(), Failure> {
        let row = quoted(row_id);
        let lines = frames.iter().enumerate().map(|(index, frame)| {
            let gpu = frame
                .gpu_ms
                .map_or(String::new(), |gpu_ms| format!("{gpu_ms:.6}"));
            format!(
                "{row},{run},{index},{gpu},{:.6},{:.6},{}\n",
                frame.cpu_ms, frame.wall_ms, frame.by_pass
            )
        });
        self.append(&lines.collect::<String>())
    }

    /// Moves the file to its final path.
    ///
    /// # Errors
    /// When the disk is full.
    pub fn finish(mut self) -> Result<(), Failure> {
        self.close()
    }

    fn append(&mut self, text: &str) -> Result<(), Failure> {
        let encoder = self.encoder.as_mut().expect("open until it is dropped");
        let written = encoder.write_all(text.as_bytes());
        written.map_err(|reason| Failure::unwritten(&self.path, reason))
    }

    fn close(&mut self) -> Result<(), Failure> {
        let Some(encoder) = self.encoder.take() else {
            return Ok(());
        };
        let closed = encoder
            .finish()
            .and_then(|buffer| buffer.into_inner().map_err(io::Error::from))
            .and_then(AtomicWriteFile::commit);
        closed.map_err(|reason| Failure::unwritten(&self.path, reason))
    }
}

impl Drop for FrameLog {
    fn drop(&mut self) {
        // Callers that want to know about a full disk call `finish`.
        let _ = self.close();
    }
}

/// Copies the frames of several logs into one, in this order. Each log comes with a suffix for the ids of its
/// rows.
///
/// # Errors
/// When a log cannot be read, or the new one cannot be written.
pub fn join_logs(logs: &[(PathBuf, String)], out: &Path, about: &str) -> Result<(), Failure> {
    let mut joined = FrameLog::new(out, about)?;
    for (path, suffix) in logs {
        let damaged = |error: &dyn std::fmt::Display| {
            Failure::bad_input(format!(
                "{} is damaged: {error}; measure it again with `grotto bench`",
                path.display()
            ))
        };
        let file = File::open(path).map_err(|reason| Failure::unread(path, reason))?;
        let mut lines = BufReader::new(MultiGzDecoder::new(file)).lines();
        let header = lines.next().transpose().map_err(|error| damaged(&error))?;
        if header.as_deref() != Some(HEADER) {
            return Err(damaged(&format!("its first line is not `{HEADER}`")));
        }
        for line in lines {
            let line = line.map_err(|error| damaged(&error))?;
            // No other field holds a comma.
            let fields: Vec<&str> = line.rsplitn(7, ',').collect();
            let [rest @ .., row] = &fields[..] else {
                return Err(damaged(&"an empty line"));
            };
            if rest.len() != 6 {
                return Err(damaged(&format!("`{line}` has not seven fields")));
            }
            let row = renamed(row, suffix);
            let rest: Vec<&str> = rest.iter().rev().copied().collect();
            joined.append(&format!("{row},{}\n", rest.join(",")))?;
        }
    }
    joined.finish()
}

/// A field with the id of a row, with the suffix appended, quoted as before.
fn renamed(row: &str, suffix: &str) -> String {
    match row.strip_suffix('"') {
        Some(open) if row.len() > 1 => format!("{open}{suffix}\""),
        _ => quoted(&format!("{row}{suffix}")),
    }
}

#[cfg(test)]
mod tests {
    use std::io::Read as _;

    use super::*;

    const FRAME: FrameSample = FrameSample {
        gpu_ms: Some(1.25),
        cpu_ms: 0.5,
        wall_ms: 2.0,
        by_pass: false,
    };

    fn read(path: &Path) -> String {
        let mut text = String::new();
        MultiGzDecoder::new(File::open(path).expect("the file"))
            .read_to_string(&mut text)
            .expect("a valid gzip file");
        text
    }

    #[test]
    fn frames_are_there_when_the_log_is_finished_or_dropped() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join(FRAMES);
        let mut log = FrameLog::new(&path, "grotto on a card").expect("writable");
        log.run("a/b", 0, &[FRAME; 2]).expect("room");
        let timeless = FrameSample {
            gpu_ms: None,
            by_pass: true,
            ..FRAME
        };
        log.run("a,b", 3, &[timeless]).expect("room");
        assert!(!path.exists(), "not before it is complete");
        drop(log);
        let expected = format!(
            "{HEADER}\na/b,0,0,1.250000,0.500000,2.000000,false\na/b,0,1,1.250000,0.500000,2.000000,false\n\
             \"a,b\",3,0,,0.500000,2.000000,true\n"
        );
        assert_eq!(read(&path), expected);
        let bytes = std::fs::read(&path).expect("the file");
        let comment = b"grotto on a card";
        assert!(bytes.windows(comment.len()).any(|at| at == comment));
        FrameLog::new(&path, "")
            .and_then(FrameLog::finish)
            .expect("writable");
        assert_eq!(read(&path), format!("{HEADER}\n"));
    }

    #[test]
    fn joined_logs_hold_every_frame_once_under_new_names() {
        let folder = tempfile::tempdir().expect("a folder");
        let part = |name: &str, row: &str| {
            let path = folder.path().join(name);
            let mut log = FrameLog::new(&path, "").expect("writable");
            log.run(row, 0, &[FRAME]).expect("room");
            log.finish().expect("room");
            path
        };
        let (a, b) = (part("a.gz", "x"), part("b.gz", "y,z"));
        let out = folder.path().join("all.gz");
        let parts = [(a.clone(), "@one".to_owned()), (b, "@two".to_owned())];
        join_logs(&parts, &out, "").expect("joined");
        let text = read(&out);
        assert_eq!(text.lines().count(), 3, "{text}");
        assert!(text.contains("\nx@one,0,0,1.250000,"), "{text}");
        assert!(text.contains("\n\"y,z@two\",0,0,1.250000,"), "{text}");

        let bytes = std::fs::read(&a).expect("the file");
        std::fs::write(&a, &bytes[..bytes.len() / 2]).expect("writable");
        let failure = join_logs(&parts, &out, "").expect_err("half a file");
        assert_eq!(failure.exit_code(), 2);
        assert!(failure.reason().contains("a.gz"), "{failure}");
        std::fs::write(&a, "row,run\n").expect("writable");
        join_logs(&parts, &out, "").expect_err("not a gzip file");
    }
}
