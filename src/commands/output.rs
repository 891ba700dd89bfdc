//! Results go to stdout, everything else to stderr.

use std::io::{self, Write as _};

use serde::Serialize;

use super::Failure;

/// Prints a result. A reader that has gone (`grotto info | head -1`) is no fault.
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
            Err(Failure::fault(format!("writing to stdout: {error}")))
        }
        _ => Ok(()),
    }
}

/// Prints one JSON object on one line.
///
/// # Errors
/// As [`print`].
pub fn print_json(value: &impl Serialize) -> Result<(), Failure> {
    let mut line = serde_json::to_string(value).map_err(Failure::fault)?;
    line.push('\n');
    print(&line)
}
