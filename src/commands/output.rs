//! Results go to stdout, everything else to stderr.

use std::{
    io::{self, IsTerminal as _, Write as _},
    path::Path,
    time::Duration,
};

use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;

use super::{Failure, options::RunOptions};
use crate::gpu::{Gpu, ShaderChecks};

/// Prints a result. A reader that has closed the pipe (`grotto info | head -1`) is not an error.
///
/// # Errors
/// When stdout cannot be written, as on a full disk.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    let written = stdout
        .write_all(text.as_bytes())
        .and_then(|()| stdout.flush());
    match written {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::unwritten(Path::new("stdout"), error))
        }
        _ => Ok(()),
    }
}

/// Prints one JSON object on one line.
///
/// # Errors
/// See [`print()`].
pub fn print_json(value: &impl Serialize) -> Result<(), Failure> {
    let mut line = serde_json::to_string(value).map_err(Failure::fault)?;
    line.push('\n');
    print(&line)
}

/// Prints a note to stderr, unless the user asked for quiet.
pub fn note(run: &RunOptions, text: &str) {
    if !run.quiet {
        eprintln!("{text}");
    }
}

/// A bar on stderr if that is a terminal and `--quiet` is not given; else a hidden one.
pub fn progress(run: &RunOptions, unit: &'static str, length: u64) -> ProgressBar {
    if run.quiet || !io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let style =
        ProgressStyle::with_template("{bar:40} {percent:>3} % of {human_len} {msg}, {eta} left")
            .expect("the template is valid");
    ProgressBar::new(length)
        .with_style(style)
        .with_message(unit)
}

/// A sign of life for work of unknown length, shown where [`progress`] is.
pub fn spinner(run: &RunOptions, doing: &'static str) -> ProgressBar {
    if run.quiet || !io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let spinner = ProgressBar::new_spinner().with_message(doing);
    spinner.enable_steady_tick(Duration::from_millis(100));
    spinner
}

/// Opens the adapter that the user named, or the fastest. Prints a warning if it is a CPU.
///
/// # Errors
/// Without any adapter, and when none has that name.
pub fn open_gpu(run: &RunOptions) -> Result<Gpu, Failure> {
    let gpu = Gpu::open(run.adapter.as_deref(), ShaderChecks::default())?;
    if gpu.summary.is_software() {
        note(
            run,
            &format!(
                "WARNING: {} is a software adapter: a CPU does the work of the GPU. Its times say \
                 nothing about a GPU's.",
                gpu.summary.name
            ),
        );
    }
    Ok(gpu)
}
