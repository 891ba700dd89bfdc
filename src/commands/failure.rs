//! Why a command ended without its result, and the exit code that says where the fault lies.

use std::{fmt, io, path::Path};

use crate::{
    app::record::RecordError,
    frame::FrameError,
    gpu::GpuError,
    measure::{picture_file::PictureError, whole_file::FileError},
    parameters::ParameterError,
    world::save::SaveError,
};

/// A fault of grotto or of the machine.
pub const EXIT_FAULT: u8 = 1;
/// A bad file or flag.
pub const EXIT_BAD_INPUT: u8 = 2;
/// No usable GPU.
pub const EXIT_NO_GPU: u8 = 3;

/// A comparison or regression gate failed.
pub const EXIT_GATE: u8 = 4;

/// Stopped by Ctrl-C or SIGTERM before the end: the exit code that shells report for such a program.
pub const EXIT_INTERRUPTED: u8 = 130;

/// One message for a person, and the exit code.
#[derive(Debug)]
pub struct Failure {
    exit_code: u8,
    message: String,
}

impl Failure {
    /// A fault of grotto or of the machine.
    pub fn fault(error: impl fmt::Display) -> Self {
        Self::new(EXIT_FAULT, error)
    }

    /// A file or flag that cannot be used: the message says what would be right.
    pub fn bad_input(error: impl fmt::Display) -> Self {
        Self::new(EXIT_BAD_INPUT, error)
    }

    /// The work was done, but its result fails a gate.
    pub fn gate(error: impl fmt::Display) -> Self {
        Self::new(EXIT_GATE, error)
    }

    /// A file or a folder that cannot be written.
    pub fn unwritten(path: &Path, reason: io::Error) -> Self {
        FileError::writing(path, reason).into()
    }

    /// A file that cannot be read.
    pub fn unread(path: &Path, reason: io::Error) -> Self {
        FileError::reading(path, reason).into()
    }

    /// The user stopped the run; results up to then are written.
    pub fn interrupted(error: impl fmt::Display) -> Self {
        Self::new(EXIT_INTERRUPTED, error)
    }

    fn new(exit_code: u8, error: impl fmt::Display) -> Self {
        Self {
            exit_code,
            message: format!("error: {}", error.to_string().trim_end()),
        }
    }

    pub fn exit_code(&self) -> u8 {
        self.exit_code
    }

    /// The message, for use within another message.
    pub fn reason(&self) -> &str {
        self.message
            .strip_prefix("error: ")
            .unwrap_or(&self.message)
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl From<GpuError> for Failure {
    fn from(error: GpuError) -> Self {
        let exit_code = match error {
            GpuError::NoAdapter { .. } => EXIT_NO_GPU,
            GpuError::AdapterNotFound { .. }
            | GpuError::TooLarge { .. }
            | GpuError::OutOfMemory { .. } => EXIT_BAD_INPUT,
            GpuError::Shader { .. } | GpuError::Device(_) => EXIT_FAULT,
        };
        Self::new(exit_code, error)
    }
}

impl From<FileError> for Failure {
    fn from(error: FileError) -> Self {
        match error.is_fault() {
            true => Self::fault(error),
            false => Self::bad_input(error),
        }
    }
}

impl From<SaveError> for Failure {
    fn from(error: SaveError) -> Self {
        match error {
            SaveError::Unwritable { .. } => Self::fault(error),
            error => Self::bad_input(error),
        }
    }
}

impl From<RecordError> for Failure {
    fn from(error: RecordError) -> Self {
        match error {
            RecordError::File(error) => error.into(),
            error @ RecordError::Bad { .. } => Self::bad_input(error),
        }
    }
}

impl From<PictureError> for Failure {
    fn from(error: PictureError) -> Self {
        let exit_code = match error {
            PictureError::File(error) => return error.into(),
            PictureError::Unstorable { .. } => EXIT_FAULT,
            PictureError::UnknownExtension(_) | PictureError::Malformed { .. } => EXIT_BAD_INPUT,
        };
        Self::new(exit_code, error)
    }
}

impl From<ParameterError> for Failure {
    fn from(error: ParameterError) -> Self {
        Self::bad_input(error)
    }
}

impl From<FrameError> for Failure {
    fn from(error: FrameError) -> Self {
        match error {
            FrameError::Gpu(error) => error.into(),
            FrameError::Probes(error) => Self::bad_input(error),
            FrameError::Inspection(error) => Self::bad_input(error),
        }
    }
}

/// A world file that cannot be read: the report shows the place and a remedy.
impl From<miette::Report> for Failure {
    fn from(report: miette::Report) -> Self {
        Self {
            exit_code: EXIT_BAD_INPUT,
            message: format!("{report:?}").trim_end().to_owned(),
        }
    }
}
