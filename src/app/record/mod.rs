//! Records of runs: what the player did, and when, so that the same run can be played again.
//!
//! A record is text, one JSON object per line. The first line says what the run began with ([`Header`]); each
//! other line is a [`Moment`]: a simulated time and the inputs that took effect then. Lines go to `FILE.part`,
//! at least twice a second, and the file gets its name when the run ends: a crash loses less than a second.

mod read;
mod write;

use std::path::{Path, PathBuf};

use glam::Vec3;
use serde::{Deserialize, Serialize};

pub use write::Recorder;

use super::{input::Input, viewport::Choice};
use crate::{
    measure::whole_file::FileError,
    parameters::{KEYS, Parameters},
    world::Camera,
};

/// Version of the format. Records of another version are refused: a run would not be the same.
const VERSION: u32 = 2;

/// What a run begins with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Header {
    grotto_record: u32,
    /// The world file, as it was named.
    pub world: PathBuf,
    /// CRC-32 of the world file's bytes.
    pub world_crc32: u32,
    /// Seed of the random rays.
    pub seed: u32,
    pub layout: String,
    /// `KEY=VALUE` for every parameter that is not at its default.
    pub set: Vec<String>,
    /// Width and height of the picture in pixels.
    pub size: [u32; 2],
    camera: StartCamera,
}

/// The camera at which the player began.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct StartCamera {
    name: String,
    position: [f32; 3],
    yaw_deg: f32,
    pitch_deg: f32,
    fov_deg: f32,
}

impl Header {
    /// Of a run that begins with this choice.
    pub fn new(
        world: &Path,
        world_crc32: u32,
        seed: u32,
        choice: &Choice,
        camera: &Camera,
    ) -> Self {
        Self {
            grotto_record: VERSION,
            world: world.to_owned(),
            world_crc32,
            seed,
            layout: choice.layout.clone(),
            set: assignments(&choice.parameters),
            size: choice.size,
            camera: StartCamera {
                name: camera.name.clone(),
                position: camera.position.to_array(),
                yaw_deg: camera.yaw_deg,
                pitch_deg: camera.pitch_deg,
                fov_deg: camera.fov_deg,
            },
        }
    }

    pub fn camera(&self) -> Camera {
        let StartCamera {
            name,
            position,
            yaw_deg,
            pitch_deg,
            fov_deg,
        } = self.camera.clone();
        Camera {
            name,
            position: Vec3::from(position),
            yaw_deg,
            pitch_deg,
            fov_deg,
        }
    }
}

/// Inputs that took effect at one time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Moment {
    /// Nanoseconds of simulated time since the start of the run.
    #[serde(rename = "t")]
    pub at_ns: u64,
    #[serde(rename = "do", default, skip_serializing_if = "Vec::is_empty")]
    pub inputs: Vec<Input>,
    /// The run ended here.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    end: bool,
}

impl Moment {
    pub fn new(at_ns: u64, inputs: Vec<Input>) -> Self {
        Self {
            at_ns,
            inputs,
            end: false,
        }
    }
}

/// A record that was read.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    pub header: Header,
    /// In the order of their times; never empty.
    moments: Vec<Moment>,
    /// What is missing at the end of a record whose run did not end by itself.
    pub cut: Option<String>,
}

/// Why a record cannot be written or read.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error("{place}: {reason}\n{remedy}")]
    Bad {
        /// `FILE:LINE`
        place: String,
        reason: String,
        remedy: &'static str,
    },
}

impl Record {
    /// Simulated time at the end (nanoseconds).
    pub fn end_ns(&self) -> u64 {
        self.moments.last().map_or(0, |moment| moment.at_ns)
    }
}

/// A record while it is played.
pub struct Playback {
    moments: std::iter::Peekable<std::vec::IntoIter<Moment>>,
}

impl Playback {
    pub fn new(record: Record) -> Self {
        Self {
            moments: record.moments.into_iter().peekable(),
        }
    }

    /// The moments before this time that have not been played yet.
    pub fn before(&mut self, ns: u64) -> Vec<Moment> {
        std::iter::from_fn(|| self.moments.next_if(|moment| moment.at_ns < ns)).collect()
    }

    /// Whether everything has been played.
    pub fn is_over(&mut self) -> bool {
        self.moments.peek().is_none()
    }
}

/// `KEY=VALUE` for every parameter that is not at its default.
pub fn assignments(parameters: &Parameters) -> Vec<String> {
    let standard = Parameters::default();
    let values = KEYS.iter().map(|key| (key, key.get(parameters)));
    values
        .filter(|(key, value)| *value != key.get(&standard))
        .map(|(key, value)| format!("{}={value}", key.name))
        .collect()
}

/// CRC-32 of a file's bytes.
///
/// # Errors
/// [`FileError`] when it cannot be read.
pub fn crc32_of(path: &Path) -> Result<u32, FileError> {
    let bytes = std::fs::read(path).map_err(|reason| FileError::reading(path, reason))?;
    Ok(crc32fast::hash(&bytes))
}
