//! Results go to stdout, everything else to stderr.

use std::{
    io::{self, IsTerminal as _, Write as _},
    path::Path,
    thread,
    time::{Duration, Instant},
};

use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;

use super::{
    Failure,
    options::{RunOptions, Setup},
};
use crate::{
    frame::{begin_shaders, begin_world},
    gpu::{EarlyShaders, Gpu, GpuError, ShaderChecks, made},
};

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
    let ((), opened) = open_while(run.adapter.as_deref(), |_| Ok(()))?;
    usable(run, opened.gpu)
}

/// Opens the adapter as [`open_gpu`] does, while `load` reads a scene and checks it.
///
/// # Errors
/// Those of `load`, then those of [`open_gpu`].
pub fn load_and_open(
    run: &RunOptions,
    load: impl FnOnce() -> Result<Setup, Failure>,
) -> Result<(Setup, Gpu), Failure> {
    let (setup, opened) = open_while(run.adapter.as_deref(), |shaders| {
        let setup = load()?;
        begin_world(shaders, &setup.world);
        Ok(setup)
    })?;
    Ok((setup, usable(run, opened.gpu)?))
}

/// An adapter that was opened beside other work.
pub struct Opened {
    pub gpu: Result<Gpu, GpuError>,
    pub at: Instant,
}

/// Opens an adapter and composes the shaders of the first frame while `load` runs, which may begin further shaders.
/// What is wrong with the user's files is told first, whatever the adapter says.
///
/// # Errors
/// Those of `load`.
pub fn open_while<T>(
    adapter: Option<&str>,
    load: impl FnOnce(&EarlyShaders) -> Result<T, Failure>,
) -> Result<(T, Opened), Failure> {
    let shaders = begin_shaders();
    thread::scope(|threads| {
        let opening = threads.spawn(|| {
            let gpu = Gpu::open(adapter, ShaderChecks::default());
            (gpu, Instant::now())
        });
        let loaded = load(&shaders);
        // A process must not end while a driver opens a device: wait even after an error.
        let (gpu, at) = made(opening);
        let gpu = gpu.map(|gpu| gpu.with_early(shaders.clone()));
        Ok((loaded?, Opened { gpu, at }))
    })
}

/// Warns if an opened adapter is a CPU.
pub fn usable(run: &RunOptions, gpu: Result<Gpu, GpuError>) -> Result<Gpu, Failure> {
    let gpu = gpu?;
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
